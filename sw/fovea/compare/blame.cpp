#include "sw/fovea/compare/blame.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <tuple>

#include "sw/fovea/compare/matching.h"
#include "sw/fovea/results/names.h"

namespace fovea::regression {
namespace {

/// One run's clocks of a function.
struct Side {
  std::map<CauseKey, double> causes;
  std::map<unsigned, double> lines;
  std::map<unsigned, std::map<std::string, double>> line_causes;
  double clocks = 0, instructions = 0, polls = 0;
  bool present = false;
};

struct Pair {
  Side before, after;
};

void add_side(std::map<FunctionKey, Pair>& functions, Side Pair::*side, const Part& part, bool by_function,
              double& busy, double& idle) {
  for (const AttributionRow* const row : part.rows) {
    const AttributionRow& r = *row;
    const double amount = static_cast<double>(r.clocks) * part.scale;
    if (r.idle()) {
      idle += amount;
      continue;
    }
    busy += amount;
    Side& s = functions[by_function ? r.key() : FunctionKey()].*side;
    s.present = true;
    s.causes[{r.cause, r.region, r.culprit}] += amount;
    s.lines[r.line] += amount;
    s.line_causes[r.line][r.cause] += amount;
    s.clocks += amount;
    if (r.polls) s.polls += amount;
    s.instructions += static_cast<double>(r.instructions) * part.count;
  }
}

template <class T>
void largest_first(std::vector<T>& changes) {
  std::stable_sort(changes.begin(), changes.end(), [](const T& a, const T& b) {
    return std::abs(a.share.change()) > std::abs(b.share.change());
  });
}

/// Causes that depend on where code lies.
bool of_fetches(const std::string& cause) { return cause == "icache"; }

/// Aligns the lines of a function in two versions of its source, so that lines which were merely
/// moved by an insertion above them are compared with themselves: the alignment in ascending order
/// whose differences are least.
std::vector<LineChange> aligned(const std::map<unsigned, double>& before,
                                const std::map<unsigned, double>& after) {
  const std::vector<std::pair<unsigned, double>> a(before.begin(), before.end()),
      b(after.begin(), after.end());
  // Beyond this a function is compared by line numbers, which takes no quadratic time.
  constexpr std::size_t kMaxLines = 2000;
  std::vector<LineChange> out;
  const auto add = [&](const std::pair<unsigned, double>* x, const std::pair<unsigned, double>* y) {
    LineChange change;
    if (x) change.before = x->first;
    if (y) change.after = y->first;
    change.share = {x ? x->second : 0, y ? y->second : 0};
    if (change.share.change() != 0) out.push_back(change);
  };
  bool same_lines = a.size() == b.size() && std::equal(a.begin(), a.end(), b.begin(),
                                                       [](const auto& x, const auto& y) {
                                                         return x.first == y.first;
                                                       });
  if (same_lines) {
    for (std::size_t i = 0; i < a.size(); ++i) add(&a[i], &b[i]);
    return out;
  }
  if (a.size() > kMaxLines || b.size() > kMaxLines) {
    std::set<unsigned> numbers;
    for (const auto& x : a) numbers.insert(x.first);
    for (const auto& y : b) numbers.insert(y.first);
    for (const unsigned n : numbers) {
      const auto x = before.find(n), y = after.find(n);
      const std::pair<unsigned, double> xv{n, x == before.end() ? 0 : x->second},
          yv{n, y == after.end() ? 0 : y->second};
      add(x == before.end() ? nullptr : &xv, y == after.end() ? nullptr : &yv);
    }
    return out;
  }
  const std::size_t width = b.size() + 1;
  std::vector<double> cost((a.size() + 1) * width);
  const auto at = [&](std::size_t i, std::size_t j) -> double& { return cost[i * width + j]; };
  for (std::size_t i = a.size() + 1; i-- > 0;)
    for (std::size_t j = width; j-- > 0;) {
      if (i == a.size() && j == b.size()) continue;
      double least = INFINITY;
      if (i < a.size() && j < b.size())
        least = at(i + 1, j + 1) + std::abs(a[i].second - b[j].second);
      if (i < a.size()) least = std::min(least, at(i + 1, j) + a[i].second);
      if (j < b.size()) least = std::min(least, at(i, j + 1) + b[j].second);
      at(i, j) = least;
    }
  for (std::size_t i = 0, j = 0; i < a.size() || j < b.size();) {
    if (i < a.size() && j < b.size() &&
        at(i, j) == at(i + 1, j + 1) + std::abs(a[i].second - b[j].second)) {
      add(&a[i++], &b[j++]);
    } else if (i < a.size() && at(i, j) == at(i + 1, j) + a[i].second) {
      add(&a[i++], nullptr);
    } else {
      add(nullptr, &b[j++]);
    }
  }
  return out;
}

FunctionChange change_of(const FunctionKey& key, const Pair& p, bool by_function) {
  FunctionChange f;
  f.function = key.first;
  f.file = key.second;
  f.share = {p.before.clocks, p.after.clocks};
  if (by_function) {
    f.instructions_before = p.before.instructions;
    f.instructions_after = p.after.instructions;
  }
  std::map<CauseKey, Share> causes;
  for (const auto& [cause, clocks] : p.before.causes) causes[cause].before = clocks;
  for (const auto& [cause, clocks] : p.after.causes) causes[cause].after = clocks;
  for (const auto& [cause, share] : causes)
    if (share.change() != 0)
      f.causes.push_back({std::get<0>(cause), std::get<1>(cause), std::get<2>(cause), share});
  if (by_function) f.lines = aligned(p.before.lines, p.after.lines);
  for (LineChange& line : f.lines) {
    if (line.after)
      for (const auto& [cause, clocks] : p.after.line_causes.at(*line.after)) line.causes[cause] += clocks;
    if (line.before)
      for (const auto& [cause, clocks] : p.before.line_causes.at(*line.before)) line.causes[cause] -= clocks;
  }
  largest_first(f.causes);
  largest_first(f.lines);
  if (!p.before.present) f.kind = ChangeKind::kAdded;
  else if (!p.after.present) f.kind = ChangeKind::kRemoved;
  else if (f.instructions_before != f.instructions_after) f.kind = ChangeKind::kExecutes;
  if (const double polls = p.after.polls - p.before.polls;
      polls != 0 && (polls > 0) == (f.share.change() > 0) && std::abs(polls) * 2 >= std::abs(f.share.change()))
    f.kind = ChangeKind::kPolls;
  return f;
}

using Places = std::map<FunctionKey, std::set<CodePlace>>;

/// A function's code in two programs.
struct Moved {
  bool same_code = false;   ///< whatever its addresses are
  bool elsewhere = false;   ///< at other addresses
};

Moved moved(const Places& before, const Places& after, const FunctionKey& key) {
  const auto a = before.find(key), b = after.find(key);
  if (a == before.end() || b == after.end()) return {};
  const auto codes = [](const std::set<CodePlace>& places) {
    std::multiset<std::pair<std::string, std::string>> out;
    for (const CodePlace& p : places) out.insert({p.size, p.code});
    return out;
  };
  Moved out;
  out.same_code = codes(a->second) == codes(b->second);
  out.elsewhere = out.same_code && a->second != b->second;
  return out;
}

/// Tells layout from waiting, by addresses. If all code and data is the same and only lies elsewhere,
/// nothing else is left that could have changed the clocks, also of what stayed in its place: it may
/// meet what was moved in a cache. Otherwise only fetches of moved functions are put down to addresses,
/// since data may come later because of what other code does to caches and memory.
void find_layout(Difference& d, const Places& before, const Places& after) {
  d.places_known = !before.empty() && !after.empty();
  if (!d.by_function || !d.program_differs || !d.places_known) return;
  bool all = !d.settings_differ, any = false;
  for (const auto* places : {&before, &after})
    for (const auto& [key, unused] : *places) {
      const Moved m = moved(before, after, key);
      all = all && m.same_code;
      any = any || m.elsewhere;
    }
  all = all && any;
  for (auto& f : d.functions) {
    const Moved m = moved(before, after, {f.function, f.file});
    if (!all && (!m.elsewhere || f.kind != ChangeKind::kWaits)) continue;
    for (const auto& c : f.causes)
      if (all || of_fetches(c.cause)) f.layout += c.share.change();
    if (m.elsewhere && f.layout != 0 && std::abs(f.layout) * 2 >= std::abs(f.share.change()))
      f.kind = ChangeKind::kLayout;
  }
}

/// True if the cores had different clocks. The window's edges may lie within a clock, so that its
/// length tells a clock's only to two clocks in all; clocks that differ by less than 0.1 % count as
/// the same.
bool other_clock(const Attribution& a, const Attribution& b) {
  if (a.seconds <= 0 || b.seconds <= 0) return false;
  constexpr double kSame = 1e-3, kEdges = 2;
  return std::abs(a.seconds - b.seconds) >
         a.seconds * (kSame + kEdges / a.clocks + kEdges / b.clocks);
}

/// Another number of remaps in the window: what is compared is one of them.
bool other_remaps(const Attribution& a, const Attribution& b) {
  constexpr double kSame = 0.02;
  return a.remaps > 0 && b.remaps > 0 && std::abs(a.remaps - b.remaps) > kSame * std::max(a.remaps, b.remaps);
}

bool in_part(const std::string& phase, RunPart part) {
  switch (part) {
    case RunPart::kRemap: return phase == kRemapPhase;
    case RunPart::kLut: return phase == kLutPhase;
    case RunPart::kWindow:
    case RunPart::kStartup: break;
  }
  return true;
}

bool before_window(RunPart part) { return part == RunPart::kLut || part == RunPart::kStartup; }

/// The rows and paths of a part.
Part part_of(const Attribution& a, RunPart part) {
  Part out;
  for (const AttributionRow& r : before_window(part) ? a.startup : a.rows)
    if (in_part(r.phase, part)) out.rows.push_back(&r);
  std::set<std::string> phases;
  for (const AttributionRow* const r : out.rows) phases.insert(r->phase);
  for (const CallPath& p : a.paths)
    if (phases.contains(p.phase)) out.paths.push_back(&p);
  return out;
}

double clocks_of(const Part& part) {
  double sum = 0;
  for (const AttributionRow* const r : part.rows) sum += static_cast<double>(r->clocks);
  return sum;
}

}  // namespace

double Difference::unexplained_share() const {
  const double whole = std::max(std::abs(total.change()), std::abs(busy.change()));
  if (unexplained == 0) return 0;
  return whole == 0 ? 1 : std::abs(unexplained) / whole;
}

bool Difference::none() const {
  return total.change() == 0 && idle.change() == 0 && functions.empty();
}

RunPart part_of_figure(const std::string& name) {
  if (name == names::kStartupLutTime) return RunPart::kLut;
  if (name.starts_with("startup.")) return RunPart::kStartup;
  if (name.starts_with("frame.remap_time.") || name.starts_with("cpu.remap.")) return RunPart::kRemap;
  return RunPart::kWindow;
}

Difference difference_of(const Attribution& was, const Attribution& after, const Circumstances& circumstances,
                         RunPart part) {
  const Attribution before = with_names_of(was, after);
  Difference d;
  d.part = part;
  Part a = part_of(before, part), b = part_of(after, part);
  if (part == RunPart::kRemap && (a.rows.empty() || b.rows.empty())) {
    d.part = RunPart::kWindow;
    a = part_of(before, d.part);
    b = part_of(after, d.part);
  }
  d.known = !a.rows.empty() && !b.rows.empty();
  d.by_function = before.by_function && after.by_function;
  d.program_differs = circumstances.program_differs;
  d.settings_differ = circumstances.settings_differ;
  d.notes = circumstances.notes;
  d.in_seconds = other_clock(before, after);
  d.per_remap = !before_window(d.part) && other_remaps(before, after);
  d.remaps = after.remaps;
  d.seconds = after.seconds;
  if (d.per_remap) a.count = 1 / before.remaps, b.count = 1 / after.remaps;
  a.scale = a.count * (d.in_seconds ? before.seconds : 1);
  b.scale = b.count * (d.in_seconds ? after.seconds : 1);
  std::map<FunctionKey, Pair> functions;
  add_side(functions, &Pair::before, a, d.by_function, d.busy.before, d.idle.before);
  add_side(functions, &Pair::after, b, d.by_function, d.busy.after, d.idle.after);
  const bool window = d.part == RunPart::kWindow;
  d.total = {(window ? before.clocks : clocks_of(a)) * a.scale, (window ? after.clocks : clocks_of(b)) * b.scale};
  d.unexplained = d.total.change() - (d.busy.change() + d.idle.change());
  // Amounts that are not whole numbers are rounded.
  if ((d.in_seconds || d.per_remap) && std::abs(d.unexplained) < 1e-9 * d.total.after) d.unexplained = 0;
  for (const auto& [key, pair] : functions) {
    FunctionChange f = change_of(key, pair, d.by_function);
    if (!f.causes.empty() || f.instructions_before != f.instructions_after)
      d.functions.push_back(std::move(f));
  }
  find_layout(d, before.places, after.places);
  largest_first(d.functions);
  if (d.by_function && d.program_differs && !d.settings_differ) d.origins = origins_of(before, a, after, b);
  d.moved_objects = moved_objects_text(before, after);
  return d;
}

}  // namespace fovea::regression
