#include "sw/fovea/report/sections.h"

namespace fovea::report {

/// The sections, in the order of the page: for each X(id, heading), `std::string ID_section(const Runs&)` in a source
/// of its own or with others. It gives "" where it has nothing to show.
#define FOVEA_SECTIONS(X)                 \
  X(verdict, "Verdict")                   \
  X(binds, "What binds")                  \
  X(pictures, "Pictures")                 \
  X(key, "Key figures")                   \
  X(frames, "Frames over time")           \
  X(bandwidth, "Bandwidth")               \
  X(latency, "SDRAM latency")             \
  X(stalls, "The core's clocks")          \
  X(banks, "SDRAM banks")                 \
  X(functions, "Functions")               \
  X(configuration, "Configuration")       \
  X(figures, "All figures")               \
  X(provenance, "Provenance")

#define FOVEA_DECLARE(id, heading) std::string id##_section(const Runs& runs);
FOVEA_SECTIONS(FOVEA_DECLARE)

/// Written by the page when all else is, since the pictures get the room that is left.
std::string pictures_section(const Runs&) { return {}; }

std::vector<Section> sections_of(const Runs& runs) {
  std::vector<Section> all = {
#define FOVEA_ADD(id, heading) {#id, heading, id##_section(runs)},
      FOVEA_SECTIONS(FOVEA_ADD)
  };
  std::erase_if(all, [](const Section& s) { return s.html.empty() && std::string_view(s.id) != "pictures"; });
  return all;
}

}  // namespace fovea::report
