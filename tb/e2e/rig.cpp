#include "tb/e2e/rig.h"

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <numbers>
#include <stdexcept>

#include "model/video/core/bt656.h"
#include "sw/fovea/board/loader.h"
#include "sw/fovea/board/parameter_page.h"
#include "sw/fovea/config/experiment.h"
#include "tb/e2e/geometry.h"

namespace fovea::e2e {

oracle::Frame crop(const video::Picture& p, unsigned x, unsigned y, unsigned width,
                   unsigned height) {
  oracle::Frame f{width, height, {}};
  for (unsigned r = 0; r < height; ++r) {
    const std::uint8_t* row = p.row(y + r) + std::size_t{x} * 2;
    f.uyvy.insert(f.uyvy.end(), row, row + std::size_t{width} * 2);
  }
  return f;
}

namespace {

std::filesystem::path program_path(const std::string& elf) {
  return elf.find('/') == std::string::npos ? std::filesystem::path(FOVEA_FIRMWARE_DIR) / elf
                                            : std::filesystem::path(elf);
}

}  // namespace

Rig::Rig(std::string elf) : elf_(app::ElfImage::load(program_path(elf))) {
  params.declare(set_);
  set("camera.kind", "chart");
  set("ddr.check", "commands");
}

Rig::~Rig() = default;

Rig& Rig::set(const std::string& key, const std::string& value) {
  set_.set(key, value);
  return *this;
}

Rig& Rig::load(const std::string& experiment) {
  app::Experiment(set_).load(std::filesystem::path(FOVEA_EXPERIMENTS_DIR) / experiment);
  return *this;
}

board::Board& Rig::build() {
  app::check_fits(elf_, app::memory_regions(params));
  const auto make = [this] {
    return video::make_picture_source(params.camera, app::load_footage(params),
                                      params.raster_width(), params.raster_height());
  };
  source_ = make();
  reference_ = make();
  app::complete_params(params);
  board_ = std::make_unique<board::Board>("board", params, *source_, elf_.entry(), strict_);
  for (const auto& s : elf_.segments()) {
    board_->load({s.address, s.data, s.memory_size - s.data.size()});
  }
  board_->load({PARAM_PAGE_BASE, app::parameter_page(params, *source_)});
  frames_ = board_->observe_frames([this](const video::Frame& f) {
    const unsigned w = params.width(), h = params.height();
    shown_.push_back({crop(f.picture, (f.picture.width - w) / 2, (f.picture.height - h) / 2, w, h),
                      f.times, f.underflows});
  });
  return *board_;
}

void Rig::advance(Picoseconds duration) { slicer_.run(duration); }

void Rig::run(Picoseconds limit) {
  if (!board_) build();
  while (!board_->window_end() && board_->dm365.arm.failure().empty() && !board_->chip_reset() &&
         kernel_time() < limit)
    advance(kPsPerMs);
}

oracle::Frame Rig::sent(std::uint64_t n) {
  if (params.video.format().digital) {  // progressive: all rows of one instant, 2 n fields later
    const video::Picture& all = reference_->field(2 * n);
    return crop(all, 0, 0, all.width, all.height);
  }
  const unsigned w = params.width(), h = params.height();
  const video::Picture even = reference_->field(2 * n);
  const video::Picture odd = reference_->field(2 * n + 1);
  const unsigned x = (even.width - w) / 2, y = (even.height - h) / 2;
  oracle::Frame f = crop(even, x, y, w, h);
  const oracle::Frame second = crop(odd, x, y, w, h);
  // Row r of the picture is in the first field if r is even (both standards, first_lines crop).
  for (unsigned r = 0; r < h; ++r)
    if ((y + r) % 2 == 1)
      std::memcpy(f.uyvy.data() + std::size_t{r} * w * 2,
                  second.uyvy.data() + std::size_t{r} * w * 2, std::size_t{w} * 2);
  return f;
}

FwState Rig::state() {
  const auto* s = elf_.find("fw_state");
  if (!s) throw std::runtime_error("no fw_state");
  const auto bytes = board_->peek(s->address, sizeof(FwState));
  FwState out;
  std::memcpy(&out, bytes.data(), sizeof out);
  return out;
}

std::vector<std::uint32_t> Rig::lut(unsigned k) {
  const auto* s = elf_.find("lut");
  if (!s) throw std::runtime_error("no lut");
  const FwState fw = state();
  if (k >= params.firmware.tables()) throw std::runtime_error("no such table");
  std::vector<std::uint32_t> out(fw.lut_entries);
  const auto bytes = board_->peek(k == 0 ? s->address : fw.table_address[k], out.size() * 4);
  std::memcpy(out.data(), bytes.data(), bytes.size());
  return out;
}

oracle::Geometry Rig::geometry(unsigned k) const {
  oracle::Geometry g = geometry_of(params, params.lens);
  g.shift_x += 7 * k;
  return g;
}

void show_region(oracle::Geometry& g, double left, double top, double width, double height) {
  // The region's middle, in pixels right of and below the picture's, is to be in the middle of the enlarged view.
  const double zoom = width * g.height > height * g.width ? g.width / width : g.height / height;
  g.out_focal_px = oracle::output_focal(g) * zoom;
  g.shift_x = zoom * (g.shift_x + (left + left + width - g.width) / 2);
  g.shift_y = zoom * (g.shift_y + (top + top + height - g.height) / 2);
}

oracle::Geometry geometry_of(const board::BoardParams& params, const board::LensParams& l) {
  oracle::Geometry g;
  g.width = params.width();
  g.height = params.height();
  if (params.video.format().digital) {
    g.source_width = params.raster_width();
    g.source_height = params.raster_height();
  }
  g.pitch_bytes = (std::max(g.width, g.source_width) * 2 + 31) / 32 * 32;
  g.mapping = static_cast<oracle::Mapping>(l.mapping.index());
  g.method = l.pair.is("B") ? oracle::PairMethod::kPairCentre : oracle::PairMethod::kFirstPixel;
  g.paper_literal_focal = l.paper_literal_focal();
  g.fov_deg = l.fov();
  g.focal_px = l.focal();
  g.out_focal_px = l.out_focal();
  g.centre_x = l.centre_x();
  g.centre_y = l.centre_y();
  g.shift_x = l.shift_x();
  g.shift_y = l.shift_y();
  g.in_aspect = l.in_aspect();
  g.out_aspect = l.out_aspect();
  if (l.mapping.is("kannala_brandt")) {
    // The calibration stretched to the raster; pixel centres are at integers.
    const auto& kb = l.kb();
    const double sx = params.raster_width() / l.kb_width();
    const double sy = params.raster_height() / l.kb_height();
    const double fx = kb[0] * sx, fy = kb[1] * sy;
    g.mapping = oracle::Mapping::kKannalaBrandt;
    g.theta_max = l.theta_max() * std::numbers::pi / 180;
    g.k = {kb[4], kb[5], kb[6], kb[7]};
    g.focal_px = fx;
    g.in_aspect = fy / fx;
    g.centre_x = (kb[2] + 0.5) * sx - 0.5 - (params.raster_width() - 1) / 2.0;
    g.centre_y = (kb[3] + 0.5) * sy - 0.5 - (params.raster_height() - 1) / 2.0;
  }
  if (l.roi()[2] > 0) show_region(g, l.roi()[0], l.roi()[1], l.roi()[2], l.roi()[3]);
  return g;
}

}  // namespace fovea::e2e
