#include "sw/fovea/board/loader.h"

#include <fmt/format.h>

#include <bit>
#include <cmath>

#include "model/common/check.h"
#include "model/video/scene/car_park.h"
#include "model/video/scene/line_chart.h"
#include "sw/fovea/files/ffmpeg.h"

namespace fovea::app {

namespace {

/// Number of frames of a video that are used; then it starts again.
constexpr std::size_t kMostFilmFrames = 250;
/// Rows of a picture on all lines of 525/60 that are not blanked.
constexpr unsigned kPlacementAll = video::kPlacement525All.rows;

}  // namespace

std::filesystem::path program_file(const board::BoardParams& params) {
  if (!params.firmware.elf().empty()) return params.firmware.elf();
  if (!params.firmware.view.is("single")) return built_program("fovea_views.elf");
  return built_program(params.takes_turns() ? "fovea_cameras.elf" : "fovea_firmware.elf");
}

std::filesystem::path built_program(const std::string& name) {
  std::error_code error;
  const auto self = std::filesystem::read_symlink("/proc/self/exe", error);
  return self.parent_path() / "sw/firmware" / name;
}

std::vector<MemoryRegion> memory_regions(const board::BoardParams& params) {
  return {{"internal RAM (instruction side)", INTERNAL_RAM_BASE, INTERNAL_RAM_BYTES},
          {"internal RAM (data side)", INTERNAL_RAM_DATA_BASE, INTERNAL_RAM_BYTES},
          {"SDRAM (ddr.part = " + params.soc.ddr.part() + ")", DDR_BASE,
           params.soc.ddr.size_bytes()}};
}

std::vector<RgbImage> load_footage(const board::BoardParams& params,
                                   const video::SceneParams& camera,
                                   const std::atomic<bool>* stop) {
  if (!camera.kind.is("sphere") && !camera.kind.is("video")) return {};
  if (camera.file().empty())
    throw UserError("key '" + camera.file.key() + "': a picture or film is needed for " +
                    camera.kind.key() + " = " + camera.kind() + "; allowed: a file name, or " +
                    camera.kind.key() + ": chart");
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

namespace {

std::unique_ptr<video::StampedSource> car_park(const board::BoardParams& params, const video::SceneParams& scene,
                                               unsigned camera, unsigned height) {
  if (camera >= params.mounts.size())
    throw UserError("key '" + scene.kind.key() + "': car_park is seen by cameras 0 to " +
                    std::to_string(params.mounts.size() - 1) + ", which are mounted on the car");
  const unsigned width = params.raster_width();
  return std::make_unique<video::CarParkSource>(video::Raster{width, height, scene.stamp(), camera},
                                                scene.lens_model(width, height), params.mounts[camera].mount());
}

/// A scene that is a formula is seen through a lens that is one; null for any other kind.
std::unique_ptr<video::StampedSource> synthetic_scene(const board::BoardParams& params,
                                                      const video::SceneParams& scene, unsigned camera,
                                                      unsigned height) {
  if (!scene.kind.is("car_park") && !scene.kind.is("lines")) return nullptr;
  if (scene.lens.is("kannala_brandt"))
    throw UserError(fmt::format(
        "key '{}': {} = {} is seen through linear, orthographic, equisolid or stereographic, not kannala_brandt",
        scene.lens.key(), scene.kind.key(), scene.kind()));
  if (scene.kind.is("car_park")) return car_park(params, scene, camera, height);
  const unsigned width = params.raster_width();
  return std::make_unique<video::LineChartSource>(video::Raster{width, height, scene.stamp(), camera},
                                                  scene.lens_model(width, height));
}

}  // namespace

std::unique_ptr<video::StampedSource> camera_source(const board::BoardParams& params,
                                                    unsigned camera, const std::atomic<bool>* stop,
                                                    std::vector<std::string>* notes) {
  const board::CameraSetup setup = params.camera_setup(camera);
  std::vector<RgbImage> footage = load_footage(params, *setup.scene, stop);
  if (notes) {
    const FilmInfo info =
        setup.scene->kind.is("video") ? film_info(setup.scene->file(), {.stop = stop}) : FilmInfo{};
    for (const std::string& note : footage_notes(params, *setup.scene, footage, info))
      notes->push_back(params.camera_count() > 1 ? fmt::format("camera {}: {}", camera, note)
                                                 : note);
  }
  const EnumParam& own = params.camera_rows.at(camera).wire.standard;
  const unsigned height = !own.user_set() || params.video.format().digital
                              ? params.raster_height()
                          : own.is("625/50") ? 576
                                               : 480;
  if (auto scene = synthetic_scene(params, *setup.scene, camera, height)) return scene;
  return video::make_picture_source(*setup.scene, std::move(footage), params.raster_width(), height,
                                    camera);
}

namespace {

/// The size of the footage before it was scaled: as its file says, but upright, as the decoder turns it by a rotation
/// tag or EXIF. The decoded frames show whether it did.
struct Shape {
  unsigned width, height;
  double pixel_aspect;
};
Shape upright(const RgbImage& frame, const FilmInfo& info) {
  if (!info.width || !info.height) return {frame.width, frame.height, info.pixel_aspect};
  const double stored = static_cast<double>(info.width) / info.height;
  const double seen = static_cast<double>(frame.width) / frame.height;
  if (std::abs(std::log(seen / stored)) <= std::abs(std::log(seen * stored)))
    return {info.width, info.height, info.pixel_aspect};
  return {info.height, info.width, 1 / info.pixel_aspect};
}

/// The camera sends the rows of the first field, and half a frame later the others.
std::string fields_note(const board::BoardParams& params, const video::SceneParams& camera, const RgbImage& frame,
                        FilmInfo::Fields fields) {
  if (fields == FilmInfo::Fields::kNone) return "";
  const bool top = fields == FilmInfo::Fields::kTopFirst;
  const bool top_sent = params.video.format().is_625 || !params.decoder.crop_525.is("studio");
  const std::string what = fmt::format("footage is interlaced, {} field first", top ? "top" : "bottom");
  if (camera.video_fov() > 0 || frame.height != params.raster_height())
    return what + ": its fields are taken as one picture, so what moves has two edges; 'ffmpeg -vf bwdif' takes them "
                  "apart";
  if (top == top_sent) return "";
  return fmt::format("{}, and the {} one is sent first: what moves steps back within each frame; 'ffmpeg -vf "
                     "fieldorder={}' exchanges them",
                     what, top_sent ? "top" : "bottom", top_sent ? "tff" : "bff");
}

/// The transfer functions of ordinary television and computer pictures differ little; those of HDR and of scene-linear
/// material would have to be mapped.
std::string transfer_note(const std::string& transfer) {
  for (const std::string_view usual : {"", "unknown", "reserved", "bt709", "gamma22", "bt470m", "gamma28", "bt470bg",
                                       "smpte170m", "smpte240m", "iec61966-2-1", "iec61966-2-4", "bt1361e", "bt2020-10",
                                       "bt2020-12"})
    if (transfer == usual) return "";
  return fmt::format("footage has the transfer function {}, which is not followed: its brightness is shown as if it "
                     "were that of ordinary television",
                     transfer);
}

}  // namespace

std::vector<std::string> footage_notes(const board::BoardParams& params,
                                       const video::SceneParams& camera,
                                       const std::vector<RgbImage>& frames, const FilmInfo& info) {
  std::vector<std::string> out;
  if (frames.empty() || camera.kind.is("chart")) return out;
  const auto [width, height, pixel_aspect] = upright(frames.front(), info);
  // A television raster is displayed 4:3. Frames that are warped by a lens keep their shape.
  const bool film = camera.kind.is("video");
  const double change = height * (4.0 / 3) / (width * pixel_aspect);
  if (!(film && camera.video_fov() > 0) && std::abs(change - 1) > 0.01)
    out.push_back(fmt::format("footage of {}x{} is stretched to 4:3, {:.0f} % {}", width, height,
                              100 * std::abs(change - 1),
                              change > 1 ? "wider" : "narrower"));
  if (!film) return out;
  for (const std::string& note :
       {fields_note(params, camera, frames.front(), info.fields), transfer_note(info.transfer)})
    if (!note.empty()) out.push_back(note);
  const board::VideoFormat& format = params.video.format();
  const double camera_rate = format.digital ? params.video.digital_clock().hertz() / format.digital->frame_bytes()
                             : format.is_625 ? 25
                                             : 30000.0 / 1001;
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
    require(load.end() == 0 || load.end() > load.start(), load.end.key(), load.end.text(),
            "0s, or later than the load's start (" + load.start.text() + ")");
    require(load.port.is("load") || !load.priority.user_set(), load.priority.key(),
            load.priority.text(), "only with port load; " + load.port() +
            " has the priority of " + (load.port.is("remap_engine") ? "MSTPRI0" : "QUEPRI"));
    for (std::size_t k = 0; k < i; ++k)
      require(!loads[k].active() || loads[k].port() != load.port(), load.port.key(), load.port(),
              "a port that no other load drives");
  }
}

/// What a camera at the digital port cannot be combined with.
void check_digital(const board::BoardParams& params) {
  if (!params.video.format().digital) return;
  const std::string with = " with video.standard = " + params.video.standard();
  const auto only = [&](const ParamBase& p, bool ok, const std::string& allowed) {
    require(ok, p.key(), p.text(),
            allowed + with + ": the digital port has one camera, and the program for one serves it");
  };
  const auto& fw = params.firmware;
  only(params.cameras.count, params.camera_count() == 1, "1");
  only(params.fault.kind, params.fault.kind.is("none"), "none");
  only(fw.view, fw.view.is("single"), "single");
  only(fw.program, fw.program.is("auto") || fw.program.is("one_camera"), "auto or one_camera");
  only(fw.display_phase, fw.display_phase.is("locked"), "locked");
  const auto& v = params.video;
  const auto fits = [&](const IntParam& side, unsigned most) {
    require(side() <= most, side.key(), side.text(), "up to " + std::to_string(most) + with);
  };
  fits(v.width, v.format().width);
  fits(v.height, v.format().height);
}

/// The run goes on: what a fault does to a program that does not look for it may be what is asked for.
void warn_of_unwatched_fault(const board::BoardParams& params) {
  const auto& kind = params.fault.kind;
  if (kind.is("none")) return;
  DiagnosticsRef::current().configuration("key '" + kind.key() + "': '" + kind() + "' is not looked for by " +
                                          params.firmware.program.key() +
                                          " = one_camera, which shows what comes and says nothing; the program that "
                                          "does: cameras, or auto");
}

void check_cameras(const board::BoardParams& params) {
  const unsigned count = params.camera_count();
  const auto& fault = params.fault;
  const bool quad = params.cameras.quad();
  require(!fault.kind.is("stuck_select") || params.multiplexed(), fault.kind.key(), fault.kind(),
          "that of a camera, or any with cameras.multiplexer = gpio and cameras.count of 2 or more");
  require(!fault.of_camera() || fault.camera() < params.input_count(), fault.camera.key(), fault.camera.text(),
          quad ? "0 with cameras.quad, whose signal is one" : "the number of a camera, less than cameras.count");
  for (unsigned n = 0; !params.multiplexed() && n < count; ++n)
    for (unsigned k = 0; k < n; ++k) {
      const EnumParam& input = params.camera_rows[n].wire.input;
      require(input() != params.camera_rows[k].wire.input(), input.key(), input(),
              "an input that no other camera is on");
    }
  const auto& fw = params.firmware;
  require(!quad || count == VIEW_CAMERAS, params.cameras.quad.key(), params.cameras.quad.text(),
          "false, or true with cameras.count = 4");
  for (unsigned n = 0; quad && n < count; ++n) {
    require(params.camera_setup(n).genlocked, params.cameras.quad.key(), params.cameras.quad.text(),
            "false, or true with genlocked cameras: the signals that are joined have the same syncs");
    const EnumParam& standard = params.camera_rows[n].wire.standard;
    require(standard() == params.camera_rows[0].wire.standard(), standard.key(), standard(),
            "that of camera 0 with cameras.quad");
  }
  const EnumParam& multiplexer = params.cameras.multiplexer;
  require(!quad || !params.multiplexed(), multiplexer.key(), multiplexer(),
          "decoder with cameras.quad, which joins the cameras to one signal");
  if (!fw.elf().empty()) return;
  require(fw.view.is("single") || !params.multiplexed(), multiplexer.key(), multiplexer(),
          "decoder with firmware.view = four_way or birds_eye, whose program changes the decoder's input");
  require(fw.view.is("single") || count == VIEW_CAMERAS, fw.view.key(), fw.view(),
          "single, or any with cameras.count = 4");
  require(!quad || (params.width() == params.raster_width() && params.height() == params.raster_height()),
          params.cameras.quad.key(), params.cameras.quad.text(),
          "false, or true with the whole picture: a part of it does not hold the four cameras' pictures");
  require(!quad || !fw.view.is("single"), params.cameras.quad.key(), params.cameras.quad.text(),
          "false, or true with firmware.view = four_way or birds_eye");
  require(fw.view.is("single") || fw.display_phase.is("locked"), fw.display_phase.key(), fw.display_phase(),
          "locked with firmware.view = four_way or birds_eye");
  const auto period = fw.watchdog();
  require(period % kPsPerUs == 0, fw.watchdog.key(), fw.watchdog.text(), "whole microseconds, 0 for off");
  if (!params.takes_turns()) {
    require(count == 1, fw.program.key(), fw.program(), "cameras, with several of them");
    require(fw.display_phase.is("locked"), fw.display_phase.key(), fw.display_phase(),
            "locked in the program for one camera");
    require(!fw.check_capture(), fw.check_capture.key(), fw.check_capture.text(),
            "false in the program for one camera (firmware.program)");
    warn_of_unwatched_fault(params);
    return;
  }
  const std::string watched = fault.kind.is("none") || !fw.program.is("auto") || count > 1
                                  ? ""
                                  : "; fault.kind asks for it, unless firmware.program = one_camera";
  require(fw.tables() == 1, fw.tables.key(), fw.tables.text(),
          "1 in the program for several cameras, each of which has a table of its own" + watched);
  require(fw.flow.is("double"), fw.flow.key(), fw.flow(),
          "double in the program for several cameras" + watched);
}

}  // namespace

