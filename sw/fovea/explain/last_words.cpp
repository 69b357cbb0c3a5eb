#include "sw/fovea/explain/last_words.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>
#include <optional>
#include <tuple>

#include "model/cpu/core/stalls.h"
#include "sw/fovea/explain/words.h"
#include "sw/fovea/explain/wrapped.h"
#include "sw/fovea/results/names.h"
#include "sw/fovea/results/sleep.h"
#include "sw/fovea/results/words.h"

namespace fovea::app {
namespace {

std::optional<double> real(std::span<const StatRow> stats, std::string_view name) {
  const StatRow* row = find(stats, name);
  if (!row) return std::nullopt;
  const double v = std::visit([](auto x) { return static_cast<double>(x); }, row->value);
  return std::isfinite(v) ? std::optional(v) : std::nullopt;
}

std::uint64_t count(std::span<const StatRow> stats, const std::string& name) {
  const StatRow* row = find(stats, name);
  const auto* n = row ? std::get_if<std::uint64_t>(&row->value) : nullptr;
  return n ? *n : 0;
}

/// A kind of the core's clocks: words for it, and how many clocks.
struct Part {
  std::string what;
  std::uint64_t amount;
};

/// The sleeps within remaps: waits for whom the program has given work to.
Part wait_of_remaps(std::span<const StatRow> stats) {
  const auto ended_by = [&](const char* event) {
    return static_cast<double>(count(stats, std::string("cpu.remap.idle.") + event));
  };
  const std::string_view event = waited_for(ended_by("dma"), ended_by("engine"));
  std::string who = "the EDMA or the remap engine";
  for (const cpu::WakeInfo& info : cpu::kWakeTable)
    if (event == info.name) who = info.who;
  return {"waiting for " + who, count(stats, names::kCpuRemapIdle)};
}

std::vector<Part> stalls(std::span<const StatRow> stats, const std::string& prefix) {
  std::vector<Part> out;
  for (const cpu::CauseInfo& info : cpu::kCauseTable)
    out.push_back({fmt::format("waiting for {}", info.waits_for),
                   count(stats, fmt::format("{}stall.{}", prefix, info.name))});
  return out;
}

/// All clocks of the window.
std::vector<Part> all_clocks(std::span<const StatRow> stats) {
  std::vector<Part> out = {{"executing", count(stats, names::kCpuIssue)}, wait_of_remaps(stats)};
  std::uint64_t rest = count(stats, names::kCpuIdle) - std::min(count(stats, names::kCpuIdle), out.back().amount);
  for (const cpu::WakeInfo& info : cpu::kWakeTable) {
    const std::string event = std::string("idle.") + info.name;
    const std::uint64_t clocks =
        count(stats, "cpu." + event) - std::min(count(stats, "cpu." + event), count(stats, "cpu.remap." + event));
    rest -= std::min(rest, clocks);
    const std::string words =
        is_idle(event) ? fmt::format("asleep until {}'s interrupt", info.who) : fmt::format("waiting for {}", info.who);
    // Within and without remaps the same words are one part.
    if (words == out[1].what) out[1].amount += clocks;
    else out.push_back({words, clocks});
  }
  out.push_back({"waiting for an interrupt", rest});  // of a run that does not tell them apart
  for (Part& p : stalls(stats, "cpu.")) out.push_back(std::move(p));
  return out;
}

std::vector<Part> clocks_of_remaps(std::span<const StatRow> stats) {
  std::vector<Part> out = {{"executing", count(stats, "cpu.remap.issue")}, wait_of_remaps(stats)};
  for (Part& p : stalls(stats, "cpu.remap.")) out.push_back(std::move(p));
  return out;
}

/// The parts of `total` in proportion to their clocks.
std::vector<Part> apportioned_parts(std::uint64_t total, std::vector<Part> parts) {
  std::vector<std::uint64_t> amounts;
  for (const Part& p : parts) amounts.push_back(p.amount);
  amounts = apportioned(total, amounts);
  for (std::size_t k = 0; k < parts.size(); ++k) parts[k].amount = amounts[k];
  return parts;
}

/// "what 1.2, what 0.3": the largest first, without zeros. Amounts are tenths.
std::string listed(std::vector<Part> parts, const char* unit = "") {
  std::stable_sort(parts.begin(), parts.end(),
                   [](const Part& a, const Part& b) { return a.amount > b.amount; });
  std::string out;
  for (const Part& p : parts)
    if (p.amount)
      out += fmt::format("{}{} {}.{}{}", out.empty() ? "" : ", ", p.what, p.amount / 10, p.amount % 10,
                         unit);
  return out;
}

constexpr std::size_t kLabelWidth = 8;

/// Stands for a space at which no line ends, between a number and its unit.
constexpr char kNoBreak = '\x1f';

std::string unbroken(std::string text) {
  std::replace(text.begin(), text.end(), ' ', kNoBreak);
  return text;
}

/// `label` in the first column, the text in the second, wrapped.
std::string paragraph(std::string label, const std::string& text) {
  label.resize(kLabelWidth, ' ');
  std::string out = label + wrapped(text, kLabelWidth) + "\n";
  std::replace(out.begin(), out.end(), kNoBreak, ' ');
  return out;
}

/// The core's clocks by what they were spent on, in percent that add up to 100.
std::string core_line(std::span<const StatRow> stats) {
  if (count(stats, names::kCpuCycles) == 0) return "";
  return paragraph("core", listed(apportioned_parts(1000, all_clocks(stats)), "\x1f%"));
}

/// "the display" for `vpbe`; empty for masters of which a chip has several, which their names tell apart.
std::string master_words(std::string_view name) {
  return name.starts_with("edma_tc") ? "" : explain::master(name);
}

std::string culprit_words(const std::string& name) {
  if (const auto* words = results::find_culprit(name)) return std::string(words->label);
  const std::string who = master_words(name);
  return "behind " + (who.empty() ? name : who);
}

/// The master and direction whose requests took longest at the SDRAM, all together, with the largest parts.
std::string wait_line(std::span<const StatRow> stats) {
  struct Group {
    std::string who;
    double total = 0;
    std::vector<std::pair<double, std::string>> parts;
  };
  std::map<std::string, Group> groups;
  constexpr std::string_view kWait = ".wait.";
  for (const StatRow& row : stats) {
    const auto at = row.name.find(kWait);
    if (!row.name.starts_with("ddr.") || at == std::string::npos) continue;
    const auto t = real(stats, row.name);
    if (!t || *t <= 0) continue;
    const std::string rest = row.name.substr(at + kWait.size());  // read.CULPRIT
    const std::string direction = rest.substr(0, rest.find('.'));
    const std::string master = row.name.substr(4, at - 4);
    Group& g = groups[master + " " + direction];
    const std::string words = master_words(master);
    g.who = fmt::format("all {}s of {}{}", direction, master, words.empty() ? "" : " (" + words + ")");
    g.total += *t;
    g.parts.emplace_back(*t, culprit_words(rest.substr(rest.find('.') + 1)));
  }
  const auto most = std::max_element(groups.begin(), groups.end(),
                                     [](const auto& a, const auto& b) { return a.second.total < b.second.total; });
  if (most == groups.end()) return "";
  Group& g = most->second;
  std::stable_sort(g.parts.begin(), g.parts.end(), [](const auto& a, const auto& b) { return a.first > b.first; });
  constexpr std::size_t kParts = 2;
  std::vector<std::string> parts;
  for (std::size_t k = 0; k < std::min(kParts, g.parts.size()); ++k)
    if (const double percent = 100 * g.parts[k].first / g.total; percent >= 0.5)  // as shown not zero
      parts.push_back(fmt::format("{} {:.0f}\x1f%", g.parts[k].second, percent));
  return paragraph("waits", fmt::format("{} take {} together: {}", g.who, unbroken(human_text(g.total, "s")),
                                        fmt::join(parts, ", ")));
}

/// A line for each master: its slowest request, and as many of its parts as find room.
std::string slowest_lines(std::span<const SlowestRow> rows) {
  constexpr std::size_t kMasters = 3, kLine = 80;
  std::string out;
  const auto each = slowest_of_each(rows);
  for (std::size_t i = 0; i < std::min(kMasters, each.size()); ++i) {
    const SlowestRow& r = each[i];
    std::string line =
        fmt::format("{:{}}{} of {}: {}", i == 0 ? "slowest" : "", kLabelWidth, r.direction, r.master, slowest_when(r));
    const char* separator = "; ";
    for (const auto& [culprit, time] : slowest_parts(r)) {
      const auto* found = results::find_culprit(culprit);
      const std::string words = found ? std::string(found->brief)
                                : explain::master(culprit).empty() ? culprit_words(culprit)
                                                                   : "behind " + culprit;
      const std::string part = fmt::format("{}{} {:.2f}", separator, words, static_cast<double>(time) * 1e-6);
      if (line.size() + part.size() > kLine) break;
      line += part;
      separator = ", ";
    }
    out += line + "\n";
  }
  return out;
}

/// How near the displayed pictures are to ideal ones, where they are compared.
std::string quality_line(std::span<const StatRow> stats) {
  std::vector<std::string> parts;
  for (const auto& [name, what, digits, unit] :
       {std::tuple("psnr_y", "PSNR", 1,
                   "\x1f"
                   "dB"),
        std::tuple("ssim_y", "SSIM", 3, ""), std::tuple("straightness", "straight lines bend by", 2, "\x1fpixels"),
        std::tuple("line_error", "lines are off by", 2, "\x1fpixels")})
    if (const auto v = real(stats, std::string("quality.") + name))
      parts.push_back(fmt::format("{} {:.{}f}{}", what, *v, digits, unit));
  return parts.empty() ? "" : paragraph("quality", fmt::format("{}", fmt::join(parts, ", ")));
}

/// "SDRAM busy 17.2 % ...". `seconds`: of the figures.
std::string sdram_line(std::span<const StatRow> stats, std::optional<double> seconds) {
  std::vector<std::string> parts;
  if (const auto busy = real(stats, names::kDdrUtilisation))
    parts.push_back(fmt::format("data bus busy {:.1f}\x1f%", 100 * *busy));
  if (const auto idle = real(stats, names::kDdrHeadroom))
    parts.push_back(fmt::format("no request queued {:.1f}\x1f%", 100 * *idle));
  if (seconds && *seconds > 0)
    for (const auto& [name, what] : {std::pair(names::kDdrReadBytes, "reads"), {names::kDdrWriteBytes, "writes"}})
      if (const std::uint64_t bytes = count(stats, name))
        parts.push_back(fmt::format("{} {:.1f}\x1fMB/s", what, static_cast<double>(bytes) / *seconds * 1e-6));
  const std::uint64_t hits = count(stats, names::kDdrRowHits);
  if (const std::uint64_t all = hits + count(stats, names::kDdrRowMisses) + count(stats, names::kDdrRowConflicts))
    parts.push_back(fmt::format("row hits {:.1f}\x1f%", 100 * static_cast<double>(hits) / static_cast<double>(all)));
  if (parts.empty()) return "";
  return paragraph("SDRAM", fmt::format("{}", fmt::join(parts, ", ")));
}

std::string host_line(std::span<const StatRow> host) {
  std::vector<std::string> parts;
  const auto add = [&](const char* name, double scale, const char* what) {
    if (const auto v = real(host, name)) parts.push_back(fmt::format("{:.3g}{}{}", *v * scale, kNoBreak, what));
  };
  const auto add_text = [&](const char* name, const char* behind) {
    if (const StatRow* row = find(host, name)) parts.push_back(unbroken(human_text(row->value, row->unit)) + behind);
  };
  add_text("wall_time", "");
  add_text("realtime_factor", "");
  add("mips", 1, "million instructions a second");
  add("requests_per_second", 1e-6, "million requests a second");
  add_text("peak_rss", " of memory");
  return parts.empty() ? "" : paragraph("host", fmt::format("{}", fmt::join(parts, ", ")));
}

std::string milliseconds(double seconds) { return fmt::format("{:.4g}", seconds * 1e3); }

/// Start-up and latency of the frames.
std::string frame_lines(std::span<const StatRow> stats) {
  std::vector<std::string> parts;
  const auto add = [&](const std::string& name, const std::string& what) {
    const auto mean = real(stats, name + ".mean"), min = real(stats, name + ".min"), max = real(stats, name + ".max");
    if (mean && min && max)
      parts.push_back(fmt::format("{} {}\x1fms ({} to {})", what, milliseconds(*mean), milliseconds(*min),
                                  milliseconds(*max)));
  };
  add("frame.remap_time", "a remap");
  add("frame.latency", "capture to display");
  if (const auto t = real(stats, names::kStartupLutTime))
    parts.push_back("look-up table built in " + milliseconds(*t) + "\x1fms");
  return parts.empty() ? "" : paragraph("times", fmt::format("{}", fmt::join(parts, ", ")));
}

/// What became of the frames of each of several cameras.
std::string camera_lines(std::span<const StatRow> stats) {
  std::vector<std::string> parts;
  for (unsigned n = 0;; ++n) {
    const std::string prefix = fmt::format("camera.{}.frame.", n);
    const auto rate = real(stats, prefix + "rate");
    if (!rate) break;
    std::string part = *rate > 0 ? fmt::format("camera {} {:.4g} frames a second", n, *rate)
                                 : fmt::format("camera {} no frame", n);
    for (const char* fate : {"dropped", "superseded"})
      if (const std::uint64_t frames = count(stats, prefix + fate)) part += fmt::format(", {} {}", frames, fate);
    parts.push_back(std::move(part));
  }
  return parts.empty() ? "" : paragraph("cameras", fmt::format("{}", fmt::join(parts, "; ")));
}

/// With two models of the remap engine: how far they agree.
std::string engine_line(std::span<const StatRow> stats) {
  if (!find(stats, "engine.pair.requests")) return "";
  const std::uint64_t all = count(stats, "engine.pair.requests"), same = count(stats, "engine.pair.within_0");
  std::string out = fmt::format("{} requests of RTL and model are equal in data", all);
  if (all && same == all) out += " and in time";
  if (same < all)  // rounded down: 100 % would be all of them
    out += fmt::format(", {:.1f}\x1f% of them at the same clock, the others at most {}\x1f" "clock{} apart",
                       std::floor(1000 * static_cast<double>(same) / static_cast<double>(all)) / 10,
                       count(stats, "engine.pair.most"), count(stats, "engine.pair.most") == 1 ? "" : "s");
  if (const std::uint64_t skipped = count(stats, "engine.pair.skipped"))
    out += fmt::format("; {} behind an error or an abort were not compared", skipped);
  return paragraph("engine", out);
}

}  // namespace

std::vector<std::uint64_t> apportioned(std::uint64_t total, std::span<const std::uint64_t> shares) {
  using Wide = unsigned __int128;
  Wide sum = 0;
  for (const std::uint64_t s : shares) sum += s;
  std::vector<std::uint64_t> out(shares.size());
  if (sum == 0) return out;
  std::vector<std::size_t> order(shares.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::uint64_t left = total;
  for (std::size_t i = 0; i < shares.size(); ++i)
    left -= out[i] = static_cast<std::uint64_t>(Wide{total} * shares[i] / sum);
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return Wide{total} * shares[a] % sum > Wide{total} * shares[b] % sum;
  });
  for (std::size_t i = 0; left > 0; ++i, --left) ++out[order[i]];
  return out;
}

