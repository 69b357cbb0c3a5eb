#include "sw/fovea/tools/slowest.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>

#include "sw/fovea/results/outputs.h"

namespace fovea::app {
namespace {

constexpr std::array<std::string_view, 4> kPlaces{"port", "crossbar", "controller", "return"};
constexpr std::array<std::string_view, 4> kRowStates{"", "hit", "miss", "conflict"};

}  // namespace

void add_slowest_rows(std::vector<SlowestRow>& rows, const std::string& master, const bus::LatencyStats& of,
                      const std::function<std::string(Master)>& name_of) {
  for (const bool write : {false, true}) {
    const SlowRequest* s = of.slowest(write);
    if (!s) continue;
    SlowestRow row{master,
                   write ? "write" : "read",
                   std::string(master_info(s->master).name),
                   std::string(kRowStates[static_cast<std::size_t>(s->found)]),
                   s->issued,
                   s->latency,
                   s->address,
                   s->row,
                   s->bytes,
                   s->bank,
                   {}};
    for (const RequestStep& step : s->steps) {
      std::string culprit = "not_known";
      if (index(step.culprit) < kMasterCount) {
        culprit = name_of(static_cast<Master>(step.culprit));
        if (culprit == master) culprit = "own";
      } else if (step.culprit != Culprit::kCount) {
        culprit = culprit_name(step.culprit);
      }
      row.steps.push_back({std::string(kPlaces[static_cast<std::size_t>(step.place)]), culprit, step.from, step.to});
    }
    rows.push_back(std::move(row));
  }
}

std::string slowest_csv(std::span<const SlowestRow> rows) {
  std::string out =
      "master,direction,port,issued_ns,latency_ns,address,bytes,bank,row,row_state,step,place,culprit,begin_ns,"
      "time_ns\n";
  for (const SlowestRow& r : rows) {
    const std::string request =
        fmt::format("{},{},{},{},{},0x{:08x},{},{},{},{}", csv_field(r.master), r.direction, r.port, ns_text(r.issued),
                    ns_text(r.latency), r.address, r.bytes, r.bank, r.row, r.row_state);
    for (std::size_t i = 0; i < r.steps.size(); ++i) {
      const SlowestStep& s = r.steps[i];
      out += fmt::format("{},{},{},{},{},{}\n", request, i + 1, s.place, csv_field(s.culprit), ns_text(s.from),
                         ns_text(s.to - s.from));
    }
  }
  return out;
}

std::vector<std::pair<std::string, Picoseconds>> slowest_parts(const SlowestRow& row) {
  std::map<std::string, Picoseconds> sums;
  for (const SlowestStep& s : row.steps) sums[s.culprit] += s.to - s.from;
  std::vector<std::pair<std::string, Picoseconds>> out(sums.begin(), sums.end());
  std::stable_sort(out.begin(), out.end(), [](const auto& a, const auto& b) { return a.second > b.second; });
  return out;
}

std::string slowest_when(const SlowestRow& row) {
  return fmt::format("{:.3f} us at {}.{:06} ms", static_cast<double>(row.latency) * 1e-6, row.issued / kPsPerMs,
                     row.issued % kPsPerMs / kPsPerNs);
}

std::vector<SlowestRow> slowest_of_each(std::span<const SlowestRow> rows) {
  std::vector<SlowestRow> out;
  for (const SlowestRow& r : rows) {
    const auto same = std::find_if(out.begin(), out.end(), [&](const SlowestRow& o) { return o.master == r.master; });
    if (same == out.end())
      out.push_back(r);
    else if (r.latency > same->latency)
      *same = r;
  }
  std::stable_sort(out.begin(), out.end(), [](const auto& a, const auto& b) { return a.latency > b.latency; });
  return out;
}

}  // namespace fovea::app
