#include "sw/fovea/regression/check_blame.h"

#include <fmt/format.h>

#include <cmath>
#include <map>
#include <vector>

namespace fovea::regression {
namespace {

/// Change of the figure's value; 0 if it has none.
double figure_change(const Finding& f) {
  return f.got && f.got->value && f.expected->value ? *f.got->value - *f.expected->value : 0;
}

/// Whether a change of clocks is enough to be blamed for a figure.
bool explains(const Difference& d, const Finding& f, double amount) {
  constexpr double kTime = 0.1, kPaced = 0.02;
  if (const auto clocks = needed(d, f.expected->name, figure_change(f))) {
    const bool paced = d.part == RunPart::kWindow || d.part == RunPart::kStartup;
    return std::abs(amount) >= (paced ? kPaced : kTime) * *clocks;
  }
  const double value = std::abs(f.expected->value.value_or(0));
  const double allowed = value > 0 ? f.expected->tolerance.allowed(value) / value : 0;
  return std::abs(amount) > allowed * d.busy.before;
}

/// Worse by more clocks. Of a time that is better than expected, the other way round.
bool is_slower(const std::vector<const Finding*>& failed, const Difference& d) {
  for (const Finding* const f : failed)
    if (needed(d, f->expected->name, 1)) return figure_change(*f) >= 0;
  return d.busy.change() >= 0 || std::abs(d.busy.change()) < 1;
}

std::string figures_text(const std::vector<const Finding*>& failed) {
  const std::string& first = failed.front()->expected->name;
  return failed.size() == 1 ? first : fmt::format("{} and {} more", first, failed.size() - 1);
}

std::string part_sentence(const std::vector<const Finding*>& failed, const Difference& d, std::string& named,
                          std::string& place) {
  const std::string part = part_text(d.part);
  if (!d.known)
    return fmt::format("nothing for {}, because the reference has no clocks {}; 'fovea bless' gives it them",
                       figures_text(failed), part);
  const Blame blame = blame_of(d, is_slower(failed, d));
  if (!blame.function) return blame_text(d, blame);
  for (const Finding* const f : failed)
    if (explains(d, *f, blame.function->share.change())) {
      named = place_text(*blame.function, nullptr);
      place = place_text(*blame.function, blame.line);
      return blame_text(d, blame);
    }
  return fmt::format("nothing for {}: {}busy clocks changed by {} of {}, which is not enough", figures_text(failed),
                     part.empty() ? "" : part + " ", amount_text(d, d.busy.change()),
                     amount_text(d, d.busy.before).substr(1));
}

}  // namespace

CheckBlame blame_failures(std::span<const Finding> findings, const Attribution& before, const Attribution& after,
                          const Circumstances& circumstances) {
  std::map<RunPart, std::vector<const Finding*>> parts;
  for (const Finding& f : findings)
    if (f.verdict == Verdict::kFail) parts[part_of_figure(f.expected->name)].push_back(&f);
  std::map<RunPart, Difference> differences;
  for (const auto& [part, failed] : parts) differences.emplace(part, difference_of(before, after, circumstances, part));
  // Remaps that are not told apart belong to the window.
  if (const auto remap = differences.find(RunPart::kRemap);
      remap != differences.end() && remap->second.part != RunPart::kRemap) {
    auto& window = parts[RunPart::kWindow];
    window.insert(window.begin(), parts[RunPart::kRemap].begin(), parts[RunPart::kRemap].end());
    differences.insert_or_assign(RunPart::kWindow, remap->second);
    differences.erase(remap);
    parts.erase(RunPart::kRemap);
  }
  CheckBlame out;
  std::vector<std::string> named;
  for (const RunPart part : {RunPart::kRemap, RunPart::kWindow, RunPart::kLut, RunPart::kStartup}) {
    const auto failed = parts.find(part);
    if (failed == parts.end()) continue;
    const Difference& d = differences.at(part);
    std::string who, place;
    const std::string text = part_sentence(failed->second, d, who, place);
    // The whole window and the whole start repeat what their parts say.
    const bool repeats = (part == RunPart::kWindow || part == RunPart::kStartup) && !named.empty() &&
                         (who.empty() || who == named.back());
    if (!text.empty() && !repeats && out.text.empty()) out.place = place;
    if (!text.empty() && !repeats) out.text += (out.text.empty() ? "" : "\nblamed: ") + text;
    if (!who.empty()) named.push_back(who);
    if (!out.difference) out.difference = d;
  }
  return out;
}

}  // namespace fovea::regression
