// A folder of results, written by hand.
#pragma once
#include <string>
#include <vector>

#include "sw/fovea/files/png.h"
#include "sw/fovea/results/outputs.h"
#include "sw/fovea/results/provenance.h"
#include "tb/unit/support.h"

namespace fovea::test {

struct HandMade {
  std::vector<app::StatRow> stats;
  std::vector<app::Warning> warnings;
  std::string version = app::program_provenance().version;
  std::string format = "fovea run 1", commit = "0123456789ab", experiment = "hand-made";
  std::string parameters =
      R"("a.key": {"value": "1", "unit": "", "origin": "default", "default": "1",
    "allowed": "0 .. 2", "tag": "choice", "source": "", "belief": null, "description": "a number"})";
  std::string command = R"(["run", "hand.yaml"])";
  bool complete = true;
  app::RunWords words;

  /// Writes config.json, stats.json and host.json into `name` and returns its path.
  std::filesystem::path write(const TempDir& dir, const std::string& name = "run") const {
    dir.write(name + "/config.json",
              "{\"format\": \"" + format + "\", \"version\": \"" + version + "\", \"commit\": \"" +
                  commit + "\", \"modified\": false, \"experiment\": \"" + experiment +
                  "\", \"sha256\": {\"firmware.elf\": \"ab12\"}, \"params\": {" + parameters +
                  "}}");
    dir.write(name + "/stats.json", app::stats_json(stats, complete, warnings, words));
    dir.write(
        name + "/host.json",
        "{\"version\": \"0\", \"command\": " + command +
            ", \"wall_time\": {\"value\": 2.5, \"unit\": \"s\", \"description\": \"host time\"}}");
    return dir / name;
  }
};

/// A run whose core is awake in 1000 of 1500 clocks; 2 frames of 40 ms, remapped in 10 ms each.
inline HandMade two_frames() {
  HandMade run;
  const auto count = [&](const char* name, std::uint64_t n, const char* unit = "1") {
    run.stats.push_back({name, n, unit, std::string("sentence of ") + name});
  };
  const auto number = [&](const char* name, double v, const char* unit) {
    run.stats.push_back({name, v, unit, std::string("sentence of ") + name});
  };
  count("frame.displayed", 2);
  count("frame.remapped", 2);
  count("frame.repeated", 0);
  count("frame.dropped", 0);
  number("frame.rate", 25.0, "1/s");
  number("frame.window", 0.08, "s");
  number("frame.remap_time.mean", 0.010, "s");
  count("cpu.cycles", 1500, "cycles");
  count("cpu.idle", 500, "cycles");
  count("cpu.issue", 300, "cycles");
  count("cpu.stall.dcache", 500, "cycles");
  count("cpu.stall.dcache.by.bridge", 200, "cycles");
  count("cpu.stall.dcache.by.service", 240, "cycles");
  count("cpu.stall.dcache.by.vpbe", 40, "cycles");
  count("cpu.stall.dcache.by.row_miss", 20, "cycles");
  count("cpu.stall.interlock", 200, "cycles");
  count("bus.arm_d.transactions", 9);
  count("bus.arm_d.read_bytes", 800, "B");
  count("bus.arm_d.write_bytes", 0, "B");
  count("bus.edma_tc0.transactions", 0);
  number("ddr.arm_d.latency.mean", 1.5e-7, "s");
  number("ddr.arm_d.latency.p50", 1.4e-7, "s");
  number("ddr.arm_d.latency.p95", 2e-7, "s");
  number("ddr.arm_d.latency.p99", 3e-7, "s");
  number("ddr.arm_d.latency.max", 1.25e-6, "s");
  number("ddr.edma_tc0.latency.mean", std::nan(""), "s");
  number("ddr.utilisation", 0.25, "ratio");
  count("ddr.row_hits", 80);
  count("ddr.row_misses", 15);
  count("ddr.row_conflicts", 5);
  count("ddr.bank0.row_hits", 80);
  count("ddr.bank0.row_misses", 15);
  count("ddr.bank0.row_conflicts", 5);
  return run;
}

/// The other files of a run, with the columns that they have.
inline void add_other_files(const TempDir& dir, const std::string& name) {
  dir.write(
      name + "/frames.csv",
      "frame,camera,captured_frame,capture_start_ns,capture_end_ns,remap_start_ns,remap_end_ns,"
      "display_start_ns,display_end_ns,dropped,repeated\n"
      "0,0,0,0.000,38000000.000,39000000.000,49000000.000,80000000.000,118000000.000,0,0\n"
      "1,0,1,40000000.000,78000000.000,79000000.000,89000000.000,120000000.000,158000000.000,0,"
      "0\n");
  dir.write(name + "/timeline.csv",
            "start_ns,end_ns,arm_d.read_bytes,arm_d.write_bytes,load.read_bytes,load.write_bytes\n"
            "0.000,1000000.000,1000,500,0,0\n1000000.000,2000000.000,3000,0,0,0\n");
  dir.write(name + "/stalls.csv",
            "cause,region,culprit,cycles\ndcache,frame_in,service,240\ndcache,lut,bridge,200\n"
            "dcache,lut,vpbe,40\ndcache,lut,row_miss,20\ninterlock,none,core,200\n");
  dir.write(name + "/latency.csv",
            "master,direction,beat,low_ns,high_ns,count\narm_d,read,first,128,256,7\narm_d,read,"
            "last,128,256,7\n");
  dir.write(
      name + "/slowest.csv",
      "master,direction,port,issued_ns,latency_ns,address,bytes,bank,row,row_state,step,place,culprit,begin_ns,time_"
      "ns\n"
      "arm_d,read,arm_d,80153412.345,1250.000,0x80123440,32,5,1170,conflict,1,port,bridge,80153412.345,24.700\n"
      "arm_d,read,arm_d,80153412.345,1250.000,0x80123440,32,5,1170,conflict,2,controller,vpbe,80153437.045,1000.000\n"
      "arm_d,read,arm_d,80153412.345,1250.000,0x80123440,32,5,1170,conflict,3,return,service,80154437.045,225.300\n"
      "vpbe,write,vpbe,1000.000,8.000,0x80000000,8,0,0,,1,port,bridge,1000.000,8.000\n");
  dir.write(name + "/uart.log", "boot\npicture 720x576 in 625/50, table\n");
  dir.write(
      name + "/profile.csv",
      "phase,function,file,line,cause,region,culprit,clocks,instructions\n"
      "boot,start,start.S,3,issue,,,1000,1000\n"
      "frames,remap,remap.c,10,issue,,,250,250\nframes,remap,remap.c,11,dcache,lut,bridge,500,0\n"
      "frames,main,main.c,5,issue,,,50,50\nframes,main,main.c,6,interlock,,,200,0\n"
      "frames,main,main.c,7,idle.capture,,,500,0\n");
  dir.write(name + "/profile.folded", "main 750\nmain;remap 750\n");
}

}  // namespace fovea::test
