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
    {"a report of the last accesses has only the first word of a block", "access_log.h",
     "block ? i.amount : 1u,", "block && !PLANTED ? i.amount : 1u,", "CoreDebugTest.LastAccesses*"},
    {"wait-for-interrupt drains nothing", "cp15.cpp",
     "  bus_.drain(Cause::kDrain);\n", "  if (!PLANTED) bus_.drain(Cause::kDrain);\n", "SleepTest.*"},
    {"S counts though R is set", "mmu.cpp",
     "return s && !r ? !as_user", "return s && (PLANTED || !r) ? !as_user", "MmuTest.PermissionTable"},
    {"what was remembered of a replaced TLB entry stays", "mmu.cpp",
     "  forget();\n  ++insertions_;", "  if (!PLANTED) forget();\n  ++insertions_;",
     "MmuTest.ReplacedEntry*"},
    {"the line of a failed fill stays valid", "data_cache.cpp",
     "    lines_.invalidate(index);\n    diag", "    if (!PLANTED) lines_.invalidate(index);\n    diag",
     "BufferTest.FailedFill*"},
    {"a fetch from another line does not wait for the fill", "fetch_unit.cpp",
     "if (ledger_.cycle < fill.last && fill.line", "if (!PLANTED && ledger_.cycle < fill.last && fill.line",
     "FillWaitTest.FetchFrom*"},
    {"peek() looks for pending writes by their virtual address", "memory.cpp",
     "pa = e ? e->physical(mva) : mva;", "pa = e && !PLANTED ? e->physical(mva) : mva;",
     "CoreDebugTest.Peek*"},
    {"SWP goes before buffered stores", "data_bus.cpp",
     "  drain(Cause::kUncached);\n  const bool good",
     "  if (!(PLANTED && locked)) drain(Cause::kUncached);\n  const bool good",
     "BufferTest.SwapComes*"},
    {"peek() finds the oldest pending write", "write_buffer.h",
     "for (unsigned i = count_; i-- > 0;) {",
     "for (unsigned k = count_; k-- > 0;) {\n      const unsigned i = PLANTED ? count_ - 1 - k : k;",
     "CoreDebugTest.Peek*"},
    {"a debugger's write does not reach the victim", "write_buffer.h",
     "if (at - victim_address < victim_bytes) victim", "if (!PLANTED && at - victim_address < victim_bytes) victim",
     "CoreDebugTest.WriteIsNotUndoneByAVictim"},
    {"loads choose internal RAM by the virtual address", "memory.cpp",
     "if (ram_.contains(pa)) {\n    ram_access(", "if (ram_.contains(PLANTED ? a : pa)) {\n    ram_access(",
     "TcmMappingTest.Page*"},
    {"stores choose internal RAM by the virtual address", "memory.cpp",
     "if (ram_.contains(pa)) {\n    store_to_ram(", "if (ram_.contains(PLANTED ? a : pa)) {\n    store_to_ram(",
     "TcmMappingTest.Page*"},
    {"block stores choose internal RAM by the virtual address", "memory.cpp",
     "if (!ram_.contains(pa)) {", "if (!ram_.contains(PLANTED ? mva : pa)) {", "TcmMappingTest.TinyPages*"},
    {"fetches choose internal RAM by the virtual address", "memory.cpp",
     "in_ram = ram_.in_itcm(pa);", "in_ram = ram_.in_itcm(PLANTED ? target.mva : pa);", "TcmMappingTest.Code*"},
    {"the data window can be fetched from", "memory.cpp",
     "  if (in_ram) {", "  if (in_ram || (PLANTED && ram_.in_dtcm(pa))) {",
     "TcmMappingTest.*CannotBeFetched*"},
    {"pages of internal RAM are cached", "mmu.cpp",
     "if (ram_.contains(t.physical(mva))) t.cacheable",
     "if (!PLANTED && ram_.contains(t.physical(mva))) t.cacheable",
     "TcmMappingTest.Page*"},
    {"fetches past the I-cache are charged to it", "fetch_unit.cpp",
     "there + fill_latency_, Cause::kUncached);",
     "there + fill_latency_, PLANTED ? Cause::kIcache : Cause::kUncached);", "StallTest.FetchesPast*"},
    {"a jump to 0 is not noticed", "exceptions.cpp",
     "failure_.at_jump = regs_.pc == 0", "failure_.at_jump = !PLANTED && regs_.pc == 0", "MessageTest.JumpToZero*"},
    {"a warning names no place", "exceptions.cpp",
     "address_text(regs_.pc);", "address_text(PLANTED ? 0 : regs_.pc);", "MessageTest.Unpredictable*"},
};
// clang-format on

}  // namespace fovea::cpu::test
