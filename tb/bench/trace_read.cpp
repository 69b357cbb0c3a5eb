// Reads a trace to its end, without playing it, for an instruction counter: see
// trace_instructions.sh.
#include <cstdio>
#include <exception>

#include "sw/fovea/replay/open_trace.h"

int main(int argc, char** argv) {
  using namespace fovea;
  if (argc != 2) {
    std::fprintf(stderr, "usage: bench_trace_read TRACE\n");
    return 2;
  }
  try {
    const app::OpenTrace trace = app::open_own_trace(argv[1]);
    const auto streams = static_cast<unsigned>(trace.info->streams.size());
    std::uint64_t records = 0, sum = 0;
    trace::Record r;
    for (bool any = true; any;) {
      any = false;
      for (unsigned s = 0; s < streams; ++s)
        if (trace.source->next(s, r)) {
          any = true;
          ++records;
          sum += r.address + r.at;
        }
    }
    std::printf("%llu records, sum %llu\n", static_cast<unsigned long long>(records),
                static_cast<unsigned long long>(sum));
  } catch (const std::exception& e) {
    std::fprintf(stderr, "%s\n", e.what());
    return 2;
  }
}
