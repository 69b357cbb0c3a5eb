// Finds keys without effect by trying: changes each key of camera and lens under each combination
// of choices that could make it ineffective, and compares what the firmware and the raster get.
// ParamBase::effects() must declare exactly the cases in which nothing changes.
#include <gtest/gtest.h>

#include <map>
#include <systemc>

#include "model/board/board_params.h"
#include "model/contract/words.h"
#include "sw/fovea/board/loader.h"
#include "sw/fovea/board/parameter_page.h"
#include "sw/lens/lens.h"
#include "tb/own_diagnostics.h"

namespace fovea::e2e {
namespace {

using video::RgbImage;
using Keys = std::map<std::string, std::string>;
constexpr unsigned kWidth = 320, kHeight = 240;  // the frame counter fits

bool declared_effective(const ParamBase& p) {
  for (const auto& effect : p.effects())
    if (!effect.effective()) return false;
  return true;
}

/// A still with something everywhere.
std::vector<RgbImage> footage() {
  RgbImage image{kWidth, kHeight, std::vector<std::uint8_t>(kWidth * kHeight * 3)};
  for (std::size_t i = 0; i < image.rgb.size(); ++i)
    image.rgb[i] = static_cast<std::uint8_t>(i * 7 + i / 960 * 11);
  return {image};
}

struct Settings {
  board::BoardParams params;
  ParamSet set;
  explicit Settings(const Keys& keys) {
    params.declare(set);
    for (const auto& [key, value] : keys) set.set(key, value);
  }
  /// The table that the firmware follows.
  std::vector<std::uint32_t> lut() {
    const auto source = video::make_picture_source(chart_.params.camera, {}, 720, 576);
    const auto bytes = app::parameter_page(params, *source);
    param_page_t page{};
    std::memcpy(&page, bytes.data(), bytes.size());
    EXPECT_EQ(param_page_check(&page), PARAM_PAGE_OK);
    lens_t lens;
    EXPECT_EQ(lens_init(&lens, &page.camera[0].view, 720, 576), LENS_OK);
    std::vector<std::uint32_t> out(lens_lut_entries(720, 576));
    lens_build_lut(&lens, out.data(), 720 * 2);
    return out;
  }
  /// A field that the camera sends.
  std::vector<std::uint8_t> field() {
    return video::make_picture_source(params.camera, footage(), kWidth, kHeight)->field(7).uyvy;
  }

