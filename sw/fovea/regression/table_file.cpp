#include "sw/fovea/regression/table_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>

#include "model/common/check.h"
#include "sw/fovea/checked_file.h"
#include "sw/fovea/report/csv.h"

namespace fovea::regression {
TableFile::TableFile(const std::filesystem::path& file, const std::vector<std::string>& columns)
    : file_(file) {
  const std::string name = app::one_line(file.string());
  report::each_csv_record(
      file, app::read_file(file, report::kMaxTableBytes),
      [&](const report::CsvPlace&, std::span<const std::string> fields) {
        std::vector<std::string> row(fields.begin(), fields.end());
        if (row.back().ends_with('\r')) row.back().pop_back();  // as Git on Windows has it
        if (row.size() == 1 && row.front().empty()) return;
        if (header_.empty()) {
          header_ = std::move(row);
          return;
        }
        // Before the next row is read: a file of commas would need much memory.
        if (row.size() != header_.size())
          throw UserError(fmt::format("'{}', row {}: {} fields; allowed: {}, as in the header", name, rows_.size() + 2,
                                      row.size(), header_.size()));
        rows_.push_back(std::move(row));
      });
  if (header_.empty()) throw UserError(fmt::format("'{}' is empty; allowed: a table with a header", name));
  for (const auto& column : columns)
    if (!has(column))
      throw UserError(fmt::format("'{}' has no column '{}'; allowed: a table with the columns {}",
                                  name, column, fmt::join(columns, ",")));
}

bool TableFile::has(std::string_view column) const {
  return std::find(header_.begin(), header_.end(), column) != header_.end();
}

std::size_t TableFile::index(std::string_view column) const {
  const auto found = std::find(header_.begin(), header_.end(), column);
  FOVEA_CHECK(found != header_.end(), "a column that the table was not asked for");
  return static_cast<std::size_t>(found - header_.begin());
}

const std::string& TableFile::text(std::size_t row, std::string_view column) const {
  return rows_[row][index(column)];
}

std::uint64_t TableFile::count(std::size_t row, std::string_view column) const {
  const std::string& field = text(row, column);
  if (field.empty()) return 0;
  std::uint64_t value = 0;
  const auto [end, error] = std::from_chars(field.data(), field.data() + field.size(), value);
  if (error != std::errc{} || end != field.data() + field.size())
    throw UserError(fmt::format("'{}', row {}: '{}' is not a whole number ({})",
                                app::one_line(file_.string()), row + 2, app::one_line(field, 40),
                                column));
  return value;
}

std::string table_row(const std::vector<std::string>& fields) {
  std::string out;
  for (const auto& field : fields) {
    if (&field != &fields.front()) out += ',';
    if (field.find_first_of(",\"\r\n") == std::string::npos) {
      out += field;
      continue;
    }
    out += '"';
    for (const char c : field) out += c == '"' ? std::string("\"\"") : std::string(1, c);
    out += '"';
  }
  return out + "\n";
}

}  // namespace fovea::regression
