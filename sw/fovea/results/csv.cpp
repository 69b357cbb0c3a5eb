#include "sw/fovea/results/csv.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

#include "model/common/check.h"
#include "sw/fovea/files/checked_file.h"

namespace fovea::results {
namespace {

[[noreturn]] void refuse(const CsvPlace& place, const std::string& why) {
  throw UserError(fmt::format("{}:{}: {}", app::one_line(place.file.string()), place.line, why));
}

/// For each of `columns`, and then for each other one, which field of the header has its name.
std::vector<std::size_t> order_of(const CsvPlace& place, std::span<const std::string> header,
                                  std::span<const std::string_view> columns) {
  std::vector<std::size_t> order;
  for (const std::string_view column : columns) {
    const auto found = std::find(header.begin(), header.end(), column);
    if (found == header.end())
      refuse(place, fmt::format("there is no column '{}'; allowed: a table with the columns {}", column,
                                fmt::join(columns, ",")));
    order.push_back(static_cast<std::size_t>(found - header.begin()));
  }
  for (std::size_t i = 0; i < header.size(); ++i)
    if (std::find(columns.begin(), columns.end(), header[i]) == columns.end()) order.push_back(i);
  return order;
}

}  // namespace

void each_csv_record(
    const std::filesystem::path& file, std::string_view text,
    const std::function<void(const CsvPlace&, std::span<const std::string>)>& row) {
  std::vector<std::string> fields;
  std::size_t at = 0, line = 1;
  while (at < text.size()) {
    const CsvPlace place{file, line};
    const std::size_t begin = at;
    std::size_t used = 0;
    for (bool more = true; more;) {
      if (used == kMaxCsvFields) refuse(place, fmt::format("a row of more than {} fields", kMaxCsvFields));
      if (used == fields.size()) fields.emplace_back();
      std::string& field = fields[used++];
      field.clear();
      if (at < text.size() && text[at] == '"') {
        for (++at;; ++at) {
          if (at >= text.size()) refuse(place, "a quote without its end");
          if (text[at] == '\n') ++line;
          if (text[at] != '"') {
            field += text[at];
          } else if (at + 1 < text.size() && text[at + 1] == '"') {
            field += text[at++];
          } else {
            ++at;
            break;
          }
        }
      }
      for (; at < text.size() && text[at] != ',' && text[at] != '\n'; ++at)
        if (text[at] != '\r' || (at + 1 < text.size() && text[at + 1] != '\n')) field += text[at];
      more = at < text.size() && text[at] == ',';
      if (at < text.size()) line += text[at++] == '\n';
    }
    const bool blank = used == 1 && fields.front().empty() && text[begin] != '"';
    if (!blank) row(place, std::span(fields).first(used));
  }
}

void each_csv_row(const std::filesystem::path& file, std::span<const std::string_view> columns,
                  const std::function<void(const CsvPlace&, std::span<const std::string>)>& row,
                  std::size_t max_bytes, const std::function<void(std::span<const std::string>)>& others) {
  const std::string text = app::read_file(file, max_bytes);
  std::vector<std::size_t> order;  // where the fields stand in the file
  std::vector<std::string> ordered;
  each_csv_record(file, text, [&](const CsvPlace& place, std::span<const std::string> fields) {
    const bool header = order.empty();
    if (header) order = order_of(place, fields, columns);
    if (fields.size() != order.size())
      refuse(place, fmt::format("{} fields; the header has {}", fields.size(), order.size()));
    ordered.resize(order.size());
    for (std::size_t i = 0; i < order.size(); ++i) ordered[i] = fields[order[i]];
    if (!header) return row(place, ordered);
    if (others) others(std::span(ordered).subspan(columns.size()));
  });
  if (order.empty()) refuse({file, 1}, "the header is missing");
}

std::string csv_field(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string out = "\"";
  for (const char c : text) out += c == '"' ? std::string("\"\"") : std::string(1, c);
  return out + "\"";
}

std::uint64_t whole(const CsvPlace& place, const std::string& field) {
  std::uint64_t value = 0;
  const char* end = field.data() + field.size();
  const auto [stop, error] = std::from_chars(field.data(), end, value);
  if (error != std::errc{} || stop != end)
    refuse(place, fmt::format("'{}' is not a whole number", app::one_line(field, 40)));
  return value;
}

std::uint64_t hexadecimal(const CsvPlace& place, const std::string& field) {
  std::uint64_t value = 0;
  const char* end = field.data() + field.size();
  const bool prefixed = field.starts_with("0x");
  const auto [stop, error] = std::from_chars(field.data() + (prefixed ? 2 : 0), end, value, 16);
  if (!prefixed || error != std::errc{} || stop != end)
    refuse(place, fmt::format("'{}' is not a hexadecimal number", app::one_line(field, 40)));
  return value;
}

double number(const CsvPlace& place, const std::string& field) {
  double value = 0;
  const char* end = field.data() + field.size();
  const auto [stop, error] = std::from_chars(field.data(), end, value);
  if (error != std::errc{} || stop != end || !std::isfinite(value))
    refuse(place, fmt::format("'{}' is not a number", app::one_line(field, 40)));
  return value;
}

std::optional<std::uint64_t> time_ps(const CsvPlace& place, const std::string& field) {
  if (field.empty()) return std::nullopt;
  const auto dot = field.find('.');
  if (dot == std::string::npos || field.size() != dot + 4)
    refuse(place,
           fmt::format("'{}' is not a time in ns with three decimals", app::one_line(field, 40)));
  return whole(place, field.substr(0, dot) + field.substr(dot + 1));
}

}  // namespace fovea::results
