// Small folders of results, made by hand.
#pragma once
#include <fmt/format.h>

#include <map>
#include <string>
#include <vector>

#include "sw/fovea/results/run_figures.h"
#include "tb/unit/support.h"

namespace fovea::regression {

/// A folder of results. The texts of values are written as they are, so that a test can write what
/// Fovea would not.
struct RunMaker {
  std::string version = "0.1.0", commit = "aaaaaaaaaaaa", experiment = "tiny";
  bool modified = false, complete = true;
  std::string elf = "11";                         ///< hash of the program
  std::string command, input, words;              ///< of exec and replay: `words` are further members of config.json
  std::map<std::string, std::string> parameters = {{"run.frames", "2"}, {"ddr.clock", "243MHz"}};
  /// name -> (value, unit)
  std::map<std::string, std::pair<std::string, std::string>> figures;
  std::string stalls, profile, functions;         ///< rows without the header; empty: no file
  std::string paths, objects;                     ///< the same
  bool chains = false;                            ///< the rows of the profile have `inlined_in` and `polls`
  bool no_stats = false;

  RunMaker& figure(const std::string& name, const std::string& value, const std::string& unit = "1") {
    figures[name] = {value, unit};
    return *this;
  }

  std::filesystem::path write(const test::TempDir& dir, const std::string& name) const {
    std::string config = fmt::format(
        "{{\n  \"format\": \"fovea run 1\",\n  \"version\": \"{}\",\n  \"commit\": \"{}\",\n  \"modified\": {},\n"
        "  \"experiment\": \"{}\",\n{}  \"sha256\": {{\"{}\": \"{}\"}},\n  \"params\": {{",
        version, commit, modified, experiment,
        command.empty() ? "" : fmt::format("  \"command\": \"{}\", \"input\": \"{}\", {}\n", command, input, words),
        command == "exec"     ? "program"
        : command == "replay" ? "trace"
                              : "firmware.elf",
        elf);
    const char* separator = "\n";
    for (const auto& [key, value] : parameters) {
      config += fmt::format("{}    \"{}\": {{\"value\": \"{}\", \"default\": \"{}\", \"tag\": \"choice\"}}",
                            separator, key, value, value);
      separator = ",\n";
    }
    dir.write(name + "/config.json", config + "\n  }\n}\n");
    std::string stats = fmt::format("{{\n  \"complete\": {},\n  \"band\": \"not run\",\n  \"warnings\": []", complete);
    for (const auto& [metric, value] : figures)
      stats += fmt::format(",\n  \"{}\": {{\"value\": {}, \"unit\": \"{}\", \"description\": \"d\"}}", metric,
                           value.first, value.second);
    if (!no_stats) dir.write(name + "/stats.json", stats + "\n}\n");
    // A folder of an earlier call keeps nothing.
    for (const char* file : {"stalls.csv", "profile.csv", "functions.csv", "paths.csv", "objects.csv"})
      std::filesystem::remove(dir / (name + "/" + file));
    if (!stalls.empty()) dir.write(name + "/stalls.csv", "cause,region,culprit,cycles\n" + stalls);
    if (!profile.empty())
      dir.write(name + "/profile.csv", "phase,function,file,line,cause,region,culprit,clocks,instructions" +
                                           std::string(chains ? ",inlined_in,polls\n" : "\n") + profile);
    if (!paths.empty()) dir.write(name + "/paths.csv", "phase,path,clocks\n" + paths);
    if (!objects.empty()) dir.write(name + "/objects.csv", "object,address,size\n" + objects);
    if (!functions.empty()) dir.write(name + "/functions.csv", "function,file,address,size,code\n" + functions);
    return dir / name;
  }
};

/// A run of 1,000 clocks with a loop of three lines, an interrupt handler and 300 idle clocks.
inline RunMaker profiled() {
  RunMaker r;
  r.figure("cpu.cycles", "1000", "cycles").figure("cpu.issue", "300", "cycles");
  r.figure("cpu.idle", "300", "cycles")
      .figure("cpu.spare", "300", "cycles")
      .figure("frame.remap_time.mean", "0.004", "s");
  r.figure("cpu.instructions", "300");
  r.stalls = "dcache,lut,bridge,150\ndcache,lut,vpbe,50\ninterlock,none,core,100\nicache,.text,bridge,100\n";
  r.profile =
      "frames,irq,irq.c,7,issue,,,50,50\n"
      "frames,irq,irq.c,7,icache,.text,bridge,100,0\n"
      "frames,remap,/src/remap.c,20,issue,,,100,100\n"
      "frames,remap,/src/remap.c,21,issue,,,100,100\n"
      "frames,remap,/src/remap.c,21,dcache,lut,bridge,150,0\n"
      "frames,remap,/src/remap.c,21,dcache,lut,vpbe,50,0\n"
      "frames,remap,/src/remap.c,22,issue,,,50,50\n"
      "frames,remap,/src/remap.c,22,interlock,none,core,100,0\n"
      "frames,sleep,cp15.c,3,idle.capture,,,300,0\n";
  r.functions =
      "irq,irq.c,0x00000100,64,aa\nremap,/src/remap.c,0x00000200,96,bb\nsleep,cp15.c,0x00000300,8,cc\n"
      "(data),,,4096,dd\n";
  return r;
}

}  // namespace fovea::regression
