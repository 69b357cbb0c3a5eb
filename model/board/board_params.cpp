#include "model/board/board_params.h"

#include <algorithm>

#include "model/contract/words.h"

namespace fovea::board {
namespace {

const std::string kEdmaKernel = "a kernel that uses the EDMA or may fall back to one that does";

/// Whether `frames` is among the conditions of run.until, one or a list in brackets.
bool ends_by_frames(std::string_view until) {
  const auto plain = [](char c) { return c != ' ' && c != '[' && c != ']' && c != '"'; };
  std::string item;
  for (const char c : until) {
    if (c == ',') {
      if (item == "frames") return true;
      item.clear();
    } else if (plain(c)) {
      item += c;
    }
  }
  return item == "frames";
}

}  // namespace

BoardParams::BoardParams(soc::Placements blocks) : soc(*this, std::move(blocks)) {
  run.frames.matters_only("frames in run.until", {&run.until},
                          [this] { return ends_by_frames(run.until()); });
  run.start_limit.matters_only("run.until = frames", {&run.until},
                               [this] { return run.until() == "frames" || run.until() == "[frames]"; });
  link_video();
  link_cameras();
  link_views();
  link_ports();
  link_internal_ram();
}

void BoardParams::link_video() {
  // Which lines and samples the display uses is the firmware's choice; only that of this project is
  // known to follow video.standard.
  const auto pal = [this] { return !own_program() || video.format().is_625; };
  const auto not_pal = [this] { return !own_program() || !video.format().is_625; };
  for (ParamBase* p : {&soc.vpss.base_px_625, &soc.vpss.base_py_625})
    p->matters_only("video.standard = pal, mt9v125 or svga_progressive", {&video.standard, &firmware.elf}, pal);
  for (ParamBase* p : {&soc.vpss.base_px_525, &soc.vpss.base_py_525})
    p->matters_only("video.standard = ntsc, ntsc_486, vga or vga_progressive", {&video.standard, &firmware.elf},
                    not_pal);
  // A camera at the digital port is not behind the decoder, whose outputs lead nowhere then.
  const auto behind_decoder = [this] { return video.format().digital == nullptr; };
  std::vector<ParamBase*> of_decoder;
  for (ParamBase* p : decoder.params())
    if (p != &decoder.phase) of_decoder.push_back(p);
  for (ParamBase* p : camera_rows[0].wire.params()) of_decoder.push_back(p);
  for (ParamBase* p : of_decoder)
    p->matters_only("no video.standard of a camera at the digital port", {&video.standard}, behind_decoder);
  decoder.crop_525.matters_only("525 lines from the camera (tvp5146.standard, video.standard)",
                                {&decoder.standard, &video.standard}, [this] {
                                  return decoder.standard.user_set()
                                             ? decoder.standard.is("525/60")
                                             : !video.format().is_625;
                                });
}

void BoardParams::link_cameras() {
  cameras.multiplexer.matters_only("cameras.count of 2 or more", {&cameras.count},
                                   [this] { return camera_count() > 1; });
  firmware.watchdog.matters_only(
      "a program for several cameras (firmware.program, firmware.view, cameras.count or firmware.elf)",
      {&firmware.elf, &firmware.program, &firmware.view, &firmware.display_phase, &cameras.count},
      [this] { return !own_program() || !firmware.view.is("single") || takes_turns(); });
  for (unsigned n = 1; n < camera_rows.size(); ++n)
    camera_rows[n].wire.input.matters_only("cameras.multiplexer = decoder", {&cameras.multiplexer},
                                           [this] { return cameras.multiplexer.is("decoder"); });
}

void BoardParams::link_views() {
  const auto birds_eye_shown = [this] { return firmware.view.is("birds_eye"); };
  lens.roi.matters_only("a firmware.view other than birds_eye", {&firmware.view},
                        [birds_eye_shown] { return !birds_eye_shown(); });
  for (ParamBase* p : birds_eye.params())
    p->matters_only("firmware.view = birds_eye", {&firmware.view}, birds_eye_shown);
  for (unsigned n = 0; n < mounts.size(); ++n) {
    const EnumParam& own = camera_rows[n].scene.kind;
    for (ParamBase* p : mounts[n].params())
      p->matters_only("cameras.count above N, and firmware.view = birds_eye or camera.kind = car_park",
                      {&cameras.count, &firmware.view, &camera.kind, &own}, [this, n, &own, birds_eye_shown] {
                        const EnumParam& kind = own.user_set() ? own : camera.kind;
                        return n < camera_count() && (birds_eye_shown() || kind.is("car_park"));
                      });
  }
}

bool BoardParams::edma_moves_pixels() const {
  return !own_program() || contract::may_use_edma(contract::code_of(contract::kKernels, firmware.kernel()));
}

BoardParams::PortUse BoardParams::block_at(const MasterInfo& port) {
  switch (port.priority) {
    case PrioritySource::kQueue:
      return {kEdmaKernel, {&firmware.kernel, &firmware.elf}, [this] { return edma_moves_pixels(); }};
    case PrioritySource::kImcop:
      return {"an engine", {&soc.engine.kind}, [this] { return soc.engine.present(); }};
    default:
      return {"", {}, [] { return false; }};  // loads alone
  }
}

void BoardParams::link_ports() {
  std::vector<const ParamBase*> of_loads;
  for (const auto& load : soc.loads) of_loads.insert(of_loads.end(), {&load.outstanding, &load.port});
  const auto link = [this, of_loads](ParamBase& p, const MasterInfo& port) {
    const PortUse block = block_at(port);
    std::vector<const ParamBase*> deciders = of_loads;
    deciders.insert(deciders.end(), block.deciders.begin(), block.deciders.end());
    const std::string name(port.statistics);
    std::string condition = "a load with load.port = " + name;
    if (!block.condition.empty()) condition += ", or " + block.condition;
    p.matters_only(condition, deciders, [this, name, block] {
      return block.used() || std::any_of(soc.loads.begin(), soc.loads.end(), [&](const bus::LoadParams& load) {
               return load.active() && load.port.is(name);
             });
    });
  };
  for (const MasterInfo& port : kMasters.rows) {
    if (!port.load_allowed || port.side == Side::kWrites) continue;
    for (ParamBase* p : soc.crossbar.ports[stat_index(port.id)]->params()) link(*p, port);
    // Not the priority: the firmware writes its register at the start, for which it may have to switch on the block.
  }
}

void BoardParams::link_internal_ram() {
  std::vector<const ParamBase*> deciders;
  for (const auto& load : soc.loads) deciders.insert(deciders.end(), {&load.memory, &load.outstanding});
  deciders.insert(deciders.end(), {&firmware.elf, &firmware.kernel});
  const auto shared = [this] {
    return edma_moves_pixels() ||
           std::any_of(soc.loads.begin(), soc.loads.end(), [](const bus::LoadParams& load) {
             return load.active() && load.memory.is("internal_ram");
           });
  };
  for (ParamBase* p : std::initializer_list<ParamBase*>{&soc.cpu.tcm_dma_word_clocks,
                                                        &soc.cpu.tcm_dma_latency, &soc.cpu.tcm_first})
    p->matters_only("a load with load.memory = internal_ram, or " + kEdmaKernel, deciders, shared);
  deciders.push_back(&soc.cpu.tcm_own_conflict);
  soc.cpu.tcm_banks.matters_only(
      "a load with load.memory = internal_ram, " + kEdmaKernel + ", or cpu.tcm.own_conflict above 0 cycles",
      deciders, [this, shared] { return shared() || soc.cpu.tcm_own_conflict() > 0; });
}

}  // namespace fovea::board
