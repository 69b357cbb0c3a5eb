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

/// The code drawn anew from the means of its cells, in all rows; nothing if a cell was not seen.
std::optional<video::StampCode> decode(const std::array<Mean, kColumns * kRows>& cells) {
  video::Picture picture(kColumns, kRows);
  for (unsigned i = 0; i < cells.size(); ++i) {
    if (cells[i].count == 0) return std::nullopt;
    picture.row(i / kColumns)[2 * (i % kColumns) + 1] =
        static_cast<std::uint8_t>(cells[i].sum / cells[i].count);
  }
  return video::decode_stamp(picture, video::CodeGrid(0, 0, 1, 1));
}

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
  std::array<Mean, kColumns * kRows> even{}, odd{};
  for (unsigned v = 0; v < shown.height; ++v)
    for (unsigned u = 0; u < shown.width; ++u) {
      // A pixel pair moves as a whole, so the camera pixel lies up to one to the side of its exact
      // position; the middle half of a cell is far enough from its neighbours.
      const std::optional<oracle::Position> p = position(u, v);
      if (!p) continue;
      const double row = std::floor(p->y + 0.5);
      const double column = (p->x - layout.code_x) / kCell;
      const double line = (row - layout.code_y) / kCell;
      if (column < 0 || column >= kColumns || line < 0 || line >= kRows) continue;
      const double across = column - std::floor(column), down = line - std::floor(line);
      if (across < 0.25 || across > 0.75 || down < 0.25 || down > 0.75) continue;
      const unsigned cell =
          static_cast<unsigned>(line) * kColumns + static_cast<unsigned>(column);
      Mean& mean = (static_cast<unsigned>(row) % 2 ? odd : even)[cell];
      mean.sum += shown.uyvy[(std::size_t{v} * shown.width + u) * 2 + 1];
      ++mean.count;
    }
  const auto first = decode(even), second = decode(odd);
  ShownFields out;
  if (first) out.even = first->field, out.even_camera = first->camera;
  if (second) out.odd = second->field, out.odd_camera = second->camera;
  if (first && second && first->camera == second->camera) out.camera = first->camera;
  return out;
}

}  // namespace fovea::e2e
