#include "sw/fovea/regression/table_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>

#include "model/common/check.h"
#include "sw/fovea/checked_file.h"

namespace fovea::regression {
namespace {

constexpr std::size_t kMaxTableBytes = std::size_t{256} << 20;

/// Splits the text into rows of fields. Line feeds inside quotes belong to the field.
std::vector<std::vector<std::string>> rows_of(const std::string& text) {
  std::vector<std::vector<std::string>> rows;
  std::vector<std::string> row;
  std::string field;
  bool quoted = false, begun = false;
  const auto end_field = [&] {
    row.push_back(std::move(field));
    field.clear();
  };
  const auto end_row = [&] {
    if (begun) {
      end_field();
      rows.push_back(std::move(row));
    }
    row.clear();
    begun = false;
  };
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (quoted) {
      if (c != '"') field += c;
      else if (i + 1 < text.size() && text[i + 1] == '"') field += text[++i];
      else quoted = false;
      continue;
    }
    if (c == '\n') {
      end_row();
      continue;
    }
    begun = true;
    if (c == '"') quoted = true;
    else if (c == ',') end_field();
    else if (c != '\r') field += c;
  }
  end_row();
  return rows;
}

}  // namespace

TableFile::TableFile(const std::filesystem::path& file, const std::vector<std::string>& columns)
    : file_(file) {
  rows_ = rows_of(app::read_file(file, kMaxTableBytes));
  const std::string name = app::one_line(file.string());
  if (rows_.empty()) throw UserError(fmt::format("'{}' is empty; allowed: a table with a header", name));
  header_ = std::move(rows_.front());
  rows_.erase(rows_.begin());
  for (const auto& column : columns)
    if (!has(column))
      throw UserError(fmt::format("'{}' has no column '{}'; allowed: a table with the columns {}",
                                  name, column, fmt::join(columns, ",")));
  for (std::size_t i = 0; i < rows_.size(); ++i)
    if (rows_[i].size() != header_.size())
      throw UserError(fmt::format("'{}', row {}: {} fields; allowed: {}, as in the header", name,
                                  i + 2, rows_[i].size(), header_.size()));
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
