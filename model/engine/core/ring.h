// A queue in an array.
#pragma once
#include <array>
#include <cstddef>

namespace fovea::engine {

/// At most N elements, which the caller sees to.
template <class T, std::size_t N>
class Ring {
  static_assert((N & (N - 1)) == 0, "a power of two");

 public:
  bool empty() const { return size_ == 0; }
  std::size_t size() const { return size_; }
  const T& front() const { return items_[head_]; }
  T& front() { return items_[head_]; }
  T& at(std::size_t n) { return items_[(head_ + n) % N]; }  ///< the n-th from the front
  const T& at(std::size_t n) const { return items_[(head_ + n) % N]; }
  void push(const T& item) { push() = item; }
  T& push() { return items_[(head_ + size_++) % N]; }  ///< what was there before
  void pop() {
    head_ = (head_ + 1) % N;
    --size_;
  }
  void clear() { head_ = size_ = 0; }

 private:
  std::array<T, N> items_{};
  std::size_t head_ = 0, size_ = 0;
};

}  // namespace fovea::engine
