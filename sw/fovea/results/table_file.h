// A table with a header that is read whole, and rows as they are written.
#pragma once
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "sw/fovea/results/csv.h"

namespace fovea::results {

/// Columns are found by name, so that files may have more than are needed (each_csv_row).
class TableFile {
 public:
  /// @throws UserError as each_csv_row() does
  TableFile(const std::filesystem::path& file, const std::vector<std::string>& columns);

  std::size_t rows() const { return rows_.size(); }
  /// Where a row stands, for messages.
  CsvPlace place(std::size_t row) const { return {file_, lines_[row]}; }
  /// The field of a column that the constructor was asked for.
  const std::string& text(std::size_t row, std::string_view column) const;
  /// The same as a count; an empty field is 0. @throws UserError if it is not a whole number
  std::uint64_t count(std::size_t row, std::string_view column) const;
  /// True if the table has this column.
  bool has(std::string_view column) const;

 private:
  std::size_t index(std::string_view column) const;
  std::filesystem::path file_;
  std::vector<std::string> columns_;
  std::vector<std::vector<std::string>> rows_;
  std::vector<std::size_t> lines_;  // of the rows in the file
};

/// One row with its line feed.
std::string table_row(const std::vector<std::string>& fields);

}  // namespace fovea::results
