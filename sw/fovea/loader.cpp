#include "sw/fovea/loader.h"

#include <fmt/format.h>

#include <bit>
#include <cmath>
#include <cstring>

#include "sw/fovea/ffmpeg.h"
#include "sw/lens/param_page.h"

namespace fovea::app {

namespace {

/// Number of frames of a video that are used; then it starts again.
constexpr std::size_t kMostFilmFrames = 250;

}  // namespace

std::filesystem::path program_file(const board::BoardParams& params) {
  if (!params.firmware.elf().empty()) return params.firmware.elf();
  return built_program("fovea_firmware.elf");
}

std::filesystem::path built_program(const std::string& name) {
  std::error_code error;
  const auto self = std::filesystem::read_symlink("/proc/self/exe", error);
  return self.parent_path() / "sw/firmware" / name;
}

std::vector<MemoryRegion> memory_regions(const board::BoardParams& params) {
  return {{"internal RAM (instruction side)", 0x0000'0000, 0x8000},
          {"internal RAM (data side)", 0x0001'0000, 0x8000},
          {"SDRAM (ddr.part = " + params.soc.ddr.part() + ")", 0x8000'0000,
           params.soc.ddr.size_bytes()}};
}

std::vector<RgbImage> load_footage(const board::BoardParams& params,
                                   const std::atomic<bool>* stop) {
  const auto& camera = params.camera;
  if (camera.kind.is("chart")) return {};
  if (camera.file().empty())
    throw UserError("key 'camera.file': a picture or film is needed for camera.kind = " +
                    camera.kind() + "; allowed: a file name, or camera.kind: chart");
  if (camera.kind.is("sphere")) return {load_still(camera.file(), stop)};
  DecodeOptions options;
  options.max_frames = kMostFilmFrames;
  // All frames are kept in the host's memory, and more than twice the size of the raster shows no
  // more detail.
  options.most_width = 2 * params.raster_width();
  options.most_height = 2 * params.raster_height();
  options.stop = stop;
  return decode_frames(camera.file(), options);
}

std::vector<std::string> footage_notes(const board::BoardParams& params,
                                       const std::vector<RgbImage>& frames, const FilmInfo& info) {
  std::vector<std::string> out;
  const auto& camera = params.camera;
  if (frames.empty() || camera.kind.is("chart")) return out;
  // The frames of a video may have been scaled down when they were read.
  const unsigned width = info.width ? info.width : frames.front().width;
  const unsigned height = info.height ? info.height : frames.front().height;
  // A television raster is displayed 4:3. Frames that are warped by a lens keep their shape.
  const bool film = camera.kind.is("video");
  const double change = height * (4.0 / 3) / (width * info.pixel_aspect);
  if (!(film && camera.video_fov() > 0) && std::abs(change - 1) > 0.01)
    out.push_back(fmt::format("footage of {}x{} is stretched to 4:3, {:.0f} % {}", width, height,
                              100 * std::abs(change - 1),
                              change > 1 ? "wider" : "narrower"));
  if (!film) return out;
  const double camera_rate = params.video.standard.is("pal") ? 25 : 30000.0 / 1001;
  if (!info.rate.stopped() && std::abs(camera_rate / info.rate.hertz() - 1) > 0.005)
    out.push_back(
        fmt::format("footage of {:.4g} frames/s is shown at {:.4g} frames/s, {:.3g} times as "
                    "fast",
                    info.rate.hertz(), camera_rate, camera_rate / info.rate.hertz()));
  if (frames.size() == kMostFilmFrames)
    out.push_back(fmt::format("at most the first {} frames of the footage are used, over and over",
                              kMostFilmFrames));
  return out;
}

namespace {

void require(bool ok, const std::string& key, const std::string& value,
             const std::string& allowed) {
  if (!ok)
    throw UserError("key '" + key + "': '" + value + "' is not allowed; allowed: " + allowed);
}

void check_loads(const board::BoardParams& params) {
  const auto& loads = params.soc.loads;
  for (std::size_t i = 0; i < loads.size(); ++i) {
    const auto& load = loads[i];
    if (!load.active()) continue;
    require(std::has_single_bit(load.bytes()), load.bytes.key(), load.bytes.text(),
            "powers of two from 4 B");
    const bool sdram = load.memory.is("sdram");
    require(load.base() % 64 == 0 &&
                load.base() + load.size() <= (sdram ? params.soc.ddr.size_bytes() : 32u * 1024),
            load.base.key(), load.base.text(),
            std::string("multiples of 64 B with base + size of the load inside the ") +
                (sdram ? "SDRAM" : "internal RAM of 32 KiB"));
    require(!load.copies() || load.size() % 128 == 0, load.size.key(), load.size.text(),
            "multiples of 128 B for a copy");
    require(load.port.is("load") || !load.priority.user_set(), load.priority.key(),
            load.priority.text(), "only with port load; " + load.port() +
            " has the priority of " + (load.port.is("remap_engine") ? "MSTPRI0" : "QUEPRI"));
    for (std::size_t k = 0; k < i; ++k)
      require(!loads[k].active() || loads[k].port() != load.port(), load.port.key(), load.port(),
              "a port that no other load drives");
  }
}

}  // namespace

void complete_params(board::BoardParams& params) {
  const auto& v = params.video;
  require(v.width() % 4 == 0, v.width.key(), v.width.text(), "multiples of 4, 0 for all");
  require(v.height() % 4 == 0 && v.height() <= params.raster_height(), v.height.key(),
          v.height.text(),
          "multiples of 4 up to " + std::to_string(params.raster_height()) + ", 0 for all");
  for (const auto* cache : {&params.soc.cpu.icache, &params.soc.cpu.dcache})
    require(std::has_single_bit(cache->size()), cache->size.key(), cache->size.text(),
            "powers of two");
  check_loads(params);
  if (!params.decoder.standard.user_set())
    params.decoder.standard.set(params.video.standard.is("pal") ? "625/50" : "525/60");
}

namespace {

/// The firmware's calibrated lens, in pixels of the camera's raster.
video::LensModel firmware_lens(const board::BoardParams& params) {
  const auto& lens = params.lens;
  const auto& kb = lens.kb();
  return video::LensModel::kannala_brandt(kb[0], kb[1], kb[2], kb[3], {kb[4], kb[5], kb[6], kb[7]},
                                          lens.kb.key())
      .scaled(params.raster_width() / lens.kb_width(), params.raster_height() / lens.kb_height());
}

/// Warns if only one of the two lenses was set, which gives a distorted picture and is probably a
/// mistake. If both are set, the difference may be intended: firmware on a real board can be wrong
/// about its lens.
void check_same_lens(const board::BoardParams& params, const video::LensModel& firmware,
                     const video::LensModel& camera) {
  if (params.lens.kb.user_set() == params.camera.kb.user_set()) return;
  const auto apart = [](double a, double b, double scale) { return std::abs(a - b) > scale / 100; };
  if (!apart(firmware.fx(), camera.fx(), camera.fx()) &&
      !apart(firmware.fy(), camera.fy(), camera.fy()) &&
      !apart(firmware.cx(), camera.cx(), params.raster_width()) &&
      !apart(firmware.cy(), camera.cy(), params.raster_height()))
    return;
  Diagnostics::instance().configuration(fmt::format(
      "{} is set and {} is not, and they describe different lenses (optical centre {:.1f}, {:.1f} "
      "in the camera and {:.1f}, {:.1f} in the firmware, in pixels of the {}x{} raster); "
      "camera.calibration sets both",
      params.camera.kb.user_set() ? "camera.kb" : "lens.kb",
      params.camera.kb.user_set() ? "lens.kb" : "camera.kb", camera.cx(), camera.cy(),
      firmware.cx(), firmware.cy(), params.raster_width(), params.raster_height()));
}

}  // namespace

std::vector<std::uint8_t> parameter_page(const board::BoardParams& params,
                                         const video::StampedSource& source) {
  const board::LensParams& lens = params.lens;
  param_page_t page;
  param_page_default(&page);
  page.flags = (lens.paper_literal_focal() ? PARAM_PAPER_LITERAL_FOCAL : 0u) |
               (lens.pair.is("B") ? PARAM_PAIR_METHOD_B : 0u);
  page.width = static_cast<std::uint32_t>(params.video.width());
  page.height = static_cast<std::uint32_t>(params.video.height());
  page.repeats = static_cast<std::uint32_t>(params.firmware.repeat());
  page.fov_deg = lens.fov();
  page.focal_px = lens.focal();
  page.out_focal_px = lens.out_focal();
  page.centre_x = lens.centre_x();
  page.centre_y = lens.centre_y();
  page.shift_x = lens.shift_x();
  page.shift_y = lens.shift_y();
  page.in_aspect = lens.in_aspect();
  page.out_aspect = lens.out_aspect();
  page.mapping = static_cast<std::uint32_t>(lens.mapping.index());
  if (lens.mapping.is("kannala_brandt")) {
    const double w = params.raster_width(), h = params.raster_height();
    const video::LensModel model = firmware_lens(params);
    if (const auto* still = dynamic_cast<const video::SphereSource*>(&source);
        still && params.camera.lens.is("kannala_brandt"))
      check_same_lens(params, model, still->raster_lens());
    const double theta_max = lens.theta_max() * M_PI / 180;
    if (theta_max > model.theta_max() + 1e-12) {
      const double valid = model.theta_max() * 180 / M_PI;
      throw UserError(fmt::format(
          "key 'lens.theta_max': {}, but the calibration of the lens (lens.kb) is valid only up to "
          "{:.2f} deg; use lens.theta_max={:.0f}deg",
          lens.theta_max.text(), valid, std::floor(valid)));
    }
    const auto table = model.table(PARAM_TABLE_MAX, theta_max);
    page.mapping = LENS_TABLE;
    page.table_count = PARAM_TABLE_MAX;
    page.theta_max = theta_max;
    std::copy(table.begin(), table.end(), page.table_r);
    page.focal_px = model.fx();
    page.in_aspect = model.fy() / model.fx();
    page.centre_x = model.cx() - (w - 1) / 2 + lens.centre_x();
    page.centre_y = model.cy() - (h - 1) / 2 + lens.centre_y();
  }
  param_page_seal(&page);
  std::vector<std::uint8_t> bytes(sizeof page);
  std::memcpy(bytes.data(), &page, sizeof page);
  return bytes;
}

}  // namespace fovea::app
