#include "sw/fovea/report/csv.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>

#include "model/common/check.h"
#include "sw/fovea/checked_file.h"

namespace fovea::report {
namespace {

[[noreturn]] void refuse(const CsvPlace& place, const std::string& why) {
  throw UserError(fmt::format("{}:{}: {}", app::one_line(place.file.string()), place.line, why));
}

}  // namespace

void each_csv_record(
    const std::filesystem::path& file, std::string_view text,
    const std::function<void(const CsvPlace&, std::span<const std::string>)>& row) {
  std::vector<std::string> fields;
  std::size_t at = 0, line = 1;
  while (at < text.size()) {
    const CsvPlace place{file, line};
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
      while (at < text.size() && text[at] != ',' && text[at] != '\n') field += text[at++];
      more = at < text.size() && text[at] == ',';
      if (at < text.size()) line += text[at++] == '\n';
    }
    row(place, std::span(fields).first(used));
  }
}

void each_csv_row(const std::filesystem::path& file, std::span<const std::string_view> columns,
                  const std::function<void(const CsvPlace&, std::span<const std::string>)>& row,
                  std::size_t max_bytes) {
  const std::string text = app::read_file(file, max_bytes);
  std::size_t expected = 0;
  each_csv_record(file, text, [&](const CsvPlace& place, std::span<const std::string> fields) {
    if (expected == 0) {
      for (std::size_t i = 0; i < columns.size(); ++i)
        if (i >= fields.size() || fields[i] != columns[i])
          refuse(place, fmt::format("column {} is not '{}'", i + 1, columns[i]));
      expected = fields.size();
    } else if (fields.size() != expected) {
      refuse(place, fmt::format("{} fields; the header has {}", fields.size(), expected));
    }
    row(place, fields);
  });
  if (expected == 0) refuse({file, 1}, "the header is missing");
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

}  // namespace fovea::report
