#include "sw/fovea/tools/around.h"

#include <fmt/format.h>

#include <algorithm>
#include <tuple>

#include "sw/fovea/config/run_until.h"
#include "sw/fovea/results/outputs.h"
#include "sw/fovea/tools/tool.h"

namespace fovea::app {

void RequestsAround::responded(const MemRequest& r) {
  if (r.issued > to_ || r.last < from_) return;
  seen_.push_back({r.issued, r.first, r.last, r.address, r.master, r.bytes, r.in_path.priority, r.write});
}

std::string RequestsAround::csv() const {
  std::vector<Seen> sorted = seen_;
  // The order in which outcomes are decided depends on who runs ahead.
  std::sort(sorted.begin(), sorted.end(), [](const Seen& a, const Seen& b) {
    return std::tuple(a.issued, index(a.master), a.last, a.address) <
           std::tuple(b.issued, index(b.master), b.last, b.address);
  });
  std::string out = "master,direction,port,address,bytes,issued_ns,first_ns,last_ns,priority\n";
  for (const Seen& s : sorted)
    out += fmt::format("{},{},{},0x{:08x},{},{},{},{},{}\n", csv_field(name_of_(s.master)), s.write ? "write" : "read",
                       master_info(s.master).name, s.address, s.bytes, ns_text(s.issued), ns_text(s.first),
                       ns_text(s.last), s.priority);
  return out;
}

namespace {

class AroundTool final : public Tool {
 public:
  AroundTool(Picoseconds at, const ToolParts& parts)
      : requests_(at, parts.name_of), observing_(parts.observe(requests_)) {}
  void finish(const cpu::Counts&, ToolOutput& output) override {
    output.files.push_back({"requests.csv", requests_.csv(), true});
  }

 private:
  RequestsAround requests_;
  Subscription observing_;
};

Picoseconds time_of(const ToolValues& v) { return parse_time("--around", v.text("--around")); }

}  // namespace

ToolRow around_tool() {
  return {.what = "the list of requests",
          .needs = ToolNeeds::kMemory,
          .lacks = "there is no SDRAM",
          .options = {{"--around", "TIME",
                       "List all requests to the SDRAM within 2 us of this time (\"80.153412ms\", as slowest.csv has "
                       "it) in requests.csv",
                       "a time is needed"}},
          .make = [](const ToolValues& v, const ToolParts& parts) -> std::unique_ptr<Tool> {
            return std::make_unique<AroundTool>(time_of(v), parts);
          },
          .check = [](const ToolValues& v, bool) { time_of(v); }};
}

}  // namespace fovea::app
