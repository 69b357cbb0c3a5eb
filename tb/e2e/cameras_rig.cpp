#include "tb/e2e/cameras_rig.h"

#include <gtest/gtest.h>

#include <cstddef>
#include <cstring>
#include <filesystem>
#include <sstream>

#include "sw/fovea/board/loader.h"
#include "sw/fovea/board/parameter_page.h"
#include "sw/fovea/config/calibration.h"
#include "sw/fovea/config/experiment.h"
#include "tb/e2e/geometry.h"
#include "tb/e2e/rig.h"

namespace fovea::e2e {

CamerasRig::CamerasRig()
    : elf_(app::ElfImage::load(std::filesystem::path(FOVEA_FIRMWARE_DIR) / "fovea_cameras.elf")) {
  params.declare(set_);
}

CamerasRig::~CamerasRig() = default;

CamerasRig& CamerasRig::set(const std::string& key, const std::string& value) {
  set_.set(key, value);
  return *this;
}

CamerasRig& CamerasRig::load(const std::string& name) {
  app::Experiment experiment(set_);
  experiment.load(std::filesystem::path(FOVEA_EXPERIMENTS_DIR) / name);
  app::apply_calibrations(set_, experiment);
  return *this;
}

board::Board& CamerasRig::build() {
  if (board_) return *board_;
  app::check_fits(elf_, app::memory_regions(params));
  app::complete_params(params);
  std::vector<video::PictureSource*> pictures;
  std::vector<const video::StampedSource*> stamped;
  for (unsigned n = 0; n < params.camera_count(); ++n) {
    sources_.push_back(app::camera_source(params, n));
    references_.push_back(app::camera_source(params, n));
    pictures.push_back(sources_.back().get());
    stamped.push_back(sources_.back().get());
    views_.push_back({{geometry_of(params, *params.camera_setup(n).lens), {}}});
  }
  board_ = std::make_unique<board::Board>("board", params, pictures, elf_.entry(), false);
  for (const auto& s : elf_.segments())
    board_->load({s.address, s.data, s.memory_size - s.data.size()});
  board_->load({PARAM_PAGE_BASE, app::parameter_page(params, stamped)});
  frames_ = board_->observe_frames([this](const video::Frame& f) {
    if (keep && !keep(f.times)) return;
    const unsigned w = params.width(), h = params.height();
    Shown s{crop(f.picture, (f.picture.width - w) / 2, (f.picture.height - h) / 2, w, h), f.times, {}, f.underflows};
    s.stamp = read_stamp(s.frame);
    shown_.push_back(std::move(s));
  });
  return *board_;
}

void CamerasRig::run(Picoseconds limit) {
  build();
  while (!board_->window_end() && board_->dm365.arm.failure().empty() && kernel_time() < limit)
    advance(kPsPerMs);
}

/// The lens decides where the marks lie, and they say whose lens it was.
std::optional<CamerasRig::Shown::Stamp> CamerasRig::read_stamp(const oracle::Frame& frame) const {
  const unsigned x = (params.raster_width() - params.width()) / 2;
  const unsigned y = (params.raster_height() - params.height()) / 2;
  for (unsigned n = 0; n < views_.size(); ++n) {
    const auto& layout = sources_[n]->stamps();
    for (unsigned k = 0; layout && k < views_[n].size(); ++k) {
      const ShownFields f = read_stamps(frame, views_[n][k].geometry, *layout, x, y);
      if (f.camera == n && *f.odd == *f.even + 1) return Shown::Stamp{n, *f.even / 2u};
    }
  }
  return std::nullopt;
}

ShownFields CamerasRig::read_stamp(const oracle::Frame& frame, unsigned camera) const {
  const auto& layout = sources_.at(camera)->stamps();
  const unsigned x = (params.raster_width() - params.width()) / 2;
  const unsigned y = (params.raster_height() - params.height()) / 2;
  return layout ? read_stamps(frame, views_[camera].front().geometry, *layout, x, y) : ShownFields{};
}

std::uint32_t CamerasRig::table_address(unsigned camera) {
  const auto* state = elf_.find("fw_state");
  std::uint32_t address = 0;
  const auto bytes = board_->peek(
      state->address + offsetof(FwState, table_address) + 4 * camera, sizeof address);
  std::memcpy(&address, bytes.data(), sizeof address);
  return address;
}

std::vector<std::uint32_t> CamerasRig::table(unsigned camera) {
  const std::uint32_t address = table_address(camera);
  const oracle::Geometry& g = geometry(camera);
  std::vector<std::uint32_t> out(std::size_t{g.width} / 2 * g.height);
  const auto entries = board_->peek(address, out.size() * 4);
  std::memcpy(out.data(), entries.data(), entries.size());
  return out;
}

void CamerasRig::add_view(unsigned camera, const oracle::Geometry& geometry) {
  views_.at(camera).push_back({geometry, {}});
}

void CamerasRig::keep_table(unsigned camera, unsigned k) {
  views_.at(camera).at(k).table = table(camera);
}

void CamerasRig::keep_tables() {
  for (unsigned n = 0; n < views_.size(); ++n)
    for (View& v : views_[n])
      if (v.table.empty()) v.table = table(n);
}

oracle::LutCheck CamerasRig::table_check(unsigned camera, unsigned k) {
  keep_tables();
  return oracle::check_lut(views_.at(camera).at(k).table, views_[camera][k].geometry, 0.02);
}

oracle::Frame CamerasRig::sent(unsigned camera, std::uint64_t number) {
  const unsigned w = params.width(), h = params.height();
  const video::Picture even = references_[camera]->field(2 * number);
  const video::Picture odd = references_[camera]->field(2 * number + 1);
  const unsigned x = (even.width - w) / 2, y = (even.height - h) / 2;
  oracle::Frame f = crop(even, x, y, w, h);
  const oracle::Frame second = crop(odd, x, y, w, h);
  for (unsigned r = (y + 1) % 2; r < h; r += 2)
    std::memcpy(f.uyvy.data() + std::size_t{r} * w * 2,
                second.uyvy.data() + std::size_t{r} * w * 2, std::size_t{w} * 2);
  return f;
}

std::string CamerasRig::wrong_picture() {
  keep_tables();
  for (const Shown& s : shown_) {
    const std::string which = "displayed frame " + std::to_string(s.record.index) + ": ";
    if (!s.stamp) return which + "no stamp can be read";
    const unsigned n = s.stamp->camera;
    if (shown_by(s) != ~0u) continue;
    const View& v = views_[n].front();
    return which + oracle::compare(oracle::remap(sent(n, s.stamp->number), v.table,
                                                 v.geometry.pitch_bytes),
                                   s.frame)
                       ->text();
  }
  return "";
}

unsigned CamerasRig::shown_by(const Shown& s) {
  keep_tables();
  for (unsigned k = 0; s.stamp && k < views_[s.stamp->camera].size(); ++k) {
    const View& v = views_[s.stamp->camera][k];
    if (!oracle::compare(oracle::remap(sent(s.stamp->camera, s.stamp->number), v.table,
                                       v.geometry.pitch_bytes),
                         s.frame))
      return k;
  }
  return ~0u;
}

std::vector<std::string> CamerasRig::said() const {
  std::vector<std::string> out;
  std::istringstream text(board_->uart_text());
  for (std::string line; std::getline(text, line);) {
    if (line.ends_with('\r')) line.pop_back();
    if (line.starts_with("camera ")) out.push_back(line);
  }
  return out;
}

void small(CamerasRig& rig, unsigned cameras) {
  rig.set("camera.kind", "chart").set("cameras.count", std::to_string(cameras));
  rig.set("video.width", "160").set("video.height", "184");
  if (cameras > 1) rig.set("camera.1.lens.mapping", "linear");
  rig.set("lens.focal", "255px");  // as of the whole raster: the marks are in the region
  if (cameras > 2) rig.set("camera.2.lens.shift_x", "6px");
}

std::vector<CamerasRig::Shown::Stamp> sequence(const CamerasRig& rig) {
  std::vector<CamerasRig::Shown::Stamp> out;
  for (const CamerasRig::Shown& s : rig.shown()) {
    EXPECT_TRUE(s.stamp) << "frame " << s.record.index;
    if (!s.stamp) continue;
    const bool again =
        !out.empty() && out.back().camera == s.stamp->camera && out.back().number == s.stamp->number;
    if (!again) out.push_back(*s.stamp);
  }
  return out;
}

std::map<std::string, Picoseconds> listen(CamerasRig& rig, Picoseconds limit) {
  std::map<std::string, Picoseconds> out;
  std::string line;
  const Subscription listening = rig.build().observe_uart([&](std::uint8_t byte) {
    if (byte == '\n') {
      if (line.starts_with("camera ")) out.emplace(line, kernel_time());
      line.clear();
    } else if (byte != '\r') {
      line += static_cast<char>(byte);
    }
  });
  rig.run(limit);
  return out;
}

}  // namespace fovea::e2e
