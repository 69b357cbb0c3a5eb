#include "sw/fovea/results/table_file.h"

#include <algorithm>

#include "model/common/check.h"

namespace fovea::results {

TableFile::TableFile(const std::filesystem::path& file, const std::vector<std::string>& columns)
    : file_(file), columns_(columns) {
  const std::vector<std::string_view> names(columns.begin(), columns.end());
  each_csv_row(
      file, names,
      [&](const CsvPlace& place, std::span<const std::string> fields) {
        rows_.emplace_back(fields.begin(), fields.end());
        lines_.push_back(place.line);
      },
      kMaxTableBytes,
      [&](std::span<const std::string> others) { columns_.insert(columns_.end(), others.begin(), others.end()); });
}

bool TableFile::has(std::string_view column) const {
  return std::find(columns_.begin(), columns_.end(), column) != columns_.end();
}

std::size_t TableFile::index(std::string_view column) const {
  const auto found = std::find(columns_.begin(), columns_.end(), column);
  FOVEA_CHECK(found != columns_.end(), "a column that the table was not asked for");
  return static_cast<std::size_t>(found - columns_.begin());
}

const std::string& TableFile::text(std::size_t row, std::string_view column) const {
  return rows_[row][index(column)];
}

std::uint64_t TableFile::count(std::size_t row, std::string_view column) const {
  const std::string& field = text(row, column);
  return field.empty() ? 0 : whole(place(row), field);
}

std::string table_row(const std::vector<std::string>& fields) {
  std::string out;
  for (const auto& field : fields) {
    if (&field != &fields.front()) out += ',';
    out += csv_field(field);
  }
  return out + "\n";
}

}  // namespace fovea::results
