#include "sw/fovea/parameter_page.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "sw/fovea/clock_setting.h"
#include "sw/lens/lens.h"

namespace fovea::app {
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

void fill_view(lens_view_t& view, const board::BoardParams& params,
               const video::StampedSource& source) {
  const board::LensParams& lens = params.lens;
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
  if (view.mapping == LENS_TABLE) {
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
    view.table_count = PARAM_TABLE_MAX;
    view.theta_max = theta_max;
    std::copy(table.begin(), table.end(), view.table_r);
    view.focal_px = model.fx();
    view.in_aspect = model.fy() / model.fx();
    view.centre_x = model.cx() - (w - 1) / 2 + lens.centre_x();
    view.centre_y = model.cy() - (h - 1) / 2 + lens.centre_y();
  }
}

}  // namespace

std::vector<std::uint8_t> parameter_page(const board::BoardParams& params,
                                         const video::StampedSource& source) {
  const board::FirmwareParams& firmware = params.firmware;
  param_page_t page{};
  fill_clocks(page.clocks, params.clocks);
  page.console = {0, firmware.baud_divisor()};
  fill_priorities(page.priority, params.priority);
  page.kernel = contract::code_of(contract::kKernels, firmware.kernel());
  page.table_builder = contract::code_of(contract::kBuilders, firmware.lut());
  page.flow = contract::code_of(contract::kFlows, firmware.flow());
  page.repeats = static_cast<std::uint32_t>(firmware.repeat());
  page.tables = static_cast<std::uint32_t>(firmware.tables());
  page.flags =
      (firmware.overlay() ? PARAM_OVERLAY : 0u) | (firmware.patch() ? PARAM_SELF_PATCH : 0u);
  page.width = params.width();
  page.height = params.height();
  page.camera_count = 1;
  fill_view(page.camera[0].view, params, source);
  param_page_seal(&page);
  std::vector<std::uint8_t> bytes(page.bytes);
  std::memcpy(bytes.data(), &page, bytes.size());
  return bytes;
}

}  // namespace fovea::app
