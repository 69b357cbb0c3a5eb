// Where the bytes of a trace file come from, so that a reader holds a part of the file only.
#pragma once
#include <algorithm>
#include <cstdint>
#include <string>
#include <utility>

namespace fovea::trace {

/// A file of known size that is read piece by piece.
class ByteSource {
 public:
  virtual ~ByteSource() = default;
  /// Size in bytes.
  virtual std::uint64_t size() const = 0;
  /// Copies up to `bytes` bytes that begin at `offset` to `to`; fewer only at the end of the file.
  /// @return how many were copied  @throws UserError if the file cannot be read
  virtual std::size_t read(std::uint64_t offset, char* to, std::size_t bytes) const = 0;
};

/// A file that is in memory as a whole: tests, small inputs.
class MemoryBytes final : public ByteSource {
 public:
  explicit MemoryBytes(std::string bytes) : bytes_(std::move(bytes)) {}
  std::uint64_t size() const override { return bytes_.size(); }
  std::size_t read(std::uint64_t offset, char* to, std::size_t bytes) const override {
    if (offset >= bytes_.size()) return 0;
    const std::size_t n = std::min<std::size_t>(bytes, bytes_.size() - offset);
    std::copy_n(bytes_.data() + offset, n, to);
    return n;
  }

 private:
  std::string bytes_;
};

}  // namespace fovea::trace
