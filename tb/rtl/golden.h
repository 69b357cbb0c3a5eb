// Golden model of the remap engine's address generator, written from rtl/README.md and not from the
// SystemVerilog: positions are computed directly for each pair, with divisions and without
// increments.
#pragma once
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

namespace fovea::rtl {

enum class Mode : unsigned { kTable, kGrid, kRadial, kProject };

/// A job; the fields are those of remap_pkg::job_t.
struct Job {
  Mode mode = Mode::kTable;
  bool bilinear = false;
  unsigned pairs = 1, rows = 1;                  ///< of the output
  std::uint32_t src_base = 0, dst_base = 0;      ///< word addresses
  unsigned src_pitch = 1, dst_pitch = 1;         ///< words
  unsigned src_width = 2, src_height = 1;        ///< pixels, rows
  unsigned grid_log2 = 4;                        ///< of the step in pixels
  unsigned pieces = 1, piece_log2 = 0;           ///< width of a piece in square pixels
  std::uint32_t radius_limit = 0xFFFFFFFF;       ///< square pixels, Q8
  std::int32_t centre_x = 0, centre_y = 0;       ///< pixels, Q16
  std::int32_t a[3] = {}, b[3] = {}, c[3] = {};  ///< first value, step of a pair, step of a row
};

/// What the address generator hands over for a pair; the fields are those of remap_pkg::beat_t.
struct Beat {
  bool last = false, border = false, bad = false, edge_x = false, edge_y = false, odd = false;
  unsigned frac_x = 0, frac_y = 0;  ///< Q8
  std::uint32_t src = 0, dst = 0;   ///< word addresses
  friend bool operator==(const Beat&, const Beat&) = default;
};

/// Whether the engine accepts a job.
bool possible(const Job& job);
/// Number of words of the job's map.
std::size_t map_words(const Job& job);
/// Number of nodes in a row of the job's grid, and of its rows.
unsigned grid_nodes(const Job& job);
unsigned grid_rows(const Job& job);
/// All beats of a job. @pre possible(job) and map.size() == map_words(job)
std::vector<Beat> addresses(const Job& job, std::span<const std::uint32_t> map);

/// How many lines of 32 bytes these beats bring from the source, one access each, through the cache that rtl/README.md
/// describes, with 2^log_lines lines; with four lines or fewer all are one set.
std::size_t lines_read(std::span<const Beat> beats, unsigned log_lines);
/// The lines that they need, each once.
std::size_t lines_needed(std::span<const Beat> beats);

/// The words that a job writes, in the order of its beats. `word(address)` gives the word at a word
/// address.
std::vector<std::uint32_t> picture(const Job& job, std::span<const std::uint32_t> map,
                                   std::uint32_t border,
                                   const std::function<std::uint32_t(std::uint32_t)>& word);

}  // namespace fovea::rtl