std::string frame_budget(std::span<const StatRow> stats) {
  const auto window = real(stats, names::kWindow);
  const std::uint64_t displayed = count(stats, names::kDisplayed), cycles = count(stats, names::kCpuCycles);
  const std::uint64_t remap = count(stats, names::kCpuRemapCycles), spare = count(stats, names::kCpuSpare);
  if (!window || displayed == 0 || remap == 0 || remap > cycles || spare > cycles - remap) return "";
  const auto period =
      static_cast<std::uint64_t>(std::llround(*window / static_cast<double>(displayed) * 1e4));
  const std::vector<std::uint64_t> parts =
      apportioned(period, std::vector<std::uint64_t>{remap, cycles - remap - spare, spare});
  std::string divided;
  for (std::size_t k = 0; k < parts.size(); ++k)
    if (parts[k])
      divided += fmt::format("{}{} {}.{}", divided.empty() ? "" : ", ", std::array{"remap", "other work", "idle"}[k],
                             parts[k] / 10, parts[k] % 10);
  std::string out =
      paragraph("budget", fmt::format("{}.{} ms a displayed frame: {}", period / 10, period % 10, divided));
  const std::string inside = listed(apportioned_parts(parts[0], clocks_of_remaps(stats)));
  if (inside.empty()) return out;
  return out + paragraph("", fmt::format("remap {}.{} ms: {}", parts[0] / 10, parts[0] % 10, inside));
}

