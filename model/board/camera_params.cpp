#include "model/board/camera_params.h"

#include "model/board/board_params.h"
#include "model/video/tvp5146.h"

namespace fovea::board {
namespace {

struct Input {
  const char* word;
  std::uint8_t code;
};
/// Composite inputs of the TVP5146: TI SLES084C, register 00; Linux's tvp514x.h has the same codes.
constexpr std::array<Input, 10> kInputs{{{"vi_1_a", 0x0},
                                         {"vi_1_b", 0x1},
                                         {"vi_1_c", 0x2},
                                         {"vi_2_a", 0x4},
                                         {"vi_2_b", 0x5},
                                         {"vi_2_c", 0x6},
                                         {"vi_3_a", 0x8},
                                         {"vi_3_b", 0x9},
                                         {"vi_3_c", 0xA},
                                         {"vi_4_a", 0xC}}};
/// The default decoder input of each camera: for camera 0 as on TI's evaluation module, for the others those beside it.
constexpr std::array<const char*, kCamerasMax> kInputOf{"vi_2_b", "vi_2_a", "vi_2_c", "vi_1_a",
                                                        "vi_1_b", "vi_1_c", "vi_3_a", "vi_3_b"};

std::vector<std::string> input_words() {
  std::vector<std::string> out;
  for (const Input& i : kInputs) out.emplace_back(i.word);
  return out;
}

/// Sets in `to` what is set in `from`, a group with the same parameters in the same order.
void take(ParamGroup& to, const ParamGroup& from) {
  for (std::size_t i = 0; i < from.params().size(); ++i)
    if (from.params()[i]->user_set()) to.params()[i]->set(from.params()[i]->text());
}

bool any_set(const ParamGroup& group) {
  for (const ParamBase* p : group.params())
    if (p->user_set()) return true;
  return false;
}

template <class Group>
std::unique_ptr<Group> merged(const Group& of_all, const Group& of_one) {
  auto out = std::make_unique<Group>(any_set(of_one) ? of_one.prefix() : of_all.prefix(), false);
  take(*out, of_all);
  take(*out, of_one);
  return out;
}

}  // namespace

CameraWireParams::CameraWireParams(std::string prefix, std::string default_input)
    : ParamGroup(std::move(prefix)),
      input(*this, "input", std::move(default_input), input_words(),
            "composite input of the decoder that this camera is on; the firmware for one camera "
            "selects vi_2_b",
            Origin::kChoice, ""),
      connected(*this, "connected", true, "false: the camera's cable is unplugged", Origin::kChoice,
                ""),
      standard(*this, "standard", "625/50", {"625/50", "525/60"},
               "what this camera sends; not set: tvp5146.standard", Origin::kChoice, ""),
      genlocked(*this, "genlocked", true,
                "its syncs are those of tvp5146.phase; not set: cameras.genlocked", Origin::kChoice,
                ""),
      phase(*this, "phase", IntParam::Unit::kTime, 0, 0, 40 * kPsPerMs,
            "start of its first field after power-up if it is not genlocked; not set: "
            "tvp5146.phase",
            Origin::kChoice, ""),
      clock_offset(*this, "clock_offset", "ppm", 0, -10'000, 10'000,
                   "of its clock from 27 MHz, in parts per million, if it is not genlocked",
                   Origin::kChoice, "") {}

CameraRow::CameraRow(ParamTree& tree, const IntParam& count, unsigned number)
    : wire("camera." + std::to_string(number), kInputOf.at(number)),
      scene("camera." + std::to_string(number), false),
      lens("camera." + std::to_string(number) + ".lens", false) {
  for (ParamGroup* group : std::initializer_list<ParamGroup*>{&wire, &scene, &lens}) {
    tree.add(*group);
    if (number == 0) continue;
    for (ParamBase* p : group->params())
      p->matters_only("cameras.count above " + std::to_string(number), {&count},
                      [&count, number] { return count() > number; });
  }
}

std::uint8_t decoder_input(const EnumParam& input) {
  for (const Input& i : kInputs)
    if (input.is(i.word)) return i.code;
  FOVEA_CHECK(false, "an input that is in no list");
}

CameraSetup BoardParams::camera_setup(unsigned number) const {
  const CameraRow& row = camera_rows.at(number);
  CameraSetup out;
  out.scene = merged<video::SceneParams>(camera, row.scene);
  out.lens = merged<LensParams>(lens, row.lens);
  const EnumParam& standard =
      row.wire.standard.user_set() ? row.wire.standard : decoder.standard;
  out.wiring.input = decoder_input(multiplexed() ? camera_rows[0].wire.input : row.wire.input);
  out.wiring.connected = row.wire.connected();
  out.wiring.is_625 = standard.is("625/50");
  out.wiring.placement = video::placement_of(decoder, standard.is("625/50"));
  out.genlocked =
      row.wire.genlocked.user_set() ? row.wire.genlocked() : cameras.genlocked();
  out.wiring.genlocked = out.genlocked && camera_count() > 1;
  out.wiring.phase = decoder.phase();
  if (!out.genlocked) {
    if (row.wire.phase.user_set()) out.wiring.phase = row.wire.phase();
    out.wiring.clock_offset = row.wire.clock_offset();
  }
  return out;
}

}  // namespace fovea::board
