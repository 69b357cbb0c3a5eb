// Parameters of the board: what is soldered, switched and loaded.
#pragma once
#include <array>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "model/board/camera_fault.h"
#include "model/board/camera_params.h"
#include "model/board/clock_presets.h"
#include "model/board/lens_params.h"
#include "model/board/priority_params.h"
#include "model/board/view_params.h"
#include "model/common/masters.h"
#include "model/contract/switches.h"
#include "model/soc/dm365.h"
#include "model/video/core/bt656.h"
#include "model/video/params.h"
#include "model/video/scene/scene_params.h"

namespace fovea::board {

struct RunParams : ParamGroup {
  using U = IntParam::Unit;
  IntParam frames{*this, "frames", U::kCount, 25, 1, 100'000,
                  "frames displayed in the measured window", Origin::kChoice, ""};
  IntParam start_limit{*this, "start_limit", U::kTime, 30 * kPsPerSecond, kPsPerMs,
                       3600 * kPsPerSecond,
                       "simulated time within which the first frame must be shown",
                       Origin::kChoice, ""};
  IntParam resets{*this, "resets", U::kCount, 0, 0, 1000,
                  "resets of the chip after which it boots again; the next one ends the run",
                  Origin::kChoice, ""};
  TextParam until{*this, "until", "frames",
                  "what ends the run, the first of a list that is met: frames (run.frames of them are "
                  "shown), time:2s (simulated), pc:main or pc:0x80008000 (reached), uart:TEXT (sent by "
                  "UART0), exit (semihosting), halt (nothing wakes the core), reset (of the chip, after "
                  "run.resets of them); "
                  "without frames the figures cover the whole run",
                  "frames, time:T, pc:ADDRESS, uart:TEXT, exit, halt, reset, or [a, b]"};
  RunParams() : ParamGroup("run") {}
};

struct UartParams : ParamGroup {
  TextParam input{*this, "input", "",
                  "file of what is typed on UART0, a step a line: wait TEXT (until UART0 has sent "
                  "it), send TEXT, at TIME; empty: nothing, or the input of --console"};
  UartParams() : ParamGroup("uart0") {}
};

struct ClockParams : ParamGroup {
  using U = IntParam::Unit;
  EnumParam preset{*this, "preset", std::string(kClockPresets.front().name), clock_preset_names(),
                   "MHz of core / DDR clock that the firmware programs",
                   Origin::kSourced, "TI boot loader for the DM36x (UBL, device.c)"};
  IntParam arm{*this, "arm", U::kHertz, 0, 0, hertz(most([](const ClockPreset& p) { return p.core(); })),
               "core clock instead of the preset's, where the PLLs can give it; 0: the preset's",
               Origin::kChoice, ""};
  IntParam ddr{*this, "ddr", U::kHertz, 0, 0, hertz(most([](const ClockPreset& p) { return p.ddr(); })),
               "SDRAM clock likewise; crossbar and video follow it, with half of it and all of it",
               Origin::kChoice, ""};
  IntParam crossbar{*this, "crossbar", U::kHertz, 0, 0, 1'000'000'000,
                    "clock of crossbar, EDMA and registers (SYSCLK4) apart from the SDRAM's, which no chip can have, "
                    "to find out which of the two binds; 0: half of the SDRAM's, from the same PLL",
                    Origin::kChoice, ""};
  ClockParams() : ParamGroup("clocks") {
    preset.matters_only("clocks.arm = 0Hz or clocks.ddr = 0Hz", {&arm, &ddr},
                        [this] { return arm() == 0 || ddr() == 0; });
  }

 private:
  static constexpr std::uint64_t hertz(Frequency f) { return f.num / f.den; }
};

/// A picture that camera and display may have: the raster that carries it, and its size. The DIP switches say both.
struct VideoFormat {
  std::string_view name;
  bool is_625;             ///< 625/50, otherwise 525/60: the display and any camera behind the decoder
  unsigned width, height;  ///< of what is corrected and shown, in the middle of the raster's active lines
  unsigned camera_height;  ///< of the picture that the camera sends
  std::uint32_t size_code; ///< enum switch_size of what is shown
  const video::Standard* digital = nullptr;  ///< raster of a camera at the digital port; null: one behind the decoder
  std::uint32_t camera_size_code = 0;        ///< enum switch_size of that camera

