#include "sw/fovea/explain/rules.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>

#include "model/common/masters.h"
#include "model/cpu/core/stalls.h"
#include "sw/fovea/explain/words.h"
#include "sw/fovea/results/names.h"
#include "sw/fovea/results/sleep.h"

namespace fovea::explain {
namespace {

/// "2 frames", "1 frame", "no frame"
std::string counted(double n, std::string_view what) {
  if (n == 0) return fmt::format("no {}", what);
  return fmt::format("{:.0f} {}{}", n, what, n == 1 ? "" : "s");
}

/// "a, b and c"
std::string listed(const std::vector<std::string>& items) {
  if (items.size() < 2) return items.empty() ? "" : items.front();
  return fmt::format("{} and {}", fmt::join(items.begin(), items.end() - 1, ", "), items.back());
}

}  // namespace

void find_rate(const Run& run, std::vector<Finding>& out) {
  const auto displayed = run.value(names::kDisplayed);
  if (!displayed || *displayed == 0 || !run.value(names::kRepeated)) return;
  const double repeated = run.value_or_zero(names::kRepeated),
               dropped = run.value_or_zero(names::kDropped);
  if (repeated == 0 && dropped == 0) {
    out.push_back(
        {"rate",
         fmt::format("The board keeps up with the camera: each of the {} shows a new picture.",
                     counted(*displayed, "displayed frame")),
         {names::kDisplayed, names::kRepeated, names::kDropped}});
  } else {
    out.push_back(
        {"rate",
         fmt::format("The board does not keep up with the camera: {:.0f} of the {} {} an earlier "
                     "picture again, and {:.0f} captured {} never shown.",
                     repeated, counted(*displayed, "displayed frame"),
                     repeated == 1 ? "shows" : "show", dropped,
                     dropped == 1 ? "frame was" : "frames were"),
         {names::kDisplayed, names::kRepeated, names::kDropped}});
  }
  if (const double n = run.value_or_zero(names::kCaptureOverflows); n > 0)
    out.push_back(
        {"overflow",
         fmt::format("{} of captured data {} lost, because the memory did not take {} in time.",
                     counted(n, "burst"), n == 1 ? "was" : "were", n == 1 ? "it" : "them"),
         {names::kCaptureOverflows}});
  if (const double n = run.value_or_zero(names::kDisplayUnderflows); n > 0)
    out.push_back(
        {"underflow",
         fmt::format("{} of picture data came too late for the display.", counted(n, "burst")),
         {names::kDisplayUnderflows}});
}

void find_budget(const Run& run, std::vector<Finding>& out) {
  const auto remap = run.value(names::kRemapTimeMean);
  const double period = run.frame_period();
  if (!remap || period <= 0 || run.remaps_in_a_row()) return;
  const std::string begin = fmt::format(
      "A remap takes {}, and a frame comes every {}: ", milliseconds(*remap), milliseconds(period));
  out.push_back({"budget",
                 begin + (*remap <= period
                              ? fmt::format("{} of the time is used and {} are left.",
                                            percent(*remap / period), milliseconds(period - *remap))
                              : fmt::format("it is {} too long for every frame.",
                                            milliseconds(*remap - period))),
                 {names::kRemapTimeMean, names::kWindow, names::kDisplayed}});
}

void find_latency_parts(const Run& run, std::vector<Finding>& out) {
  // Means over the frames whose four parts are known and follow one another.
  double capture = 0, wait = 0, remap = 0, until_shown = 0;
  std::size_t n = 0;
  for (const auto& f : run.frames()) {
    if (f.repeated || !f.capture_start || !f.capture_end || !f.remap_start || !f.remap_end) continue;
    const std::array times{*f.capture_start, *f.capture_end, *f.remap_start, *f.remap_end, f.display_start};
    if (!std::is_sorted(times.begin(), times.end())) continue;
    const auto seconds = [&](int i) {
      return 1e-12 * static_cast<double>(times[i + 1] - times[i]);
    };
    capture += seconds(0);
    wait += seconds(1);
    remap += seconds(2);
    until_shown += seconds(3);
    ++n;
  }
  if (n == 0) return;
  const auto mean = [&](double sum) { return milliseconds(sum / static_cast<double>(n)); };
  out.push_back(
      {"latency",
       fmt::format("From a frame's first captured sample to its first displayed one {} pass "
                   "on average: {} of capture, {} until the remap begins, {} of remap, and "
                   "{} until the display begins with it.",
                   mean(capture + wait + remap + until_shown), mean(capture), mean(wait),
                   mean(remap), mean(until_shown)),
       {"frames.csv"}});
}

void find_mover(const Run& run, std::vector<Finding>& out) {
  struct Mover {
    cpu::WakeEvent event;
    std::string_view port;
  };
  static constexpr std::array kMovers{Mover{cpu::WakeEvent::kDma, "edma_tc"},
                                      Mover{cpu::WakeEvent::kEngine, "remap_engine"}};
  const double all = run.value_or_zero(names::kCpuRemapCycles), asleep = run.value_or_zero(names::kCpuRemapIdle);
  // Less is a rest that the core waits for at the end of its own work.
  if (asleep <= 0 || asleep < 0.05 * all) return;
  std::vector<std::string> names, evidence{names::kCpuRemapIdle, names::kCpuRemapCycles}, sentences;
  for (const Mover& m : kMovers) {
    const cpu::WakeInfo& info = cpu::kWakeTable[static_cast<std::size_t>(m.event)];
    // The interrupts of others in the midst of a wait do not tell whom it is for.
    const std::string figure = fmt::format("cpu.remap.idle.{}", info.name);
    if (run.value_or_zero(figure) <= 0) continue;
    names.emplace_back(info.who);
    evidence.push_back(figure);
    const auto parts = run.waits_of(m.port);
    double whole = 0;
    for (const auto& [culprit, seconds] : parts) whole += seconds;
    std::vector<std::string> largest;
    for (const auto& [culprit, seconds] : parts)
      if (largest.size() < 3 && seconds >= 0.05 * whole)
        largest.push_back(fmt::format("{} {}", percent(seconds / whole), spent_by_port(culprit)));
    // A load at these ports waits there too, and the figures do not tell its requests apart.
    if (largest.empty() || run.loaded(m.port)) continue;
    sentences.push_back(fmt::format(" The time of all requests that {} made to the SDRAM in the whole window: {}.",
                                    info.who, listed(largest)));
    evidence.push_back(fmt::format("ddr.{}*.wait.*", m.port));
  }
  if (names.empty()) return;
  // If both ended sleeps, the figures do not tell for which of them the core slept.
  std::string text =
      fmt::format("In {} of the clocks of its remaps the core sleeps until {} is done.", percent(asleep / all),
                  names.size() == 1 ? names.front() : "the EDMA or the remap engine");
  for (const std::string& s : sentences) text += s;
  out.push_back({"mover", text, evidence});
}

void find_largest_wait(const Run& run, std::vector<Finding>& out) {
  const double awake = run.awake();
  const auto causes = run.stall_causes();
  if (awake <= 0 || causes.empty()) return;
  const auto& [cause, clocks] = causes.front();
  std::string text;
  if (const double share = awake / run.value_or_zero(names::kCpuCycles); share < 0.1)
    text = fmt::format("The core is awake in only {} of its clocks. ", percent(share));
  text += fmt::format(
      "Largest wait: in {} of the clocks in which it is awake, the core waits "
      "for {}",
      percent(clocks / awake), waits_for(cause));
  std::vector<std::string> evidence{"cpu.stall." + cause, names::kCpuCycles, names::kCpuIdle};
  std::vector<std::string> parts;
  for (const auto& [culprit, n] : run.culprits(cause)) {
    // Two parts say where it goes; smaller ones distract.
    if (parts.size() == 2 || n < 0.1 * clocks) break;
    parts.push_back(fmt::format("{}{} {}", percent(n / clocks), parts.empty() ? " of that" : "",
                                spent(culprit)));
    evidence.push_back("cpu.stall." + cause + ".by." + culprit);
  }
  if (!parts.empty()) text += fmt::format(" ({})", listed(parts));
  text += ".";
  if (const auto regions = run.regions(cause);
      !regions.empty() && regions.front().first != "none") {
    std::vector<std::string> names;
    for (const auto& [region, n] : regions) {
      if (names.size() == 3 || n < 0.1 * clocks) break;
      names.push_back(fmt::format("{} ({})", region, percent(n / clocks)));
    }
    if (!names.empty()) {
      text += fmt::format(" By what is accessed: {}.", listed(names));
      evidence.push_back("stalls.csv");
    }
  }
  text += fmt::format(" It issues instructions in {}.",
                      percent(run.value_or_zero(names::kCpuIssue) / awake));
  out.push_back({"largest_wait", text, evidence});
}

void find_function(const Run& run, std::vector<Finding>& out) {
  const auto functions = run.functions();
  if (functions.empty()) return;
  double all = 0;
  for (const auto& f : functions) {
    all += f.clocks;
    for (const auto& [cause, n] : f.causes)
      if (app::is_sleep(cause)) all -= n;
  }
  const FunctionClocks* largest = nullptr;
  double most = 0;
  for (const auto& f : functions) {
    double awake = f.clocks;
    for (const auto& [cause, n] : f.causes)
      if (app::is_sleep(cause)) awake -= n;
    if (awake > most) {
      most = awake;
      largest = &f;
    }
  }
  if (!largest || all <= 0) return;
  std::string text = fmt::format("The function {} takes {} of the core's awake clocks",
                                 largest->name, percent(most / all));
  const std::pair<const std::string, double>* wait = nullptr;
  for (const auto& cause : largest->causes)
    if (cause.first != "issue" && !app::is_sleep(cause.first) &&
        (!wait || cause.second > wait->second))
      wait = &cause;
  if (wait && wait->second >= 0.01 * most)
    text += fmt::format(", and waits in {} of these for {}", percent(wait->second / most),
                        waits_for(wait->first));
  out.push_back({"function", text + ".", {"profile.csv"}});
}

void find_other_masters(const Run& run, std::vector<Finding>& out) {
  const double awake = run.awake();
  if (awake <= 0) return;
  std::map<std::string, double> clocks;  // the EDMA has several ports
  double all = 0;
  for (const auto& [culprit, n] : run.culprits()) {
    if (culprit.starts_with("arm_") || master(culprit).empty()) continue;
    all += n;
    clocks[master(culprit)] += n;
  }
  if (all == 0) return;
  std::vector<std::pair<std::string, double>> order(clocks.begin(), clocks.end());
  std::stable_sort(order.begin(), order.end(),
                   [](const auto& a, const auto& b) { return a.second > b.second; });
  std::vector<std::string> parts;
  for (const auto& [name, n] : order)
    if (n >= 0.001 * awake) parts.push_back(fmt::format("{} {}", name, percent(n / awake)));
  out.push_back(
      {"other_masters",
       fmt::format("Waiting while other masters are served adds {} to the core's awake clocks{}{}.",
                   percent(all / awake), parts.empty() ? "" : ": ", listed(parts)),
       {"cpu.stall.*.by.*", names::kCpuCycles, names::kCpuIdle}});
}

void find_rows(const Run& run, std::vector<Finding>& out) {
  const double hits = run.value_or_zero(names::kDdrRowHits),
               misses = run.value_or_zero(names::kDdrRowMisses),
               conflicts = run.value_or_zero(names::kDdrRowConflicts), all = hits + misses + conflicts;
  if (all == 0) return;
  std::string text = fmt::format(
      "{} of the requests to the SDRAM find their row open, {} find another "
      "row open, {} a closed bank.",
      percent(hits / all), percent(conflicts / all), percent(misses / all));
  std::vector<std::string> evidence{names::kDdrRowHits, names::kDdrRowConflicts, names::kDdrRowMisses};
  if (const double awake = run.awake(); awake > 0) {
    double rows = 0;
    for (const auto& [culprit, n] : run.culprits())
      if (culprit.starts_with("row_")) rows += n;
    text += fmt::format(" Waiting until rows are opened takes {} of the core's awake clocks.", percent(rows / awake));
    evidence.push_back("cpu.stall.*.by.row_*");
  }
  out.push_back({"rows", text, evidence});
}

void find_sdram_use(const Run& run, std::vector<Finding>& out) {
  const auto use = run.value(names::kDdrUtilisation);
  if (!use) return;
  out.push_back(
      {"sdram",
       fmt::format("The SDRAM's data bus moves data in {} of the time. That alone does not say "
                   "whether a faster SDRAM would help.",
                   percent(*use)),
       {names::kDdrUtilisation}});
}

}  // namespace fovea::explain
