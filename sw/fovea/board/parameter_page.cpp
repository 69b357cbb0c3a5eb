#include "sw/fovea/board/parameter_page.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "sw/fovea/board/kernel_choice.h"
#include "sw/fovea/board/view_page.h"
#include "sw/fovea/config/clock_setting.h"
#include "sw/lens/lens.h"
#include "sw/lens/region.h"

namespace fovea::app {
namespace {

/// The firmware's calibrated lens, in pixels of the camera's raster.
video::LensModel firmware_lens(const board::BoardParams& params, const board::LensParams& lens) {
  const auto& kb = lens.kb();
  return video::LensModel::kannala_brandt(kb[0], kb[1], kb[2], kb[3], {kb[4], kb[5], kb[6], kb[7]},
                                          lens.kb.key())
      .scaled(params.raster_width() / lens.kb_width(), params.raster_height() / lens.kb_height());
}

/// Warns if only one of the two lenses was set, which gives a distorted picture and is probably a
/// mistake. If both are set, the difference may be intended: firmware on a real board can be wrong
/// about its lens.
void check_same_lens(const board::BoardParams& params, const board::CameraSetup& setup,
                     const video::LensModel& firmware, const video::LensModel& camera) {
  const ListParam &of_camera = setup.scene->kb, &of_firmware = setup.lens->kb;
  if (of_firmware.user_set() == of_camera.user_set()) return;
  const auto apart = [](double a, double b, double scale) { return std::abs(a - b) > scale / 100; };
  if (!apart(firmware.fx(), camera.fx(), camera.fx()) &&
      !apart(firmware.fy(), camera.fy(), camera.fy()) &&
      !apart(firmware.cx(), camera.cx(), params.raster_width()) &&
      !apart(firmware.cy(), camera.cy(), params.raster_height()))
    return;
  DiagnosticsRef::current().configuration(
      fmt::format("{} is set and {} is not, and they describe different lenses (optical centre {:.1f}, {:.1f} "
                  "in the camera and {:.1f}, {:.1f} in the firmware, in pixels of the {}x{} raster); "
                  "{} sets both",
                  of_camera.user_set() ? of_camera.key() : of_firmware.key(),
                  of_camera.user_set() ? of_firmware.key() : of_camera.key(), camera.cx(), camera.cy(), firmware.cx(),
                  firmware.cy(), params.raster_width(), params.raster_height(), setup.scene->calibration.key()));
}

/// Warns if the firmware corrects another kind of lens than the camera has.
void check_same_mapping(const board::CameraSetup& setup) {
  const video::SceneParams& scene = *setup.scene;
  const board::LensParams& lens = *setup.lens;
  if (!scene.bends() || lens.mapping.is("none")) return;
  const DiagnosticsRef diagnostics = DiagnosticsRef::current();
  if (scene.lens() != lens.mapping()) {
    diagnostics.configuration(fmt::format("{} = {}, but the firmware corrects {} = {}: the picture stays distorted",
                                          scene.lens.key(), scene.lens(), lens.mapping.key(), lens.mapping()));
  } else if (!lens.mapping.is("kannala_brandt") && lens.focal() == 0 && scene.fov.user_set() != lens.fov.user_set() &&
             std::abs(scene.fov() - lens.fov()) > scene.fov() / 100) {
    const bool of_camera = scene.fov.user_set();
    const ParamBase &set = of_camera ? scene.fov : lens.fov, &other = of_camera ? lens.fov : scene.fov;
    diagnostics.configuration(fmt::format("{} is set ({}) and {} is not ({}): the firmware corrects another lens than "
                                          "the camera has",
                                          set.key(), set.text(), other.key(), other.text()));
  }
}

void fill_clocks(param_clocks_t& clocks, const board::ClockParams& params) {
  const board::ClockSetting setting = clock_setting({params.preset(), params.arm(), params.ddr()});
  const DdrRegisters ddr = ddr_registers(setting.ddr());
  const auto khz = [](Frequency f) { return static_cast<std::uint32_t>(f.num / (f.den * 1'000)); };
  clocks.pll1 = setting.pll1;
  clocks.pll2 = setting.pll2;
  clocks.vpss_clk_ctrl = setting.vpss_clk_ctrl;
  clocks.core_khz = khz(setting.core());
  clocks.ddr_khz = khz(setting.ddr());
  clocks.sdtimr = ddr.sdtimr;
  clocks.sdtimr2 = ddr.sdtimr2;
  clocks.sdrcr = ddr.sdrcr;
}

void fill_priorities(std::uint8_t (&priority)[PRIORITY_COUNT],
                     const board::PriorityParams& params) {
  std::fill(std::begin(priority), std::end(priority), std::uint8_t{PRIORITY_OF_RESET});
  for (const EnumParam& p : params.of) {
    const std::string name = p.key().substr(params.prefix().size() + 1);
    if (!p.is(board::PriorityParams::kOfReset))
      priority[contract::code_of(contract::kMasterWords, name)] =
          static_cast<std::uint8_t>(std::stoul(p()));
  }
}

/// A camera whose picture is larger than what is shown: by default the view shows it reduced to that size.
void scale_view(lens_view_t& view, const board::BoardParams& params) {
  const board::VideoFormat& format = params.video.format();
  const double x = static_cast<double>(format.width) / format.camera_width();
  const double y = static_cast<double>(format.height) / format.camera_height;
  if (!format.digital || (x == 1 && y == 1) || view.mapping == LENS_NONE || view.out_focal_px != 0) return;
  const double focal = view.focal_px != 0
                           ? view.focal_px
                           : lens_focal_from_fov(view.mapping, format.camera_width(), view.fov_deg,
                                                 (view.flags & PARAM_PAPER_LITERAL_FOCAL) != 0);
  view.out_focal_px = focal * x;
  view.out_aspect *= y / x;
}

/// The region of interest as scale and shift of the view, which is all that the firmware needs to know of it.
void show_region(lens_view_t& view, const board::BoardParams& params, const board::LensParams& lens) {
  const auto& roi = lens.roi();
  if (std::ranges::all_of(roi, [](double x) { return x == 0; })) return;
  if (view.mapping == LENS_NONE || params.firmware.view.is("birds_eye")) {
    // Of the keys of all cameras their declaration says so.
    if (lens.prefix() != params.lens.prefix())
      DiagnosticsRef::current().configuration(fmt::format(
          "{} has no effect: it needs a lens.mapping other than none and a firmware.view other than birds_eye",
          lens.roi.key()));
    return;
  }
  const lens_region_t region{roi[0], roi[1], roi[2], roi[3]};
  if (!lens_region_fits(&region, params.width(), params.height()))
    throw UserError(fmt::format("key '{}': '{}' is not allowed; allowed: [left, top, width, height] within the {}x{} "
                                "pixels of the picture, at least {} wide or {} high",
                                lens.roi.key(), lens.roi.text(), params.width(), params.height(),
                                params.width() / LENS_REGION_SCALE_MAX, params.height() / LENS_REGION_SCALE_MAX));
  const bool digital = params.video.format().digital;
  const lens_size_t shown{params.width(), params.height()};
  const lens_size_t source = digital ? lens_size_t{params.raster_width(), params.raster_height()} : shown;
  lens_t derived;
  // A lens that cannot be is the firmware's to refuse.
  if (lens_init_sizes(&derived, &view, source, shown) == LENS_OK) lens_show_region(&view, &derived, &region);
}

void fill_view(lens_view_t& view, const board::BoardParams& params,
               const board::CameraSetup& setup, const video::StampedSource& source) {
  const board::LensParams& lens = *setup.lens;
  lens_view_default(&view);
  view.flags = lens.paper_literal_focal() ? PARAM_PAPER_LITERAL_FOCAL : 0u;
  view.pair_method = contract::code_of(contract::kPairMethods, lens.pair());
  view.fov_deg = lens.fov();
  view.focal_px = lens.focal();
  view.out_focal_px = lens.out_focal();
  view.centre_x = lens.centre_x();
  view.centre_y = lens.centre_y();
  view.shift_x = lens.shift_x();
  view.shift_y = lens.shift_y();
  view.in_aspect = lens.in_aspect();
  view.out_aspect = lens.out_aspect();
  view.mapping = contract::code_of(contract::kMappings, lens.mapping());
  if (params.own_program()) check_same_mapping(setup);
  if (view.mapping == LENS_TABLE) {
    const double w = params.raster_width(), h = params.raster_height();
    const video::LensModel model = firmware_lens(params, lens);
    if (const auto* still = dynamic_cast<const video::SphereSource*>(&source);
        still && setup.scene->lens.is("kannala_brandt"))
      check_same_lens(params, setup, model, still->raster_lens());
    const double theta_max = lens.theta_max() * M_PI / 180;
    if (theta_max > model.theta_max() + 1e-12) {
      const double valid = model.theta_max() * 180 / M_PI;
      throw UserError(fmt::format(
          "key '{0}': {1}, but the calibration of the lens ({2}) is valid only up to "
          "{3:.2f} deg; use {0}={4:.0f}deg",
          lens.theta_max.key(), lens.theta_max.text(), lens.kb.key(), valid, std::floor(valid)));
    }
    const auto table = model.table(PARAM_TABLE_MAX, theta_max);
    view.table_count = PARAM_TABLE_MAX;
    view.theta_max = theta_max;
    std::copy(table.begin(), table.end(), view.table_r);
    view.focal_px = model.fx();
    view.in_aspect = model.fy() / model.fx();
    view.centre_x = model.cx() - (w - 1) / 2 + lens.centre_x();
    view.centre_y = model.cy() - (h - 1) / 2 + lens.centre_y();
  }
  scale_view(view, params);
  show_region(view, params, lens);
}

}  // namespace

std::vector<std::uint8_t> parameter_page(const board::BoardParams& params,
                                         const std::vector<const video::StampedSource*>& sources) {
  const board::FirmwareParams& firmware = params.firmware;
  check_kernel(params);
  param_page_t page{};
  fill_clocks(page.clocks, params.clocks);
  page.console = {0, firmware.baud_divisor()};
  fill_priorities(page.priority, params.priority);
  page.kernel = contract::code_of(contract::kKernels, firmware.kernel());
  page.table_builder = contract::code_of(contract::kBuilders, firmware.lut());
  page.flow = contract::code_of(contract::kFlows, firmware.flow());
  page.repeats = static_cast<std::uint32_t>(firmware.repeat());
  page.tables = static_cast<std::uint32_t>(firmware.tables());
  page.flags = (firmware.overlay() ? PARAM_OVERLAY : 0u) | (firmware.patch() ? PARAM_SELF_PATCH : 0u) |
               (params.soc.engine.present() ? PARAM_ENGINE : 0u) |
               (firmware.display_phase.is("free") ? PARAM_DISPLAY_FREE : 0u) |
               (firmware.check_capture() ? PARAM_CHECK_CAPTURE : 0u) |
               (params.video.format().digital ? PARAM_DIGITAL : 0u) | (params.multiplexed() ? PARAM_MULTIPLEXER : 0u);
  page.watchdog_us = static_cast<std::uint32_t>(firmware.watchdog() / kPsPerUs);
  page.width = params.width();
  page.height = params.height();
  page.camera_count = static_cast<std::uint32_t>(sources.size());
  for (unsigned n = 0; n < sources.size(); ++n) {
    const board::CameraSetup setup = params.camera_setup(n);
    page.camera[n].input = setup.wiring.input;
    page.camera[n].flags = setup.genlocked ? PARAM_CAMERA_GENLOCKED : 0u;
    fill_view(page.camera[n].view, params, setup, *sources[n]);
  }
  param_page_seal(&page);
  std::vector<std::uint8_t> bytes(page.bytes);
  std::memcpy(bytes.data(), &page, bytes.size());
  if (!firmware.view.is("single")) {
    const view_page_t view = view_page(params);
    bytes.resize(VIEW_PAGE_OFFSET + sizeof view);
    std::memcpy(bytes.data() + VIEW_PAGE_OFFSET, &view, sizeof view);
  }
  return bytes;
}

}  // namespace fovea::app
