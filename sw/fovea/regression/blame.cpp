#include "sw/fovea/regression/blame.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <tuple>

#include "sw/fovea/outputs.h"

namespace fovea::regression {
namespace {

using CauseKey = std::tuple<std::string, std::string, std::string>;

/// One run's clocks of a function.
struct Side {
  std::map<CauseKey, double> causes;
  std::map<unsigned, double> lines;
  std::map<unsigned, std::map<std::string, double>> line_causes;
  double clocks = 0, instructions = 0;
  bool present = false;
};

struct Pair {
  Side before, after;
};

void add_side(std::map<FunctionKey, Pair>& functions, Side Pair::*side,
              const Attribution& attribution, bool by_function, double scale, double& busy,
              double& idle) {
  for (const auto& r : attribution.rows) {
    const double amount = static_cast<double>(r.clocks) * scale;
    if (r.idle()) {
      idle += amount;
      continue;
    }
    busy += amount;
    Side& s = functions[by_function ? FunctionKey(r.function, r.file) : FunctionKey()].*side;
    s.present = true;
    s.causes[{r.cause, r.region, r.culprit}] += amount;
    s.lines[r.line] += amount;
    s.line_causes[r.line][r.cause] += amount;
    s.clocks += amount;
    s.instructions += static_cast<double>(r.instructions);
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

std::string grouped(double value) { return app::grouped(static_cast<std::uint64_t>(std::llround(std::abs(value)))); }

}  // namespace

std::string kind_text(ChangeKind kind, bool more) {
  switch (kind) {
    case ChangeKind::kAdded: return "is new";
    case ChangeKind::kRemoved: return "is gone";
    case ChangeKind::kExecutes: return more ? "executes more" : "executes less";
    case ChangeKind::kLayout: return "was moved (layout)";
    case ChangeKind::kWaits: break;
  }
  return "same instructions";
}

double Difference::unexplained_share() const {
  const double whole = std::max(std::abs(total.change()), std::abs(busy.change()));
  if (unexplained == 0) return 0;
  return whole == 0 ? 1 : std::abs(unexplained) / whole;
}

bool Difference::none() const {
  return total.change() == 0 && idle.change() == 0 && functions.empty();
}

Difference difference_of(const Attribution& before, const Attribution& after,
                         const Circumstances& circumstances) {
  Difference d;
  d.by_function = before.by_function && after.by_function;
  d.program_differs = circumstances.program_differs;
  d.settings_differ = circumstances.settings_differ;
  d.in_seconds = other_clock(before, after);
  const double scale_before = d.in_seconds ? before.seconds : 1;
  const double scale_after = d.in_seconds ? after.seconds : 1;
  std::map<FunctionKey, Pair> functions;
  add_side(functions, &Pair::before, before, d.by_function, scale_before, d.busy.before, d.idle.before);
  add_side(functions, &Pair::after, after, d.by_function, scale_after, d.busy.after, d.idle.after);
  d.total = {before.clocks * scale_before, after.clocks * scale_after};
  d.unexplained = d.total.change() - (d.busy.change() + d.idle.change());
  // In seconds the sums are rounded.
  if (d.in_seconds && std::abs(d.unexplained) < 1e-9 * d.total.after) d.unexplained = 0;
  for (const auto& [key, pair] : functions) {
    FunctionChange f = change_of(key, pair, d.by_function);
    if (!f.causes.empty() || f.instructions_before != f.instructions_after)
      d.functions.push_back(std::move(f));
  }
  find_layout(d, before.places, after.places);
  largest_first(d.functions);
  return d;
}

Blame blame_of(const Difference& difference, bool slower) {
  const auto worst = [slower](const auto& changes) {
    const auto amount = [slower](const auto& c) { return c.share.change() * (slower ? 1 : -1); };
    const auto found = std::max_element(changes.begin(), changes.end(), [&](const auto& a, const auto& b) {
      return amount(a) < amount(b);
    });
    return found != changes.end() && amount(*found) > 0 ? &*found : nullptr;
  };
  Blame blame;
  blame.function = worst(difference.functions);
  if (!blame.function) return blame;
  // With another program and the same settings, whoever executes something else is the origin; the
  // others only wait, in small amounts up and down, for what it does to caches and memory.
  if (difference.program_differs && !difference.settings_differ) {
    constexpr double kOrigin = 0.25;  // of the whole change; less is a by-product itself
    for (const auto& f : difference.functions) {
      const double amount = f.share.change() * (slower ? 1 : -1);
      if ((f.kind == ChangeKind::kExecutes || f.kind == ChangeKind::kAdded) &&
          amount >= kOrigin * std::abs(difference.busy.change()) && amount > 0) {
        blame.function = &f;  // the largest change comes first
        break;
      }
    }
  }
  std::map<std::string, double> by_cause;
  for (const auto& c : blame.function->causes) by_cause[c.cause] += c.share.change();
  std::string most;
  for (const auto& [cause, change] : by_cause)
    if (const double amount = change * (slower ? 1 : -1); amount > std::abs(blame.by_cause)) {
      blame.by_cause = change;
      most = cause;
    }
  for (const auto& c : blame.function->causes)  // the largest change comes first
    if (c.cause == most && (c.share.change() > 0) == slower && !blame.cause) blame.cause = &c;
  blame.line = worst(blame.function->lines);
  // Rather the line at which that cause grew than one at which others did.
  double grew = 0;
  for (const auto& line : blame.function->lines)
    if (const auto found = line.causes.find(most); found != line.causes.end())
      if (const double amount = found->second * (slower ? 1 : -1); amount > grew) {
        grew = amount;
        blame.line = &line;
      }
  return blame;
}

std::string amount_text(const Difference& difference, double amount) {
  const char* const sign = amount < 0 ? "-" : "+";
  if (difference.in_seconds) return sign + app::human_text(std::abs(amount), "s");
  return sign + grouped(amount) + " clocks";
}

std::string cause_text(const CauseChange& cause, const std::string& extent) {
  std::string where;
  if (!cause.region.empty() && cause.region != "none") where += ", region " + cause.region;
  if (!cause.culprit.empty() && cause.culprit != "core") where += ", culprit " + cause.culprit;
  return where.empty() ? cause.cause : cause.cause + ", " + extent + where.substr(2);
}

std::string place_text(const FunctionChange& function, const LineChange* line) {
  if (function.function.empty()) return "the program";
  std::string place = function.file;
  if (line && line->after.value_or(line->before.value_or(0)))
    place += fmt::format(":{}", line->after.value_or(line->before.value_or(0)));
  return place.empty() ? function.function : fmt::format("{} ({})", function.function, place);
}

/// For a difference without more clocks: whoever executes more all the same.
static std::string more_instructions(const Difference& difference) {
  const auto more = [](const FunctionChange& f) { return f.instructions_after - f.instructions_before; };
  const auto most = std::max_element(
      difference.functions.begin(), difference.functions.end(),
      [&](const auto& a, const auto& b) { return more(a) < more(b); });
  if (most == difference.functions.end() || more(*most) <= 0) return "";
  return fmt::format("{} executes {} instructions more, which take no more clocks in all",
                     place_text(*most, nullptr), grouped(more(*most)));
}

std::string blame_text(const Difference& difference, const Blame& blame) {
  if (!blame.function) return more_instructions(difference);
  const FunctionChange& f = *blame.function;
  const double whole = difference.busy.change();
  std::string out = place_text(f, blame.line);
  if (difference.by_function)
    out += " " + (f.kind == ChangeKind::kWaits
                      ? std::string("waits with the same instructions")
                      : kind_text(f.kind, f.instructions_after > f.instructions_before));
  out += ": " + amount_text(difference, f.share.change());
  if (whole != 0 && (whole > 0) == (f.share.change() > 0))
    out += fmt::format(" ({:.0f} % of the change)", 100 * f.share.change() / whole);
  if (blame.cause) {
    const bool alone = blame.by_cause == blame.cause->share.change();
    out += fmt::format(", of which {} by {}", amount_text(difference, blame.by_cause),
                       cause_text(*blame.cause, alone ? "" : "mostly "));
  }
  return out;
}

}  // namespace fovea::regression