void refuse_mobile_memory(const mem::DdrParams& ddr, std::string_view program) {
  require(!ddr.mobile(), ddr.part.key(), ddr.part(),
          fmt::format("DDR2 parts, whose times {} programs. A program of your own (firmware.elf) that programs mobile "
                      "DDR runs on it, and 'fovea replay TRACE -s {}={} -s ddr.preset=data_sheet' plays a recorded run "
                      "on it",
                      program, ddr.part.key(), ddr.part()));
}

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
  if (params.firmware.elf().empty()) refuse_mobile_memory(params.soc.ddr, "the board's own program");
  check_digital(params);
  check_cameras(params);
  if (!params.decoder.standard.user_set())
    params.decoder.standard.set(params.video.format().is_625 ? "625/50" : "525/60");
  const bool all_lines = params.video.format().height == kPlacementAll;
  if (all_lines && !params.decoder.crop_525.user_set()) params.decoder.crop_525.set("486_lines");
  require(all_lines == params.decoder.crop_525.is("486_lines"), params.decoder.crop_525.key(),
          params.decoder.crop_525(), "486_lines with video.standard = ntsc_486, and only then");
  // The firmware knows the raster of 486 lines by the switch for its size.
  for (const auto* side : {&v.width, &v.height})
    require(!all_lines || (*side)() == 0, side->key(), side->text(), "0 with video.standard = ntsc_486");
}

}  // namespace fovea::app
