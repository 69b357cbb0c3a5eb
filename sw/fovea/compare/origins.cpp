#include "sw/fovea/compare/origins.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "sw/fovea/compare/matching.h"

namespace fovea::regression {
namespace {

constexpr double kAsMany = 0.01;    // of the instructions: no change
constexpr double kAlike = 0.1;      // of a factor: the same
constexpr double kMostLines = 0.9;  // of the instructions: nearly all

struct UnitSide {
  double clocks = 0, instructions = 0;
  std::map<CauseKey, double> causes;
  std::map<unsigned, double> lines;  // instructions
};
struct UnitPair {
  UnitSide before, after;
  double change() const { return after.clocks - before.clocks; }
  double instructions() const { return after.instructions - before.instructions; }
  double factor() const { return before.instructions > 0 ? after.instructions / before.instructions : INFINITY; }
  bool as_many() const {
    return std::abs(instructions()) <= kAsMany * std::max(before.instructions, after.instructions);
  }
};
bool alike_factors(double a, double b) { return a == b || std::abs(a - b) <= kAlike * std::min(a, b); }

/// A function within those that hold it inlined, outermost first; the last one is the function.
using Chain = std::vector<FunctionKey>;
struct Unit {
  Chain chain;
  bool polls = false;
  auto operator<=>(const Unit&) const = default;
};

std::int64_t distance(unsigned to, unsigned from) { return std::int64_t{to} - std::int64_t{from}; }

/// Instructions that a line of the second run had in the first one; `shift`: of the lines between the two sources.
double was_at(const UnitPair& p, unsigned line, std::int64_t shift) {
  const auto was = p.before.lines.find(static_cast<unsigned>(std::int64_t{line} - shift));
  return was == p.before.lines.end() ? 0 : was->second;
}

/// How far an insertion above them has moved the lines: by what most of them are found again. Either version may begin
/// with a few lines that the other one lacks, such as those of its entry.
std::int64_t shift_of(const UnitPair& p) {
  constexpr std::ptrdiff_t kTried = 4;
  std::int64_t best = 0;
  std::ptrdiff_t most = -1;
  const auto first = [&](const std::map<unsigned, double>& lines) {
    return std::next(lines.begin(), std::min(kTried, static_cast<std::ptrdiff_t>(lines.size())));
  };
  for (auto a = p.after.lines.begin(); a != first(p.after.lines); ++a)
    for (auto b = p.before.lines.begin(); b != first(p.before.lines); ++b) {
      const std::int64_t shift = distance(a->first, b->first);
      const auto found = std::count_if(p.after.lines.begin(), p.after.lines.end(),
                                       [&](const auto& line) { return was_at(p, line.first, shift) > 0; });
      if (found > most) most = found, best = shift;
    }
  return best;
}

/// All lines were executed more, or less, by one factor.
bool by_one_factor(const UnitPair& p) {
  if (p.before.lines.empty() || p.after.lines.empty()) return false;
  const std::int64_t shift = shift_of(p);
  double like = 0;
  for (const auto& [line, n] : p.after.lines)
    if (const double was = was_at(p, line, shift); was > 0 && alike_factors(n / was, p.factor())) like += n;
  return like >= kMostLines * p.after.instructions;
}

/// The same of a function that one run alone has inlined, where a compiler makes other instructions of the same lines,
/// and some for the entry and the return.
bool by_about_one_factor(const UnitPair& p) {
  constexpr double kEntry = 0.3;  // of the instructions, at most
  constexpr double kOtherwise = 0.35;
  // A reference does not keep the lines of what hardly counts: what is left is whether it ran twice as often, or half.
  if (p.before.lines.empty() || p.after.lines.empty())
    return p.before.instructions > 0 && p.after.instructions > 0 && std::abs(std::log2(p.factor())) >= std::log2(1.5);
  const std::int64_t shift = shift_of(p);
  std::vector<double> factors;
  double alone = 0;
  for (const auto& [line, n] : p.after.lines) {
    const double was = was_at(p, line, shift);
    if (was > 0) factors.push_back(n / was);
    else alone += n;
  }
  if (factors.empty() || alone > kEntry * p.after.instructions) return false;
  const auto middle = factors.begin() + static_cast<std::ptrdiff_t>(factors.size() / 2);
  std::nth_element(factors.begin(), middle, factors.end());
  const double usual = *middle;
  return std::all_of(factors.begin(), factors.end(),
                     [&](double f) { return std::abs(f - usual) <= kOtherwise * std::min(f, usual); });
}

class OriginSearch {
 public:
  OriginSearch(const Attribution& before, const Part& a, const Attribution& after, const Part& b)
      : was_(before), is_(after) {
    add(a, &UnitPair::before);
    add(b, &UnitPair::after);
    if (a.paths.empty() || b.paths.empty()) paths_.clear();  // one run alone says nothing about a change
    for (const auto& [unit, pair] : units_) {
      if (unit.chain.size() > 1) sum(copies_[unit.chain.back()][holder(unit.chain)], pair);
      sum(bodies_[unit.chain.front()], pair);
      UnitPair& whole = whole_[unit.chain];
      sum(whole, pair);
      for (const auto& [line, n] : pair.before.lines) whole.before.lines[line] += n;
      for (const auto& [line, n] : pair.after.lines) whole.after.lines[line] += n;
      add_home(unit.chain, pair);
      if (pair.before.instructions > 0) before_.insert(unit.chain.back());
      if (pair.after.instructions > 0) after_.insert(unit.chain.back());
    }
  }