std::string run_words(std::span<const StatRow> stats, std::span<const StatRow> host,
                      std::span<const SlowestRow> slowest) {
  return verdict(stats) + frame_budget(stats) + frame_lines(stats) + camera_lines(stats) + quality_line(stats) +
         core_line(stats) + sdram_line(stats, real(stats, names::kWindow)) + wait_line(stats) + slowest_lines(slowest) +
         engine_line(stats) + host_line(host);
}

std::string replay_words(std::span<const StatRow> stats, std::span<const StatRow> host,
                         std::span<const SlowestRow> slowest) {
  std::string out;
  if (const auto time = real(stats, "replay.time")) {
    out = fmt::format("replayed {} requests in {} of simulated time", count(stats, "replay.requests"),
                      human_text(*time, "s"));
    if (const auto rate = real(stats, "replay.bandwidth"))
      out += fmt::format(", {:.1f} MB/s", *rate * 1e-6);
    out = wrapped(out, 0) + "\n";
  }
  return out + frame_lines(stats) + sdram_line(stats, real(stats, "replay.time")) + wait_line(stats) +
         slowest_lines(slowest) + host_line(host);
}

std::string exec_words(std::span<const StatRow> stats, Frequency core_clock) {
  const std::uint64_t cycles = count(stats, names::kCpuCycles), instructions = count(stats, names::kCpuInstructions);
  std::string out = fmt::format("{} instructions in {} clocks", instructions, cycles);
  if (instructions)
    out += fmt::format(", {:.2f} an instruction", static_cast<double>(cycles) / static_cast<double>(instructions));
  if (!core_clock.stopped())
    out += fmt::format(": {:.6f}\x1fs at {:.5g}\x1fMHz", static_cast<double>(cycles) / core_clock.hertz(),
                       core_clock.hertz() * 1e-6);
  return paragraph("core", out) + core_line(stats) + engine_line(stats);
}

}  // namespace fovea::app
