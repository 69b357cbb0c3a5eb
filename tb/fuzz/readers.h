// Every reader of a file or stream that another program may have made, behind one kind of function.
#pragma once
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace fovea::fuzz {

/// What a reader made of its input.
enum class Result : std::uint8_t {
  kRead,
  kRefused,  ///< by a UserError of one line
};

struct Reader {
  const char* name;     ///< of its folder in corpus/, too
  const char* sources;  ///< files whose coverage counts, as a regular expression
  /// Reads, and uses what was read as the program does. Everything that is no Result is a defect of the reader: another
  /// exception, a crash, a UserError of several lines, an end that does not come.
  Result (*read)(std::string_view bytes);
};

/// One row for each reader.
std::span<const Reader> readers();
/// Calls a reader. @throws std::logic_error if it refuses with an exception that is no UserError of one line
Result run(const Reader& reader, std::string_view bytes);

}  // namespace fovea::fuzz
