// Comma-separated tables (RFC 4180): reading and writing, with errors of one line.
#pragma once
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace fovea::regression {

/// A table with a header. Columns are found by name, so that files may have more than are needed.
class TableFile {
 public:
  /// @throws UserError if the file cannot be read, a row has another number of fields than the
  /// header, or one of `columns` is missing
  TableFile(const std::filesystem::path& file, const std::vector<std::string>& columns);

  std::size_t rows() const { return rows_.size(); }
  /// The field of a column that the constructor was asked for.
  const std::string& text(std::size_t row, std::string_view column) const;
  /// The same as a count; an empty field is 0. @throws UserError if it is not a whole number
  std::uint64_t count(std::size_t row, std::string_view column) const;
  /// True if the table has this column.
  bool has(std::string_view column) const;

 private:
  std::size_t index(std::string_view column) const;
  std::filesystem::path file_;
  std::vector<std::string> header_;
  std::vector<std::vector<std::string>> rows_;
};

/// One row with its line feed; fields are quoted where that is necessary.
std::string table_row(const std::vector<std::string>& fields);

}  // namespace fovea::regression
