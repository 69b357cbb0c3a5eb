// Defects of MMU, caches, buffers and internal RAM planted into the copy of the core (planted.h),
// with the tests that must fail for each. Numbered after kTimingDefects.
#pragma once

namespace fovea::cpu::test {

struct SystemDefect {
  const char* what;
  const char* file;   ///< in model/cpu/core
  const char* right;  ///< occurs exactly once in the file
  const char* wrong;
  const char* tests;  ///< a GoogleTest filter
};

// clang-format off
inline constexpr SystemDefect kSystemDefects[] = {
    {"the data port is free when the clock changes", "exceptions.cpp",
     "if (times[k] > at) *clocks[k] =", "if (times[k] > at && !(PLANTED && k == 0)) *clocks[k] =",
     "FillWaitTest.DataPort*"},
    {"words of a fill keep their clock's number when the clock changes", "exceptions.cpp",
     "for (std::size_t k = 0; k < clocks.size(); ++k)\n",
     "for (std::size_t k = 0; k < (PLANTED ? 1 : clocks.size()); ++k)\n", "FillWaitTest.WordsOf*"},
    {"a report of the last accesses has only the first word of a block", "exceptions.cpp",
     "k <= a.what >> 16", "k <= (PLANTED ? 0 : a.what >> 16)", "CoreDebugTest.LastAccesses*"},
    {"wait-for-interrupt drains nothing", "cp15.cpp",
     "  drain(Cause::kDrain);\n  const std::uint64_t begin",
     "  if (!PLANTED) drain(Cause::kDrain);\n  const std::uint64_t begin", "SleepTest.*"},
    {"S counts though R is set", "memory.cpp",
     "return s && !r ? !user", "return s && (PLANTED || !r) ? !user", "MmuTest.PermissionTable"},
    {"what was remembered of a replaced TLB entry stays", "memory.cpp",
     "    flush_memos();\n    e = &fresh;", "    if (!PLANTED) flush_memos();\n    e = &fresh;",
     "MmuTest.ReplacedEntry*"},
    {"the line of a failed fill stays valid", "memory.cpp",
     "    dcache_.invalidate(index);\n    Diag", "    if (!PLANTED) dcache_.invalidate(index);\n    Diag",
     "BufferTest.FailedFill*"},
    {"a fetch from another line does not wait for the fill", "memory.cpp",
     "if (cycle_ < ifill_.last && ifill_.line", "if (!PLANTED && cycle_ < ifill_.last && ifill_.line",
     "FillWaitTest.FetchFrom*"},
    {"peek() looks for pending writes by their virtual address", "memory.cpp",
     "pa = e ? e->physical(mva) : mva;", "pa = e && !PLANTED ? e->physical(mva) : mva;",
     "CoreDebugTest.Peek*"},
    {"SWP goes before buffered stores", "bus.cpp",
     "  drain(Cause::kUncached);\n  bus_read", "  if (!(PLANTED && swapping_)) drain(Cause::kUncached);\n  bus_read",
     "BufferTest.SwapComes*"},
    {"peek() finds the oldest pending write", "write_buffer.h",
     "for (unsigned i = count_; i-- > 0;) {",
     "for (unsigned k = count_; k-- > 0;) {\n      const unsigned i = PLANTED ? count_ - 1 - k : k;",
     "CoreDebugTest.Peek*"},
    {"a debugger's write does not reach the victim", "write_buffer.h",
     "if (at - victim_address < victim_bytes) victim", "if (!PLANTED && at - victim_address < victim_bytes) victim",
     "CoreDebugTest.WriteIsNotUndoneByAVictim"},
    {"loads choose internal RAM by the virtual address", "memory.cpp",
     "if (in_tcm(pa)) {\n    tcm_access(pa, TcmPort::Side::kData);\n    std::memcpy(&value",
     "if (in_tcm(PLANTED ? a : pa)) {\n    tcm_access(pa, TcmPort::Side::kData);\n    std::memcpy(&value",
     "TcmMappingTest.Page*"},
    {"stores choose internal RAM by the virtual address", "memory.cpp",
     "if (in_tcm(pa)) {\n    tcm_access(pa, TcmPort::Side::kData);\n    std::memcpy(tcm(pa)",
     "if (in_tcm(PLANTED ? a : pa)) {\n    tcm_access(pa, TcmPort::Side::kData);\n    std::memcpy(tcm(pa)",
     "TcmMappingTest.Page*"},
    {"block stores choose internal RAM by the virtual address", "memory.cpp",
     "if (!in_tcm(pa)) {", "if (!in_tcm(PLANTED ? mva : pa)) {", "TcmMappingTest.TinyPages*"},
    {"fetches choose internal RAM by the virtual address", "memory.cpp",
     "in_ram = in_itcm(pa);", "in_ram = in_itcm(PLANTED ? mva : pa);", "TcmMappingTest.Code*"},
    {"the data window can be fetched from", "memory.cpp",
     "line_epoch_ = in_ram ?", "if (PLANTED && in_dtcm(pa)) in_ram = true;\n  line_epoch_ = in_ram ?",
     "TcmMappingTest.*CannotBeFetched*"},
    {"pages of internal RAM are cached", "memory.cpp",
     "if (in_tcm(t.physical(mva))) t.cacheable", "if (!PLANTED && in_tcm(t.physical(mva))) t.cacheable",
     "TcmMappingTest.Page*"},
    {"fetches past the I-cache are charged to it", "memory.cpp",
     "there + fill_latency_, Cause::kUncached);",
     "there + fill_latency_, PLANTED ? Cause::kIcache : Cause::kUncached);", "StallTest.FetchesPast*"},
    {"a jump to 0 is not noticed", "exceptions.cpp",
     "failed_jump_ = pc_ == 0", "failed_jump_ = !PLANTED && pc_ == 0", "MessageTest.JumpToZero*"},
    {"a warning names no place", "exceptions.cpp",
     "address_text(pc_);", "address_text(PLANTED ? 0 : pc_);", "MessageTest.Unpredictable*"},
};
// clang-format on

}  // namespace fovea::cpu::test
