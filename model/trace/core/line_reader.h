// Lines of a text file, read in blocks of whole lines.
#pragma once
#include <algorithm>
#include <cstring>
#include <string>
#include <string_view>
#include <vector>

#include "model/common/check.h"
#include "model/trace/core/byte_source.h"

namespace fovea::trace {

/// Bytes that a line may have, or as many as a block has if that is more. No format has lines of a thousand.
inline constexpr std::size_t kMostLineBytes = 64 << 10;

/// Offers the file as blocks of whole lines. Memory: one block and kMostLineBytes. A reader may begin at the start of
/// any line.
class LineReader {
 public:
  /// `name`: of the file, for messages. `block`: bytes asked of the file at a time. `offset`,
  /// `lines_before`: where to begin, and the number of the line before; `bytes` must outlive the reader.
  LineReader(std::string name, const ByteSource& bytes, std::size_t block, std::uint64_t offset = 0,
             std::uint64_t lines_before = 0)
      : line(lines_before), name_(std::move(name)), bytes_(&bytes), block_(block), next_(offset) {}

  /// To be called when `at == end`. Puts whole lines between the two, each ended by a line feed,
  /// also the file's last. @return false at the end of the file  @throws UserError, also for a line
  /// that is too long
  bool fill() {
    std::size_t kept = filled_ - (end ? static_cast<std::size_t>(end - buffer_.data()) : 0);
    if (kept != 0) std::memmove(buffer_.data(), end, kept);
    for (;;) {
      if (buffer_.size() < kept + block_ + 1) buffer_.resize(std::max(kept + block_ + 1, 2 * kept));
      const std::size_t n = bytes_->read(next_, buffer_.data() + kept, block_);
      next_ += n;
      filled_ = kept + n;
      const char* const begin = at = end = buffer_.data();
      if (filled_ == 0) return false;
      if (n < block_) {  // the rest of the file
        if (begin[filled_ - 1] != '\n') {
          buffer_[filled_++] = '\n';
          ++next_;  // so that offset() stays right
        }
        end = begin + filled_;
        return true;
      }
      const void* last = ::memrchr(begin + kept, '\n', n);
      if (last) {
        end = static_cast<const char*>(last) + 1;
        return true;
      }
      kept = filled_;
      if (kept > kMostLineBytes)
        throw UserError("trace '" + name_ + "': the line that begins at byte " + std::to_string(next_ - kept) +
                        " has no end within " + std::to_string(kept) + " bytes; it is no text of a trace");
    }
  }
  /// Takes the line at `at`, without its line feed.
  std::string_view take() {
    const auto* feed =
        static_cast<const char*>(std::memchr(at, '\n', static_cast<std::size_t>(end - at)));
    const std::string_view text(at, static_cast<std::size_t>(feed - at));
    at = feed + 1;
    return text;
  }
  /// Of `at` in the file.
  std::uint64_t offset() const {
    return next_ - (filled_ - static_cast<std::size_t>(at - buffer_.data()));
  }

  const char* at = nullptr;
  const char* end = nullptr;
  std::uint64_t line;  ///< number of the line before `at`, counted by the user of this class

 private:
  std::string name_;
  const ByteSource* bytes_;
  std::size_t block_;
  std::uint64_t next_;  // offset of what fill() asks for
  std::vector<char> buffer_;
  std::size_t filled_ = 0;
};

}  // namespace fovea::trace