  /// Of the picture that the camera sends.
  unsigned camera_width() const { return digital ? digital->active_pixels : video::kActivePixels; }
};
/// ITU-R BT.601 and BT.656. An MT9V125 sends 25 frames a second in 625/50; the paper used 720x480 of it. The last
/// two are progressive: the first is shown as it is, in the middle of 525/60, the second is made smaller by the table.
inline constexpr std::array<VideoFormat, 7> kVideoFormats{{
    {"pal", true, 720, 576, 576, SWITCH_720X576},
    {"ntsc", false, 720, 480, 480, SWITCH_720X480},
    {"vga", false, 640, 480, 480, SWITCH_640X480},
    {"ntsc_486", false, 720, 486, 486, SWITCH_720X486},
    {"mt9v125", true, 720, 480, 480, SWITCH_720X480},
    {"vga_progressive", false, 640, 480, 480, SWITCH_640X480, &video::k480p, SWITCH_640X480},
    {"svga_progressive", true, 720, 576, 600, SWITCH_720X576, &video::k600p, SWITCH_800X600},
}};

struct VideoParams : ParamGroup {
  using U = IntParam::Unit;
  EnumParam standard{*this, "standard", "pal",
                     {"pal", "ntsc", "vga", "ntsc_486", "mt9v125", "vga_progressive", "svga_progressive"},
                     "720x576 in 625/50, 720x480 in 525/60, a 640x480 window in 525/60, 720x486 in 525/60, "
                     "720x480 in the middle of 625/50; or a progressive camera at the digital port: 640x480 shown "
                     "in 525/60, 800x600 shown as 720x576 in 625/50 (DIP switches)",
                     Origin::kChoice, ""};
  const VideoFormat& format() const {
    for (const VideoFormat& f : kVideoFormats)
      if (standard.is(f.name)) return f;
    return kVideoFormats.front();
  }
  IntParam width{*this, "width", U::kCount, 0, 0, 720,
                 "pixels of a centred region that is captured, corrected and shown; 0: all",
                 Origin::kChoice, ""};
  IntParam height{*this, "height", U::kCount, 0, 0, 576, "lines of that region; 0: all",
                  Origin::kChoice, ""};
  IntParam clock{*this, "clock", U::kHertz, 0, 0, 108'000'000,
                 "byte clock of a camera at the digital port, two periods a pixel; 0: 27 MHz with 640x480 "
                 "(858 x 525 pixels, 29.97 frames/s), 33.1584 MHz with 800x600 (1056 x 628, 25 frames/s)",
                 Origin::kChoice, "a sensor's registers choose its clock"};
  /// The byte clock of the camera at the digital port.
  Frequency digital_clock() const {
    return clock() ? Frequency(static_cast<std::uint64_t>(clock())) : format().digital->clock;
  }
  VideoParams() : ParamGroup("video") {
    clock.matters_only("video.standard = vga_progressive or svga_progressive", {&standard},
                       [this] { return format().digital != nullptr; });
  }
};

struct FirmwareParams : ParamGroup {
  TextParam elf{*this, "elf", "",
                "program to run; empty: the firmware that was built with Fovea"};
  EnumParam kernel{*this, "kernel", "plain", contract::words(contract::kKernels),
                   "how a frame is remapped: the paper's loop (plain), loops with smaller tables, or with "
                   "the EDMA (sw/firmware/README.md)",
                   Origin::kChoice, ""};
  EnumParam lut{*this, "lut", "fixed_point", contract::words(contract::kBuilders),
                "how the look-up table is computed at the start: in double precision, in software, or "
                "in fixed point",
                Origin::kChoice, ""};
  EnumParam flow{*this, "flow", "double", contract::words(contract::kFlows),
                 "double buffering, or the paper's capture, remap, show in turn",
                 Origin::kChoice, ""};
  IntParam repeat{*this, "repeat", IntParam::Unit::kCount, 1, 1, 1000,
                  "remap so many times in a row for each captured frame; with 2 or more the firmware no "
                  "longer waits for the camera with a large frame, so the remap runs at full speed",
                  Origin::kChoice, ""};
  IntParam tables{*this, "tables", IntParam::Unit::kCount, 1, 1, PARAM_TABLES_MAX,
                  "look-up tables that the remaps follow in turn, each of a view a little further right; "
                  "the sources are as many captured frames, in turn (one with firmware.flow=serial)",
                  Origin::kChoice, ""};
  EnumParam view{*this, "view", "single", contract::words(kViews),
                 "what is displayed: a camera at a time; four cameras at half width and half height; or "
                 "the ground around the car, seen from above (birds_eye)",
                 Origin::kChoice, ""};
  BoolParam overlay{*this, "overlay", false,
                    "a blinking box blended onto the picture through the cache",
                    Origin::kChoice, ""};
  BoolParam patch{*this, "patch", false, "the program patches its own code once",
                  Origin::kChoice, ""};
  EnumParam program{*this, "program", "auto", {"auto", "one_camera", "cameras"},
                    "which of the built programs runs: the one for one camera, or the one for up to eight, "
                    "which also watches the camera's signal and takes commands on UART0; auto: the "
                    "second one with cameras.count above 1, firmware.display_phase = free or a fault.kind",
                    Origin::kChoice, ""};
  EnumParam display_phase{*this, "display_phase", "locked", {"locked", "free"},
                          "the display starts in step with the camera, or on its own, before the decoder "
                          "has locked",
                          Origin::kChoice, ""};
  BoolParam check_capture{*this, "check_capture", false,
                          "input buffers are marked before a capture, and a frame in which a mark is left, because "
                          "a burst of it was lost, is said and left out; costs time for each frame",
                          Origin::kChoice, ""};
  IntParam watchdog{*this, "watchdog", IntParam::Unit::kTime, 5 * kPsPerSecond, 0, 60 * kPsPerSecond,
                    "if the program for several cameras or for composed views makes no progress for so long, the "
                    "watchdog resets the chip (run.resets); after half of it the program says so; 0: off",
                    Origin::kChoice, ""};
  EnumParam baud{*this, "baud", "115200", {"115200", "57600", "38400", "19200", "9600"},
                 "rate of UART0 that the firmware sets", Origin::kChoice, ""};
  /// Divisor of the UART's 24 MHz / 16, rounded.
  std::uint32_t baud_divisor() const {
    const auto rate = static_cast<std::uint32_t>(std::stoul(baud()));
    return (24'000'000 / 16 + rate / 2) / rate;
  }
  FirmwareParams() : ParamGroup("firmware") {
    program.matters_only("firmware.elf empty and firmware.view = single", {&elf, &view},
                         [this] { return elf().empty() && view.is("single"); });
  }
};

/// Switches that an installer may set besides those that follow from other keys.
struct SwitchParams : ParamGroup {
  EnumParam shift_x{*this, "shift_x", "centred", {"centred", "right", "left"},
                    "DIP switches for the view: 32 pixels, in addition to lens.shift_x", Origin::kChoice, ""};
  EnumParam shift_y{*this, "shift_y", "centred", {"centred", "down", "up"},
                    "the same for lines, in addition to lens.shift_y", Origin::kChoice, ""};
  /// The code of a shift switch.
  static std::uint32_t code(const EnumParam& shift) {
    return shift.is("centred")                       ? SWITCH_CENTRED
           : shift.is("right") || shift.is("down") ? SWITCH_FORWARD
                                                     : SWITCH_BACK;
  }
  SwitchParams() : ParamGroup("switches") {}
};

/// Devices that a board may have beside those of the camera.
struct DevicesParams : ParamGroup {
  BoolParam cpld{*this,
                 "cpld",
                 false,
                 "the CPLD of TI's DM365 EVM at 0x04000000 (AEMIF CE1), which Linux for that board "
                 "reads first",
                 Origin::kChoice,
                 ""};
  IntParam cpld_switch{
      *this,
      "cpld_switch",
      IntParam::Unit::kCount,
      0x20,
      0,
      255,
      "what the CPLD's SWITCH register reads; Linux takes bit 5 = 0 as NAND present",
      Origin::kChoice,
      "NAND is not modelled"};
  DevicesParams() : ParamGroup("board") {
    cpld_switch.matters_only("board.cpld = true", {&cpld}, [this] { return cpld(); });
  }
};

struct BoardParams : ParamTree {
  Declared<RunParams> run{*this};
  Declared<DevicesParams> devices{*this};
  Declared<UartParams> uart0{*this};
  Declared<ClockParams> clocks{*this};
  Declared<VideoParams> video{*this};
  Declared<FirmwareParams> firmware{*this};
  Declared<LensParams> lens{*this};
  Declared<SwitchParams> switches{*this};
  Declared<PriorityParams> priority{*this};
  Declared<video::SceneParams> camera{*this};
  Declared<CamerasParams> cameras{*this};
  Declared<FaultParams> fault{*this};
  Declared<video::Tvp5146Params> decoder{*this};
  std::array<CameraRow, kCamerasMax> camera_rows{{{*this, cameras.count, 0},
                                                  {*this, cameras.count, 1},
                                                  {*this, cameras.count, 2},
                                                  {*this, cameras.count, 3},
                                                  {*this, cameras.count, 4},
                                                  {*this, cameras.count, 5},
                                                  {*this, cameras.count, 6},
                                                  {*this, cameras.count, 7}}};
  Declared<BirdsEyeParams> birds_eye{*this};
  std::array<Declared<MountParams>, VIEW_CAMERAS> mounts{{{*this, 0u}, {*this, 1u}, {*this, 2u}, {*this, 3u}}};
  Declared<soc::Dm365Params> soc;
  /// @param blocks of the chip
  explicit BoardParams(soc::Placements blocks = soc::dm365_blocks());
  /// Everything that is set of a camera: what its row sets, and for the rest the keys of all cameras.
  CameraSetup camera_setup(unsigned camera) const;
  /// False if another program than this project's firmware runs, of which nothing is known.
  bool own_program() const { return !hosted && firmware.elf().empty(); }
  bool hosted = false;  ///< `fovea exec` brings the program
  unsigned camera_count() const { return static_cast<unsigned>(cameras.count()); }
  /// Whether an analogue multiplexer leads one of several cameras to one input of the decoder.
  bool multiplexed() const { return cameras.multiplexer.is("gpio") && camera_count() > 1; }
  /// Signals at the decoder: one if a quad processor joins those of the cameras.
  unsigned input_count() const { return cameras.quad() ? 1 : camera_count(); }
  /// Of the built programs it is the one for several cameras in turn, which one camera may have as well.
  bool takes_turns() const {
    if (!firmware.program.is("auto")) return firmware.program.is("cameras");
    return camera_count() > 1 || firmware.display_phase.is("free") || !fault.kind.is("none");
  }
  /// Size of the picture that the camera sends, and of what is corrected and shown.
  unsigned raster_width() const { return video.format().camera_width(); }
  unsigned raster_height() const { return video.format().camera_height; }
  unsigned width() const {
    return video.width() ? static_cast<unsigned>(video.width()) : video.format().width;
  }
  unsigned height() const {
    return video.height() ? static_cast<unsigned>(video.height()) : video.format().height;
  }

 private:
  /// The block of the model that drives a port which synthetic loads may use too; none: an empty condition.
  struct PortUse {
    std::string condition;  ///< for people: when the block uses its port
    std::vector<const ParamBase*> deciders;
    std::function<bool()> used;
  };
  PortUse block_at(const MasterInfo& port);
  /// Whether the firmware lets the EDMA move pixels; true also for a program of which that is not known.
  bool edma_moves_pixels() const;
  // Each says of some parameters when they matter.
  void link_video();
  void link_cameras();
  void link_views();
  void link_ports();
  void link_internal_ram();
};

}  // namespace fovea::board
