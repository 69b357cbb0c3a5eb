// The names of figures that more than one source asks for. Every other source of the host program uses these.
#pragma once

namespace fovea::names {

inline constexpr const char* kCaptureOverflows = "capture.overflows";
inline constexpr const char* kCpuCycles = "cpu.cycles";
inline constexpr const char* kCpuIdle = "cpu.idle";
inline constexpr const char* kCpuInstructions = "cpu.instructions";
inline constexpr const char* kCpuIssue = "cpu.issue";
inline constexpr const char* kCpuRemapCycles = "cpu.remap.cycles";
inline constexpr const char* kCpuRemapIdle = "cpu.remap.idle";
inline constexpr const char* kCpuSpare = "cpu.spare";
inline constexpr const char* kDdrBusBytes = "ddr.bus_bytes";
inline constexpr const char* kDdrEfficiency = "ddr.efficiency";
inline constexpr const char* kDdrHeadroom = "ddr.headroom";
inline constexpr const char* kDdrReadBytes = "ddr.read_bytes";
inline constexpr const char* kDdrRowConflicts = "ddr.row_conflicts";
inline constexpr const char* kDdrRowHits = "ddr.row_hits";
inline constexpr const char* kDdrRowMisses = "ddr.row_misses";
inline constexpr const char* kDdrUtilisation = "ddr.utilisation";
inline constexpr const char* kDdrWriteBytes = "ddr.write_bytes";
inline constexpr const char* kDisplayUnderflows = "display.underflows";
inline constexpr const char* kDisplayed = "frame.displayed";
inline constexpr const char* kDropped = "frame.dropped";
inline constexpr const char* kLatencyMax = "frame.latency.max";
inline constexpr const char* kLatencyMean = "frame.latency.mean";
inline constexpr const char* kLatencyMin = "frame.latency.min";
inline constexpr const char* kRate = "frame.rate";
inline constexpr const char* kRemapRate = "frame.remap_rate";
inline constexpr const char* kRemapTimeMax = "frame.remap_time.max";
inline constexpr const char* kRemapTimeMean = "frame.remap_time.mean";
inline constexpr const char* kRemapTimeMin = "frame.remap_time.min";
inline constexpr const char* kRemapped = "frame.remapped";
inline constexpr const char* kRepeated = "frame.repeated";
inline constexpr const char* kRepeatedRelock = "frame.repeated_relock";
inline constexpr const char* kWindow = "frame.window";
inline constexpr const char* kStartupFirstFrame = "startup.first_frame";
inline constexpr const char* kStartupLutTime = "startup.lut_time";

}  // namespace fovea::names