  std::vector<ClockOrigin> result() {
    for (const auto& [unit, pair] : units_)
      if (pair.change() != 0) assign(unit, pair);
    std::vector<ClockOrigin> out;
    for (auto& [key, origin] : origins_) out.push_back(std::move(origin));
    join_moved(out);
    std::stable_sort(out.begin(), out.end(),
                     [](const auto& x, const auto& y) { return std::abs(x.change) > std::abs(y.change); });
    return out;
  }

 private:
  static Chain holder(const Chain& chain) { return {chain.begin(), chain.end() - 1}; }
  static void sum(UnitPair& to, const UnitPair& p) {
    to.before.clocks += p.before.clocks;
    to.after.clocks += p.after.clocks;
    to.before.instructions += p.before.instructions;
    to.after.instructions += p.after.instructions;
  }

  void add(const Part& part, UnitSide UnitPair::*side) {
    for (const AttributionRow* const r : part.rows) {
      if (r->idle()) continue;
      Unit unit{r->holders, r->polls};
      unit.chain.push_back(r->key());
      UnitSide& s = units_[unit].*side;
      const double clocks = static_cast<double>(r->clocks) * part.scale;
      const double instructions = static_cast<double>(r->instructions) * part.count;
      s.clocks += clocks;
      s.causes[{r->cause, r->region, r->culprit}] += clocks;
      s.instructions += instructions;
      if (instructions > 0 && r->line) s.lines[r->line] += instructions;
    }
    for (const CallPath* const p : part.paths) {
      if (p->functions.empty()) continue;
      auto& [was, is] = paths_[p->functions];
      (side == &UnitPair::before ? was : is) += static_cast<double>(p->clocks) * part.scale;
    }
  }

  void add_home(const Chain& chain, const UnitPair& pair) {
    Home& home = homes_[chain.back()];
    const bool own = chain.size() == 1;
    if (pair.before.instructions > 0) (own ? home.own_before : home.inlined_before) = true;
    if (pair.after.instructions > 0) (own ? home.own_after : home.inlined_after) = true;
    sum(home.all, pair);
    for (const auto& [line, n] : pair.before.lines) home.all.before.lines[line] += n;
    for (const auto& [line, n] : pair.after.lines) home.all.after.lines[line] += n;
  }

  bool has_other_code(const FunctionKey& f) const {
    const auto [known, added] = other_code_.try_emplace(f, false);
    if (added) known->second = code_change(was_, is_, f).changed && !placed_otherwise(f);
    return known->second;
  }
  /// Inlined in one run alone: its code is that of its holder there. Its lines tell whether it was changed itself.
  bool placed_otherwise(const FunctionKey& f) const {
    const auto found = homes_.find(f);
    if (found == homes_.end()) return false;
    const Home& h = found->second;
    const bool outlined = h.inlined_before && !h.own_before && h.own_after && !h.inlined_after;
    const bool inlined = h.own_before && !h.inlined_before && h.inlined_after && !h.own_after;
    return (outlined || inlined) && by_about_one_factor(h.all);
  }

  /// Of the functions of a chain, the one whose change it is.
  std::size_t within(const Chain& chain) const {
    const UnitPair& pair = whole_.at(chain);
    const std::size_t last = chain.size() - 1;
    if (last == 0 || pair.as_many()) return last;
    const bool existed = before_.contains(chain[last]) && after_.contains(chain[last]);
    if (existed && (changed_everywhere(chain[last]) ||
                    (pair.before.instructions > 0 && pair.after.instructions > 0 && !by_one_factor(pair))))
      return last;
    for (std::size_t k = last; k-- > 1;) {
      const auto own = whole_.find({chain.begin(), chain.begin() + static_cast<std::ptrdiff_t>(k) + 1});
      if (own == whole_.end() || !before_.contains(chain[k])) continue;
      if (!alike_factors(own->second.factor(), pair.factor())) return k;
    }
    return 0;
  }
  /// The inlined function of a caller, or the caller, in which most instructions changed: that has the calls.
  FunctionKey changed_in(const FunctionKey& caller) const {
    FunctionKey out = caller;
    double most = 0;
    for (auto unit = whole_.lower_bound(Chain{caller}); unit != whole_.end() && unit->first.front() == caller; ++unit)
      if (const double change = std::abs(unit->second.instructions()); change > most) {
        most = change;
        out = unit->first[within(unit->first)];
      }
    return out;
  }
  /// Inlined in several places, and more or fewer instructions in all of them that matter, by about one factor.
  bool changed_everywhere(const FunctionKey& f) const {
    const auto found = copies_.find(f);
    UnitPair all;
    for (const auto& [where, copy] : found->second) sum(all, copy);
    unsigned places = 0;
    constexpr double kMatters = 0.02;
    for (const auto& [where, copy] : found->second) {
      if (copy.before.instructions < kMatters * all.before.instructions) continue;
      ++places;
      if (!alike_factors(copy.factor(), all.factor())) return false;
    }
    return places > 1;
  }

