#include "tb/e2e/stamp_reader.h"

#include <array>
#include <cmath>

namespace fovea::e2e {
namespace {

constexpr unsigned kColumns = video::StampLayout::kCodeColumns;
constexpr unsigned kRows = video::StampLayout::kCodeRows;
constexpr double kCell = video::StampLayout::kCellPixels;

/// Luma of the pixels found in the middle of a cell.
struct Mean {
  unsigned sum = 0, count = 0;
};

using Cells = std::array<Mean, kColumns * kRows>;
/// The cells of a field's number that its two fields have otherwise: bit 0, and its complement (stamp.h).
constexpr unsigned kBit0 = 15, kNotBit0 = 23;
constexpr unsigned kDark = 32, kBright = 220, kMiddle = (kDark + kBright) / 2;  // luma of the marks

/// The code drawn anew from the means of its cells, in all rows; nothing if a cell was not seen.
std::optional<video::StampCode> decode(const Cells& cells) {
  video::Picture picture(kColumns, kRows);
  for (unsigned i = 0; i < cells.size(); ++i) {
    if (cells[i].count == 0) return std::nullopt;
    picture.row(i / kColumns)[2 * (i % kColumns) + 1] =
        static_cast<std::uint8_t>(cells[i].sum / cells[i].count);
  }
  return video::decode_stamp(picture, video::CodeGrid(0, 0, 1, 1));
}

/// Of each cell what its middle shows, in the rows of each field.
std::array<Cells, 2> cells_of(const oracle::Frame& shown, const video::StampLayout& layout,
                              const std::function<std::optional<SourcePixel>(unsigned, unsigned)>& source) {
  std::array<Cells, 2> out{};
  for (unsigned v = 0; v < shown.height; ++v)
    for (unsigned u = 0; u < shown.width; ++u) {
      // A pixel pair moves as a whole, so the camera pixel lies up to one to the side of its exact
      // position; the middle half of a cell is far enough from its neighbours.
      const std::optional<SourcePixel> p = source(u, v);
      if (!p) continue;
      const double column = (p->at.x - layout.code_x) / kCell, line = (p->at.y - layout.code_y) / kCell;
      if (column < 0 || column >= kColumns || line < 0 || line >= kRows) continue;
      const double across = column - std::floor(column), down = line - std::floor(line);
      if (across < 0.25 || across > 0.75 || down < 0.25 || down > 0.75) continue;
      Mean& mean = out[p->second][static_cast<unsigned>(line) * kColumns + static_cast<unsigned>(column)];
      mean.sum += shown.uyvy[(std::size_t{v} * shown.width + u) * 2 + 1];
      ++mean.count;
    }
  return out;
}

bool is_bright(const Mean& mean) { return mean.sum > kMiddle * mean.count; }

}  // namespace

ShownFields read_stamps(const oracle::Frame& shown, const oracle::Geometry& geometry,
                        const video::StampLayout& layout, unsigned x, unsigned y) {
  return read_stamps(shown, layout, [&](unsigned u, unsigned v) {
    const oracle::Position p = oracle::source_position(geometry, u, v);
    return std::optional<oracle::Position>({p.x + x, p.y + y});
  });
}

ShownFields read_stamps(const oracle::Frame& shown, const video::StampLayout& layout,
                        const std::function<std::optional<oracle::Position>(unsigned, unsigned)>& position) {
  const auto [even, odd] = cells_of(shown, layout, [&](unsigned u, unsigned v) -> std::optional<SourcePixel> {
    const std::optional<oracle::Position> p = position(u, v);
    if (!p) return std::nullopt;
    const double row = std::floor(p->y + 0.5);
    return SourcePixel{{p->x, row}, static_cast<unsigned>(row) % 2 != 0};
  });
  const auto first = decode(even), second = decode(odd);
  ShownFields out;
  if (first) out.even = first->field, out.even_camera = first->camera;
  if (second) out.odd = second->field, out.odd_camera = second->camera;
  if (first && second && first->camera == second->camera) out.camera = first->camera;
  return out;
}

std::optional<ShownFrame> read_frame(const oracle::Frame& shown, const video::StampLayout& layout,
                                     const std::function<std::optional<SourcePixel>(unsigned, unsigned)>& source) {
  const auto [even, odd] = cells_of(shown, layout, source);
  Cells both{};
  for (unsigned i = 0; i < both.size(); ++i) {
    both[i] = {even[i].sum + odd[i].sum, even[i].count + odd[i].count};
    const bool of_field = i == kBit0 || i == kNotBit0;
    if (even[i].count && odd[i].count && (is_bright(even[i]) != is_bright(odd[i])) != of_field) return std::nullopt;
    if (!of_field) continue;
    const bool bright = i == kNotBit0;  // in the first field
    if (even[i].count && is_bright(even[i]) != bright) return std::nullopt;
    if (odd[i].count && is_bright(odd[i]) == bright) return std::nullopt;
    both[i] = {bright ? kBright : kDark, 1};
  }
  const auto code = decode(both);
  if (!code) return std::nullopt;
  return ShownFrame{code->field / 2u, code->camera};
}

}  // namespace fovea::e2e
