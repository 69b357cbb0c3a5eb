// The CSV files of a run: reading row by row, by the names of the columns, and writing a field.
#pragma once
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace fovea::results {

/// Where a row stands, for messages.
struct CsvPlace {
  const std::filesystem::path& file;
  std::size_t line = 0;
};

/// Fields that a record may have; a timeline has four for each master.
inline constexpr std::size_t kMaxCsvFields = 512;
/// Bytes of a table, which does not grow with the length of a run, and of rows that do. 10,000 frames have a
/// timeline.csv of 80 MB.
inline constexpr std::size_t kMaxTableBytes = 16u << 20, kMaxRowsBytes = 128u << 20;

/// The fields of a CSV text (RFC 4180: quoted fields, "" for a quote), with the line in which each record begins. Lines
/// may end as on Windows, as Git changes them, and blank lines count for nothing. @throws UserError with file and line:
/// a quote without its end, more fields than kMaxCsvFields
void each_csv_record(const std::filesystem::path& file, std::string_view text,
                     const std::function<void(const CsvPlace&, std::span<const std::string>)>& row);

/// Reads a table with a header: the fields of `columns`, wherever they stand, and behind them those of the other
/// columns, so that a later version may add some. @param others called before the first row with their names
/// @throws UserError with file and line: no header or one without one of the columns, a row with another number of
/// fields, a quote without its end
void each_csv_row(const std::filesystem::path& file, std::span<const std::string_view> columns,
                  const std::function<void(const CsvPlace&, std::span<const std::string>)>& row,
                  std::size_t max_bytes = kMaxTableBytes,
                  const std::function<void(std::span<const std::string>)>& others = {});

/// A field as it is written, quoted if necessary.
std::string csv_field(const std::string& text);

/// Numbers as the files have them. @throws UserError with file and line
std::uint64_t whole(const CsvPlace& place, const std::string& field);
/// "0x805b4134"
std::uint64_t hexadecimal(const CsvPlace& place, const std::string& field);
double number(const CsvPlace& place, const std::string& field);
/// Nanoseconds with three decimals as ps; empty for an empty field.
std::optional<std::uint64_t> time_ps(const CsvPlace& place, const std::string& field);

}  // namespace fovea::results
