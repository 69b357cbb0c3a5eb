#include "model/board/board_params.h"

#include <algorithm>

namespace fovea::board {

BoardParams::BoardParams() {
  // Which lines and samples the display uses is the firmware's choice; only that of this project is
  // known to follow video.standard.
  const auto pal = [this] { return !firmware.elf().empty() || video.standard.is("pal"); };
  const auto not_pal = [this] { return !firmware.elf().empty() || !video.standard.is("pal"); };
  for (ParamBase* p : {&soc.vpss.base_px_625, &soc.vpss.base_py_625})
    p->matters_only("video.standard = pal", {&video.standard, &firmware.elf}, pal);
  for (ParamBase* p : {&soc.vpss.base_px_525, &soc.vpss.base_py_525})
    p->matters_only("video.standard = ntsc or vga", {&video.standard, &firmware.elf}, not_pal);
  // Ports that only a synthetic load drives.
  std::vector<const ParamBase*> loads;
  for (const auto& load : soc.loads) loads.insert(loads.end(), {&load.outstanding, &load.port});
  for (std::size_t i = 0; i < kStatCount; ++i) {
    const std::string name(kStatNames[i]);
    if (!name.starts_with("edma") && name != "remap_engine" && name != "load") continue;
    for (ParamBase* p : soc.crossbar.ports[i]->params())
      p->matters_only("a load with load.port = " + name, loads, [this, name] {
        return std::any_of(soc.loads.begin(), soc.loads.end(), [&](const bus::LoadParams& load) {
          return load.active() && load.port.is(name);
        });
      });
  }
  decoder.crop_525.matters_only("525 lines from the camera (tvp5146.standard, video.standard)",
                                {&decoder.standard, &video.standard}, [this] {
                                  return decoder.standard.user_set()
                                             ? decoder.standard.is("525/60")
                                             : !video.standard.is("pal");
                                });
}

}  // namespace fovea::board