 private:
  struct Chart {
    board::BoardParams params;
    Chart() { params.camera.kind.set("chart"); }
  } chart_;
};

/// Tries `changes` one by one on top of each of `bases`, which are `always` and the combinations.
template <typename Observe>
void expect_declared(const Keys& always, const std::vector<Keys>& bases, const Keys& changes,
                     Observe observe) {
  for (const Keys& extra : bases) {
    Keys base = always;
    for (const auto& [key, value] : extra) base[key] = value;
    std::string name;
    for (const auto& [key, value] : extra) name += key + "=" + value + " ";
    Settings before(base);
    const auto was = observe(before);
    for (const auto& [key, value] : changes) {

      Keys changed = base;
      changed[key] = value;
      Settings after(changed);
      EXPECT_EQ(observe(after) != was, declared_effective(*after.set.find(key)))
          << key << "=" << value << " on " << name;
    }
  }
}

TEST(EffectsTest, LensKeysAreIdleWhereDeclared) {
  std::vector<Keys> bases;
  for (const char* mapping : {"none", "rectilinear", "linear", "orthographic", "equisolid",
                              "stereographic", "kannala_brandt"})
    for (const char* focal : {"0px", "300px"})
      for (const char* out_focal : {"0px", "260px"})
        bases.push_back(
            {{"lens.mapping", mapping}, {"lens.focal", focal}, {"lens.out_focal", out_focal}});
  // Without a shift both pair methods take the same pairs of an uncorrected picture.
  expect_declared({{"lens.shift_x", "1px"}, {"lens.fov", "150deg"}}, bases,
                  {{"lens.fov", "140deg"},
                   {"lens.out_focal", "250px"},
                   {"lens.roi", "[100, 50, 360, 300]"},
                   {"lens.centre_x", "20px"},
                   {"lens.centre_y", "20px"},
                   {"lens.shift_x", "21px"},
                   {"lens.shift_y", "20px"},
                   {"lens.in_aspect", "1.5"},
                   {"lens.out_aspect", "1.5"},
                   {"lens.kb", "[250, 250, 480, 320, 0, 0, 0, 0]"},
                   {"lens.kb_width", "800px"},
                   {"lens.kb_height", "600px"},
                   {"lens.theta_max", "40deg"},
                   {"lens.paper_literal_focal", "true"},
                   {"lens.pair", "B"}},
                  [](Settings& s) { return s.lut(); });
}

TEST(EffectsTest, LensFocalIsIdleWithATableOrWithoutALens) {
  std::vector<Keys> bases;
  for (const char* mapping : {"none", "rectilinear", "linear", "orthographic", "equisolid",
                              "stereographic", "kannala_brandt"})
    for (const char* out_focal : {"0px", "260px"})
      bases.push_back({{"lens.mapping", mapping}, {"lens.out_focal", out_focal}});
  expect_declared({{"lens.fov", "150deg"}}, bases,
                  {{"lens.focal", "280px"}, {"lens.out_focal", "250px"}},
                  [](Settings& s) { return s.lut(); });
}

TEST(EffectsTest, CameraKeysAreIdleWhereDeclared) {
  std::vector<Keys> bases;
  for (const char* kind : {"sphere", "video", "chart"})
    for (const char* lens : {"kannala_brandt", "linear", "orthographic", "equisolid",
                             "stereographic"})
      for (const char* amplitude : {"0deg", "2deg"})
        for (const char* flat : {"0deg", "100deg"}) {
          // A flat film cannot be bent into a calibrated lens: an error.
          if (std::string(kind) == "video" && std::string(flat) != "0deg" &&
              std::string(lens) == "kannala_brandt")
            continue;
          bases.push_back({{"camera.kind", kind},
                           {"camera.lens", lens},
                           {"camera.motion_amplitude", amplitude},
                           {"camera.video_fov", flat}});
        }
  expect_declared({{"camera.kb", "[110, 110, 160, 120, 0, 0, 0, 0]"}, {"camera.fov", "170deg"}}, bases,
                  {{"camera.motion_period", "50"},
                   {"camera.stamp", "false"},
                   {"camera.fov", "150deg"},
                   {"camera.kb", "[120, 120, 160, 120, 0, 0, 0, 0]"},
                   {"camera.kb_width", "300px"},
                   {"camera.kb_height", "230px"}},
                  [](Settings& s) { return s.field(); });
}

TEST(EffectsTest, CameraChoicesAreIdleWhereDeclared) {
  const auto observe = [](Settings& s) { return s.field(); };
  std::vector<Keys> kinds = {{{"camera.kind", "sphere"}},
                             {{"camera.kind", "video"}},
                             {{"camera.kind", "video"}, {"camera.video_fov", "100deg"}},
                             {{"camera.kind", "chart"}}};
  const Keys always = {{"camera.kb", "[110, 110, 160, 120, 0, 0, 0, 0]"},
                       {"camera.fov", "170deg"},
                       {"camera.lens", "linear"}};
  expect_declared(always, kinds, {{"camera.lens", "equisolid"}, {"camera.motion_amplitude", "3deg"},
                                  {"camera.video_fov", "90deg"}},
                  observe);
}

TEST(EffectsTest, PortsWithoutALoadAreIdle) {
  const auto effective = [](const Keys& keys, const std::string& key) {
    Settings s(keys);
    return declared_effective(*s.set.find(key));
  };
  EXPECT_FALSE(effective({}, "bus.edma_tc1.width"));
  EXPECT_FALSE(effective({}, "bus.load.request_latency"));
  EXPECT_FALSE(effective({{"load.2.port", "edma_tc1"}}, "bus.edma_tc1.width")) << "no bursts";
  const Keys load{{"load.2.port", "edma_tc1"}, {"load.2.outstanding", "1"}};
  EXPECT_TRUE(effective(load, "bus.edma_tc1.width"));
  EXPECT_FALSE(effective(load, "bus.edma_tc2.width"));
  // kernel_keys.sh asks the traffic of each kernel about one of these keys.
  for (const contract::Word& kernel : contract::kKernels)
    for (const char* key : {"bus.edma_tc1.width", "cpu.tcm.dma_word_clocks", "cpu.tcm.banks"})
      EXPECT_EQ(effective({{"firmware.kernel", std::string(kernel.word)}}, key), contract::may_use_edma(kernel.code))
          << kernel.word << " " << key;
  EXPECT_TRUE(effective({}, "priority.edma_tc0")) << "the firmware switches the EDMA on to write it";
  for (const char* key : {"cpu.tcm.dma_word_clocks", "cpu.tcm.banks"})
    EXPECT_FALSE(effective({{"firmware.kernel", "codes"}}, key)) << key;
  EXPECT_TRUE(effective({}, "bus.arm_d.width"));
  EXPECT_TRUE(effective({}, "bus.vpfe.width"));
  EXPECT_FALSE(effective({{"load.2.port", "edma_tc1"}}, "load.2.gap"));
  EXPECT_TRUE(effective(load, "load.2.gap"));
  EXPECT_FALSE(effective(load, "load.gap"));
}

// `fovea exec --board`: the program may use what it likes.
TEST(EffectsTest, NothingIsKnownOfAProgramThatIsBrought) {
  const Keys plain{{"firmware.kernel", "plain"}};
  Settings s(plain);
  const char* const keys[] = {"bus.edma_tc1.width", "cpu.tcm.banks", "vpss.base_px_525", "firmware.watchdog"};
  for (const char* key : keys) EXPECT_FALSE(declared_effective(*s.set.find(key))) << key;
  s.params.hosted = true;
  for (const char* key : keys) EXPECT_TRUE(declared_effective(*s.set.find(key))) << key;
}

TEST(EffectsTest, TheDisplaysLinesFollowTheStandardOfOurFirmware) {
  const auto effective = [](const Keys& keys, const std::string& key) {
    Settings s(keys);
    return declared_effective(*s.set.find(key));
  };
  EXPECT_TRUE(effective({}, "vpss.base_px_625"));
  EXPECT_FALSE(effective({}, "vpss.base_px_525"));
  EXPECT_FALSE(effective({{"video.standard", "vga"}}, "vpss.base_py_625"));
  EXPECT_TRUE(effective({{"video.standard", "ntsc"}}, "vpss.base_py_525"));
  EXPECT_TRUE(effective({{"firmware.elf", "own.elf"}}, "vpss.base_px_525")) << "who knows";
  EXPECT_FALSE(effective({}, "tvp5146.crop_525"));
  EXPECT_TRUE(effective({{"tvp5146.standard", "525/60"}}, "tvp5146.crop_525"));
  EXPECT_TRUE(effective({{"video.standard", "vga"}}, "tvp5146.crop_525"));
  EXPECT_FALSE(effective({{"video.standard", "vga"}, {"tvp5146.standard", "625/50"}}, "tvp5146.crop_525"));
}

TEST(FootageNotesTest, SayWhatTheCameraChanges) {
  const auto notes = [](const Keys& keys, unsigned width, unsigned height, const app::FilmInfo& info,
                        std::size_t frames = 1) {
    Settings s(keys);
    return app::footage_notes(s.params, std::vector<RgbImage>(frames, RgbImage{width, height, {}}),
                              info);
  };
  const Keys film{{"camera.kind", "video"}};
  using Notes = std::vector<std::string>;
  EXPECT_EQ(notes(film, 640, 480, {{25}}), Notes{});
  EXPECT_EQ(notes(film, 720, 576, {{25}, 16.0 / 15}), Notes{}) << "television's own pixels";
  EXPECT_EQ(notes(film, 1280, 720, {{25}}),
            Notes{"footage of 1280x720 is stretched to 4:3, 25 % narrower"});
  EXPECT_EQ(notes(film, 480, 640, {{25}}),
            Notes{"footage of 480x640 is stretched to 4:3, 78 % wider"});
  EXPECT_EQ(notes(film, 640, 360, {{25}, 1, 1920, 1080}),
            Notes{"footage of 1920x1080 is stretched to 4:3, 25 % narrower"}) << "scaled when read";
  EXPECT_EQ(notes(film, 576, 720, {{25}, 16.0 / 15, 720, 576}),
            Notes{"footage of 576x720 is stretched to 4:3, 78 % wider"}) << "turned when read, with its pixels";
  EXPECT_EQ(notes(film, 640, 480, {{60}}),
            Notes{"footage of 60 frames/s is shown at 25 frames/s, 0.417 times as fast"});
  EXPECT_EQ(notes({{"camera.kind", "video"}, {"video.standard", "ntsc"}}, 640, 480, {{25}}),
            Notes{"footage of 25 frames/s is shown at 29.97 frames/s, 1.2 times as fast"});
  EXPECT_EQ(notes({{"camera.kind", "video"}, {"camera.video_fov", "90deg"}}, 1280, 720, {{25}}),
            Notes{}) << "a lens looks at it";
  EXPECT_EQ(notes(film, 640, 480, {{25}}, 249), Notes{});
  EXPECT_EQ(notes(film, 640, 480, {{25}}, 250),
            Notes{"at most the first 250 frames of the footage are used, over and over"});
  EXPECT_EQ(notes({{"camera.kind", "chart"}}, 1280, 720, {{60}}), Notes{});
}

// Fields in the order that is sent need no word; in the other one, or mixed by scaling or a lens, they do.
TEST(FootageNotesTest, SayWhatIsNotFollowedOfTheStream) {
  const auto notes = [](const Keys& keys, unsigned width, unsigned height, const app::FilmInfo& info) {
    Settings s(keys);
    return app::footage_notes(s.params, {RgbImage{width, height, {}}}, info);
  };
  const auto fields = [](app::FilmInfo::Fields f, double aspect) { return app::FilmInfo{{25}, aspect, 0, 0, f}; };
  using testing::AllOf;
  using testing::ElementsAre;
  using testing::HasSubstr;
  const Keys film{{"camera.kind", "video"}};
  const auto top = app::FilmInfo::Fields::kTopFirst, bottom = app::FilmInfo::Fields::kBottomFirst;
  EXPECT_THAT(notes(film, 720, 576, fields(top, 16.0 / 15)), testing::IsEmpty());
  EXPECT_THAT(notes(film, 720, 576, fields(bottom, 16.0 / 15)),
              ElementsAre(AllOf(HasSubstr("bottom field first, and the top one is sent first"),
                                HasSubstr("fieldorder=tff"))));
  EXPECT_THAT(notes(film, 720, 480, fields(top, 8.0 / 9)),
              ElementsAre(HasSubstr("top field first: its fields are taken")));
  const Keys ntsc{{"camera.kind", "video"}, {"video.standard", "ntsc"}, {"camera.video_fov", "0deg"}};
  Keys studio = ntsc;
  studio["tvp5146.crop_525"] = "studio";
  const auto rate = [](app::FilmInfo info) { return info.rate = Frequency(30000, 1001), info; };
  EXPECT_THAT(notes(ntsc, 720, 480, rate(fields(bottom, 8.0 / 9))), ElementsAre(HasSubstr("fieldorder=tff")));
  EXPECT_THAT(notes(studio, 720, 480, rate(fields(top, 8.0 / 9))), ElementsAre(HasSubstr("fieldorder=bff")));
  EXPECT_THAT(notes(studio, 720, 480, rate(fields(bottom, 8.0 / 9))), testing::IsEmpty());
  for (const char* hdr : {"smpte2084", "arib-std-b67", "linear", "log100"})
    EXPECT_THAT(notes(film, 640, 480, {{25}, 1, 640, 480, app::FilmInfo::Fields::kNone, hdr}),
                ElementsAre(HasSubstr(std::string("transfer function ") + hdr))) << hdr;
  for (const char* usual : {"bt709", "smpte170m", "iec61966-2-1", "unknown"})
    EXPECT_THAT(notes(film, 640, 480, {{25}, 1, 640, 480, app::FilmInfo::Fields::kNone, usual}), testing::IsEmpty());
}

// Calibrations that cannot belong to the picture, at the limit and one beyond.
std::vector<std::string> warnings_of(const Keys& keys, unsigned width, unsigned height) {
  const OwnDiagnostics diagnostics;
  Settings s(keys);
  s.params.camera.check_calibration(width, height);
  std::vector<std::string> out;
  for (const auto& [what, count] : diagnostics.counts()) out.push_back(what.second);
  return out;
}

TEST(CalibrationCheckTest, AnotherShapeIsWarnedOf) {
  const Keys keys{{"camera.kb_width", "960px"}, {"camera.kb_height", "640px"}};
  for (const auto& [w, h] : {std::pair(960, 640), std::pair(480, 320), std::pair(480, 321)})
    EXPECT_TRUE(warnings_of(keys, w, h).empty()) << w << "x" << h;
  const auto said = warnings_of({{"camera.kb_width", "960px"}, {"camera.kb_height", "640px"},
                                 {"camera.file", "own.png"}, {"camera.calibration", "left.yaml"}},
                                480, 322);
  ASSERT_EQ(said.size(), 1u);
  EXPECT_EQ(said[0],
            "camera.calibration 'left.yaml' is of a picture of 960x640, so it does not belong to "
            "camera.file 'own.png' (480x322), which has another shape");
}

TEST(CalibrationCheckTest, ACentreOutsideTheMiddleThirdIsWarnedOf) {
  // The middle of 601 columns is 300; a sixth of them is 100.17.
  EXPECT_TRUE(warnings_of({{"camera.kb", "[300, 300, 400, 300, 0, 0, 0, 0]"}}, 601, 601).empty());
  EXPECT_TRUE(warnings_of({{"camera.kb", "[300, 300, 300, 200, 0, 0, 0, 0]"}}, 601, 601).empty());
  const auto said =
      warnings_of({{"camera.kb", "[300, 300, 401, 300, 0, 0, 0, 0]"}, {"camera.file", "own.png"}}, 601,
                  601);
  ASSERT_EQ(said.size(), 1u);
  EXPECT_EQ(said[0],
            "camera.kb has its optical centre at 401, 300, outside the middle third of camera.file "
            "'own.png' (601x601), so it hardly belongs to this picture");
  EXPECT_EQ(warnings_of({{"camera.kb", "[300, 300, 300, 199, 0, 0, 0, 0]"}}, 601, 601).size(), 1u);
}

TEST(CalibrationCheckTest, OneLensSetAloneIsWarnedOf) {
  const auto said = [](const Keys& keys) {
    const OwnDiagnostics diagnostics;
    Settings s(keys);
    const auto source = video::make_picture_source(
        s.params.camera, {RgbImage{960, 640, std::vector<std::uint8_t>(960 * 640 * 3)}}, 720, 576);
    app::parameter_page(s.params, *source);
    std::vector<std::string> out;
    for (const auto& [what, count] : diagnostics.counts()) out.push_back(what.second);
    return out;
  };
  const Keys base{{"camera.kind", "sphere"}, {"lens.mapping", "kannala_brandt"}};
  const auto with = [&](Keys more) {
    more.insert(base.begin(), base.end());
    return said(more);
  };
  const std::string other = "[300, 320, 470, 331, 0, 0, 0, 0]";
  EXPECT_TRUE(with({}).empty());
  EXPECT_EQ(with({{"camera.kb", other}}).size(), 1u);
  EXPECT_EQ(with({{"lens.kb", other}}).size(), 1u);
  EXPECT_TRUE(with({{"lens.kb", other}, {"camera.kb", "[290, 320, 470, 331, 0, 0, 0, 0]"}}).empty())
      << "set on purpose";
}

TEST(CalibrationCheckTest, TheWrongKeyIsNotBlamed) {
  const auto error = [](const Keys& keys) -> std::string {
    try {
      Settings(keys).lut();
    } catch (const UserError& e) {
      return e.what();
    }
    return "";
  };
  EXPECT_EQ(error({{"lens.mapping", "kannala_brandt"}, {"lens.kb", "[0, 1, 1, 1, 0, 0, 0, 0]"}}),
            "key 'lens.kb': fx and fy are focal lengths in pixels; allowed: above 0");
  // The polynomial of left.yaml turns back at 86.9 degrees.
  const std::string left =
      "[303.34, 322.297, 486.493, 323.881, -0.0355105606, -0.0198482288, 0.026080053, -0.0097183762]";
  const std::string said = error({{"lens.mapping", "kannala_brandt"}, {"lens.kb", left}});
  EXPECT_EQ(said, "key 'lens.theta_max': 95deg, but the calibration of the lens (lens.kb) is valid "
                  "only up to 86.92 deg; use lens.theta_max=86deg");
  EXPECT_EQ(error({{"lens.mapping", "kannala_brandt"}, {"lens.kb", left}, {"lens.theta_max", "86deg"}}),
            "");
  EXPECT_NE(error({{"lens.mapping", "kannala_brandt"}, {"lens.kb", left}, {"lens.theta_max", "87deg"}}),
            "");
}

// The row of a camera: what it does not set is that of all cameras.
TEST(CameraRowTest, UnsetKeysAreThoseOfAllCameras) {
  Settings s({{"cameras.count", "3"},
              {"camera.kind", "chart"},
              {"lens.fov", "150deg"},
              {"lens.mapping", "linear"},
              {"tvp5146.phase", "3ms"},
              {"camera.1.lens.mapping", "stereographic"},
              {"camera.1.motion_period", "7"},
              {"camera.1.genlocked", "false"},
              {"camera.1.clock_offset", "-12.5ppm"},
              {"camera.2.phase", "9ms"},
              {"camera.2.standard", "525/60"}});
  const auto of = [&](unsigned n) { return s.params.camera_setup(n); };
  for (unsigned n = 0; n < 3; ++n) {
    EXPECT_TRUE(of(n).scene->kind.is("chart")) << n;
    EXPECT_EQ(of(n).lens->fov(), 150) << n;
    EXPECT_EQ(of(n).lens->mapping(), n == 1 ? "stereographic" : "linear");
    EXPECT_EQ(of(n).scene->motion_period(), n == 1 ? 7u : 60u);
    EXPECT_EQ(of(n).genlocked, n != 1);
    EXPECT_EQ(of(n).wiring.phase, 3 * kPsPerMs) << "genlocked, or not set";
    EXPECT_EQ(of(n).wiring.clock_offset, n == 1 ? -12.5 : 0);
    EXPECT_EQ(of(n).wiring.is_625, n != 2);
  }
  EXPECT_EQ(of(0).lens->mapping.key(), "lens.mapping");
  EXPECT_EQ(of(1).lens->mapping.key(), "camera.1.lens.mapping");
  EXPECT_FALSE(of(0).lens->kb.user_set()) << "a default is not passed on as if it were set";
  // Linux's tvp514x.h: INPUT_CVBS_VI2B, VI2A, VI2C.
  EXPECT_EQ(of(0).wiring.input, 5);
  EXPECT_EQ(of(1).wiring.input, 4);
  EXPECT_EQ(of(2).wiring.input, 6);
}

TEST(CameraRowTest, SettingsThatCannotBeAreRefused) {
  const auto error = [](const Keys& keys) -> std::string {
    try {
      Settings s(keys);
      app::complete_params(s.params);
    } catch (const UserError& e) {
      return e.what();
    }
    return "";
  };
  EXPECT_EQ(error({{"cameras.count", "2"}}), "");
  EXPECT_EQ(error({{"cameras.count", "2"}, {"camera.1.input", "vi_2_b"}}),
            "key 'camera.1.input': 'vi_2_b' is not allowed; allowed: an input that no other camera is on");
  EXPECT_EQ(error({{"camera.1.input", "vi_2_b"}}), "") << "there is no camera 1";
  EXPECT_NE(error({{"cameras.count", "2"}, {"firmware.tables", "2"}}), "");
  EXPECT_NE(error({{"cameras.count", "2"}, {"firmware.flow", "serial"}}), "");
  EXPECT_NE(error({{"fault.kind", "unplugged"}, {"fault.camera", "1"}}), "");
  EXPECT_EQ(error({{"fault.kind", "unplugged"}, {"fault.camera", "0"}}), "");
}

/// A fault of one camera: the program that `fovea run` takes and the warnings about keys, or the refusal.
std::string fault_of_one(const Keys& keys) {
  const OwnDiagnostics diagnostics;
  try {
    Settings s(keys);
    app::complete_params(s.params);
    std::string out = app::program_file(s.params).filename().string();
    for (const auto& [kind, count] : diagnostics.counts()) out += "; " + kind.second;
    return out;
  } catch (const UserError& e) {
    return e.what();
  }
}

TEST(FaultTest, OfOneCameraIsRunByTheProgramThatLooksForIt) {
  EXPECT_EQ(fault_of_one({}), "fovea_firmware.elf");
  for (const char* kind :
       {"unplugged", "wrong_standard", "sync_noise", "missing_lines", "short_lines", "clock_drift"}) {
    EXPECT_EQ(fault_of_one({{"fault.kind", kind}}), "fovea_cameras.elf") << kind;
    EXPECT_EQ(fault_of_one({{"fault.kind", kind}, {"firmware.program", "cameras"}}), "fovea_cameras.elf") << kind;
    EXPECT_EQ(fault_of_one({{"fault.kind", kind}, {"firmware.program", "one_camera"}}),
              "fovea_firmware.elf; key 'fault.kind': '" + std::string(kind) +
                  "' is not looked for by firmware.program = one_camera, which shows what comes and says nothing; the "
                  "program that does: cameras, or auto");
  }
  EXPECT_EQ(fault_of_one({{"fault.kind", "unplugged"}, {"firmware.elf", "other.elf"}}), "other.elf");
  EXPECT_EQ(fault_of_one({{"fault.kind", "unplugged"}, {"firmware.view", "four_way"}, {"cameras.count", "4"}}),
            "fovea_views.elf");
  EXPECT_EQ(fault_of_one({{"fault.kind", "unplugged"}, {"firmware.flow", "serial"}}),
            "key 'firmware.flow': 'serial' is not allowed; allowed: double in the program for several cameras; "
            "fault.kind asks for it, unless firmware.program = one_camera");
  EXPECT_EQ(fault_of_one({{"firmware.flow", "serial"}}), "fovea_firmware.elf");
}

TEST(FaultTest, OfTheMultiplexerNeedsOne) {
  const std::string refused =
      "key 'fault.kind': 'stuck_select' is not allowed; allowed: that of a camera, or any with cameras.multiplexer = "
      "gpio and cameras.count of 2 or more";
  Keys keys{{"fault.kind", "stuck_select"}};
  EXPECT_EQ(fault_of_one(keys), refused);
  keys["cameras.multiplexer"] = "gpio";
  EXPECT_EQ(fault_of_one(keys), refused) << "a camera alone";
  keys["cameras.count"] = "2";
  EXPECT_EQ(fault_of_one(keys), "fovea_cameras.elf");
  keys["cameras.multiplexer"] = "decoder";
  EXPECT_EQ(fault_of_one(keys), refused);
  EXPECT_NE(fault_of_one({{"fault.select_line", "3"}}), "fovea_firmware.elf") << "there are three";
  EXPECT_NE(fault_of_one({{"fault.select_level", "2"}}), "fovea_firmware.elf");
}

// The picture's edge, and one pixel beyond; a quarter of a side, and one pixel less.
TEST(RegionTest, LiesInThePicture) {
  const auto error = [](Keys keys, const std::string& roi) -> std::string {
    keys["lens.roi"] = roi;
    try {
      Settings(keys).lut();
    } catch (const UserError& e) {
      return e.what();
    }
    return "";
  };
  const Keys whole{{"lens.mapping", "linear"}}, part{{"lens.mapping", "linear"}, {"video.width", "320"}};
  EXPECT_EQ(error(whole, "[360, 288, 360, 288]"), "");
  EXPECT_EQ(error(whole, "[361, 288, 360, 288]"),
            "key 'lens.roi': '[361, 288, 360, 288]' is not allowed; allowed: [left, top, width, height] within the "
            "720x576 pixels of the picture, at least 180 wide or 144 high");
  for (const char* roi : {"[360, 289, 360, 288]", "[0, 0, 179, 143]", "[-1, 0, 360, 288]", "[5, 5, 0, 0]"})
    EXPECT_NE(error(whole, roi), "") << roi;
  for (const char* roi : {"[0, 0, 180, 1]", "[0, 0, 1, 144]", "[0, 0, 0, 0]", "[0.5, 0, 360.5, 288]"})
    EXPECT_EQ(error(whole, roi), "") << roi;
  EXPECT_EQ(error(part, "[160, 0, 160, 288]"), "");
  EXPECT_NE(error(part, "[161, 0, 160, 288]"), "") << "the picture is that of video.width";
}

TEST(RegionTest, WithoutALensTheRowOfACameraIsWarnedOf) {
  const OwnDiagnostics diagnostics;
  Keys keys{{"lens.mapping", "none"}};
  const auto whole = Settings(keys).lut();
  keys["camera.0.lens.roi"] = "[100, 50, 360, 300]";
  EXPECT_EQ(Settings(keys).lut(), whole);
  const auto said = diagnostics.counts();
  ASSERT_EQ(said.size(), 1u);
  EXPECT_EQ(said.begin()->first.second,
            "camera.0.lens.roi has no effect: it needs a lens.mapping other than none and a firmware.view other than "
            "birds_eye");
}

// Every key that declares a condition names it in a way that a sentence can end with, and its
// deciders are keys.
TEST(EffectsTest, DeclarationsAreComplete) {
  board::BoardParams params;
  ParamSet set;
  params.declare(set);
  unsigned declared = 0;
  for (const ParamBase* p : set.all())
    for (const auto& effect : p->effects()) {
      ++declared;
      EXPECT_FALSE(effect.condition.empty()) << p->key();
      EXPECT_FALSE(effect.deciders.empty()) << p->key();
      for (const ParamBase* decider : effect.deciders)
        EXPECT_EQ(set.find(decider->key()), decider) << p->key();
    }
  EXPECT_GT(declared, 60u);
}

}  // namespace
}  // namespace fovea::e2e

int sc_main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  return RUN_ALL_TESTS();
}
