// The bytes of the SDRAM. Pages are taken from the host when touched; fresh memory reads 0.
#pragma once
#include <sys/mman.h>

#include <cstdint>
#include <cstring>
#include <new>

namespace fovea::mem {

class BackingStore {
 public:
  explicit BackingStore(std::uint64_t size) : size_(size) {
    void* p = mmap(nullptr, size, PROT_READ | PROT_WRITE,
                   MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
    if (p == MAP_FAILED) throw std::bad_alloc();
    data_ = static_cast<std::uint8_t*>(p);
    // The guest's accesses are scattered: large pages spare the host most of its own page walks.
    // Only advice: where it is refused nothing but speed changes.
    madvise(p, size, MADV_HUGEPAGE);
  }
  ~BackingStore() { munmap(data_, size_); }
  BackingStore(const BackingStore&) = delete;
  BackingStore& operator=(const BackingStore&) = delete;
  /// All bytes read 0 again.
  void clear() {
    if (madvise(data_, size_, MADV_DONTNEED) != 0) std::memset(data_, 0, size_);
  }
  std::uint64_t size() const { return size_; }
  /// Caller checks offset + n <= size().
  std::uint8_t* at(std::uint64_t offset) { return data_ + offset; }
  const std::uint8_t* at(std::uint64_t offset) const { return data_ + offset; }

 private:
  std::uint64_t size_;
  std::uint8_t* data_;
};

}  // namespace fovea::mem