  void assign(const Unit& unit, const UnitPair& pair) {
    const FunctionKey& outer = unit.chain.front();
    const bool known = code_change(was_, is_, outer).known;
    if (has_other_code(outer)) {
      const std::size_t k = within(unit.chain);
      credit(unit.chain[k], {unit.chain.begin() + static_cast<std::ptrdiff_t>(k) + 1, unit.chain.end()}, unit, pair, 1);
      return;
    }
    const UnitPair& body = bodies_.at(outer);
    if (body.as_many()) return;  // the same code waits
    if (to_callers(unit, pair) || (known && pair.as_many())) return;
    credit(unit.chain.back(), {}, unit, pair, 1);
  }

  /// Divides a change among the callers by their changes. False if none has other code.
  bool to_callers(const Unit& unit, const UnitPair& pair) {
    const bool grew = bodies_.at(unit.chain.front()).instructions() > 0;
    double whole = 0;
    std::vector<std::tuple<const Chain*, std::size_t, double>> found;  // path, the caller in it, its change
    for (const auto& [path, clocks] : paths_) {
      const double change = clocks.second - clocks.first;
      if (path.back() != unit.chain.front() || change == 0 || (change > 0) != grew) continue;
      for (std::size_t k = path.size() - 1; k-- > 0;)
        if (has_other_code(path[k])) {
          whole += change;
          found.emplace_back(&path, k, change);
          break;
        }
    }
    for (const auto& [path, k, change] : found) {
      Chain way(path->begin() + static_cast<std::ptrdiff_t>(k) + 1, path->end());
      way.insert(way.end(), unit.chain.begin() + 1, unit.chain.end());
      credit(changed_in((*path)[k]), way, unit, pair, change / whole);
    }
    return !found.empty();
  }

  void credit(const FunctionKey& f, const Chain& way, const Unit& unit, const UnitPair& pair, double share) {
    ClockOrigin& o = origins_[{f, unit.polls}];
    o.function = f;
    o.polls = unit.polls;
    o.change += pair.change() * share;
    o.instructions += pair.instructions() * share;
    for (const auto& [cause, clocks] : pair.after.causes) o.causes[cause] += clocks * share;
    for (const auto& [cause, clocks] : pair.before.causes) o.causes[cause] -= clocks * share;
    if (const double part = pair.change() * share; std::abs(part) > std::abs(o.largest)) {
      o.largest = part;
      o.path = way;
    }
  }

  /// Code that was moved: what one function of a file gained and another one lost.
  static void join_moved(std::vector<ClockOrigin>& origins) {
    for (bool again = true; again;) {
      again = false;
      for (std::size_t i = 0; i < origins.size() && !again; ++i)
        for (std::size_t j = 0; j < origins.size() && !again; ++j) {
          ClockOrigin &a = origins[i], &b = origins[j];
          constexpr double kMoved = 0.5;  // of the larger amount of instructions
          if (i == j || a.function.second.empty() || a.function.second != b.function.second || a.polls != b.polls ||
              a.instructions <= 0 || b.instructions >= 0 || -b.instructions < kMoved * a.instructions ||
              a.instructions < kMoved * -b.instructions)
            continue;
          a.change += b.change;
          a.instructions += b.instructions;
          for (const auto& [cause, clocks] : b.causes) a.causes[cause] += clocks;
          a.with.push_back(b.function);
          a.with.insert(a.with.end(), b.with.begin(), b.with.end());
          a.path.clear();
          origins.erase(origins.begin() + static_cast<std::ptrdiff_t>(j));
          again = true;
        }
    }
  }

  /// Where the code of a function is in each run, and what all of it executes.
  struct Home {
    bool inlined_before = false, own_before = false, inlined_after = false, own_after = false;
    UnitPair all;
  };

  const Attribution &was_, &is_;
  std::map<FunctionKey, Home> homes_;
  mutable std::map<FunctionKey, bool> other_code_;
  std::set<FunctionKey> before_, after_;  // that execute anything
  std::map<Chain, UnitPair> whole_;       // with and without the loops that wait
  std::map<Unit, UnitPair> units_;
  std::map<FunctionKey, std::map<Chain, UnitPair>> copies_;  // of inlined functions, by where they are
  std::map<FunctionKey, UnitPair> bodies_;                   // with what is inlined
  std::map<Chain, std::pair<double, double>> paths_;
  std::map<std::pair<FunctionKey, bool>, ClockOrigin> origins_;
};

}  // namespace

std::vector<ClockOrigin> origins_of(const Attribution& before, const Part& a, const Attribution& after, const Part& b) {
  return OriginSearch(before, a, after, b).result();
}

}  // namespace fovea::regression
