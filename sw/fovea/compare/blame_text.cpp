// Who is to blame for a difference, in one sentence.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "sw/fovea/compare/blame.h"
#include "sw/fovea/results/outputs.h"

namespace fovea::regression {
namespace {

constexpr double kOrigin = 0.25;    // of the whole change; less is a by-product itself
constexpr double kNearlyAll = 0.8;  // of the whole change: nearly all of it
constexpr double kWorthNaming = 0.05;
constexpr std::size_t kNamed = 6;

std::string grouped_amount(double value) {
  return app::grouped(static_cast<std::uint64_t>(std::llround(std::abs(value))));
}

template <class T>
const T* largest_of(const std::vector<T>& changes, bool slower) {
  const auto amount = [slower](const T& c) { return c.share.change() * (slower ? 1 : -1); };
  const auto found =
      std::max_element(changes.begin(), changes.end(), [&](const T& a, const T& b) { return amount(a) < amount(b); });
  return found != changes.end() && amount(*found) > 0 ? &*found : nullptr;
}

/// The largest origin that may have made the whole change. Loops that only wait come after the others.
const ClockOrigin* worst_origin(const Difference& d, bool slower) {
  for (const bool polls : {false, true})
    for (const ClockOrigin& o : d.origins)  // the largest change comes first
      if (const double amount = o.change * (slower ? 1 : -1);
          o.polls == polls && amount > 0 && amount >= kOrigin * std::abs(d.busy.change()))
        return &o;
  return nullptr;
}

const FunctionChange* own_change(const Difference& d, const FunctionKey& key) {
  for (const FunctionChange& f : d.functions)
    if (FunctionKey(f.function, f.file) == key) return &f;
  return nullptr;
}

/// The change of an origin as that of a function, with the lines of the function itself.
FunctionChange as_function(const Difference& d, const ClockOrigin& o) {
  FunctionChange out;
  const FunctionChange* const own = own_change(d, o.function);
  if (own) out = *own;
  std::tie(out.function, out.file) = o.function;
  out.share = {0, o.change};
  out.instructions_before = 0;
  out.instructions_after = o.instructions;
  const bool fresh = own && (own->kind == ChangeKind::kAdded || own->kind == ChangeKind::kRemoved);
  if (o.polls)
    out.kind = ChangeKind::kPolls;
  else if (!fresh || !o.path.empty())
    out.kind = std::abs(o.instructions) >= 0.5 ? ChangeKind::kExecutes : ChangeKind::kWaits;
  out.causes.clear();
  for (const auto& [cause, change] : o.causes)
    if (change != 0) out.causes.push_back({std::get<0>(cause), std::get<1>(cause), std::get<2>(cause), {0, change}});
  std::stable_sort(out.causes.begin(), out.causes.end(), [](const CauseChange& a, const CauseChange& b) {
    return std::abs(a.share.change()) > std::abs(b.share.change());
  });
  return out;
}

/// The next largest ones, until nearly all of the change is named.
void name_others(const Difference& d, bool slower, bool origins, Blame& blame) {
  const double whole = d.busy.change() * (slower ? 1 : -1);
  double named = blame.function->share.change() * (slower ? 1 : -1);
  const FunctionKey first(blame.function->function, blame.function->file);
  const auto add = [&](const FunctionKey& key, double change) {
    const double amount = change * (slower ? 1 : -1);
    if (whole <= 0 || named >= kNearlyAll * whole || amount < kWorthNaming * whole || key == first ||
        blame.others.size() >= kNamed)
      return;
    named += amount;
    blame.others.emplace_back(key, change);
  };
  if (origins)
    for (const ClockOrigin& o : d.origins) add(o.function, o.change);
  else if (d.by_function)
    for (const FunctionChange& f : d.functions) add({f.function, f.file}, f.share.change());
}

void find_cause(Blame& blame, bool slower) {
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
  blame.line = largest_of(blame.function->lines, slower);
  // Rather the line at which that cause grew than one at which others did.
  double grew = 0;
  for (const auto& line : blame.function->lines)
    if (const auto found = line.causes.find(most); found != line.causes.end())
      if (const double amount = found->second * (slower ? 1 : -1); amount > grew) {
        grew = amount;
        blame.line = &line;
      }
}

/// For a difference without more clocks: names the function that executes more all the same.
std::string more_instructions(const Difference& difference) {
  const auto more = [](const FunctionChange& f) { return f.instructions_after - f.instructions_before; };
  const auto most = std::max_element(difference.functions.begin(), difference.functions.end(),
                                     [&](const auto& a, const auto& b) { return more(a) < more(b); });
  if (most == difference.functions.end() || more(*most) <= 0) return "";
  return fmt::format("{} executes {} instructions more, which take no more clocks in all", place_text(*most, nullptr),
                     grouped_amount(more(*most)));
}

std::string what_text(const FunctionChange& f) {
  const double instructions = f.instructions_after - f.instructions_before;
  const bool slower = f.share.change() > 0;
  if (f.kind == ChangeKind::kWaits) return slower ? "waits with the same instructions" : "waits less";
  if (f.kind == ChangeKind::kPolls) return slower ? "polls longer" : "polls less";
  // What executes less and yet takes longer does not execute less in the sense of the sentence.
  if (f.kind == ChangeKind::kExecutes && (instructions > 0) != slower)
    return slower ? "takes longer with fewer instructions" : "is faster with more instructions";
  return kind_text(f.kind, instructions > 0);
}

std::string way_text(const std::vector<FunctionKey>& path) {
  std::string out;
  for (const FunctionKey& f : path) out += (out.empty() ? "" : " > ") + f.first;
  return out;
}

}  // namespace

std::string kind_text(ChangeKind kind, bool more) {
  switch (kind) {
    case ChangeKind::kAdded:
      return "is new";
    case ChangeKind::kRemoved:
      return "is gone";
    case ChangeKind::kExecutes:
      return more ? "executes more" : "executes less";
    case ChangeKind::kLayout:
      return "was moved (layout)";
    case ChangeKind::kPolls:
      return "polls";
    case ChangeKind::kWaits:
      break;
  }
  return "same instructions";
}

std::string part_text(RunPart part) {
  switch (part) {
    case RunPart::kRemap:
      return "in phase remap";
    case RunPart::kLut:
      return "in phase lut";
    case RunPart::kStartup:
      return "before the first frame";
    case RunPart::kWindow:
      break;
  }
  return "";
}

Blame blame_of(const Difference& difference, bool slower) {
  Blame blame;
  if (const ClockOrigin* const o = worst_origin(difference, slower)) {
    blame.function = std::make_shared<FunctionChange>(as_function(difference, *o));
    blame.path = o->path;
    blame.with = o->with;
    name_others(difference, slower, true, blame);
  } else if (const FunctionChange* const f = largest_of(difference.functions, slower)) {
    blame.function = std::make_shared<FunctionChange>(*f);
    name_others(difference, slower, false, blame);
  } else {
    return blame;
  }
  find_cause(blame, slower);
  return blame;
}

std::optional<double> needed(const Difference& d, const std::string& figure, double change) {
  const bool time =
      figure.starts_with("frame.remap_time.") || figure.starts_with("frame.latency.") || figure.starts_with("startup.");
  if (!time || (!d.in_seconds && d.seconds <= 0)) return std::nullopt;
  const bool each = !figure.starts_with("startup.") && !d.per_remap && d.remaps > 0;
  return std::abs(change) * (each ? d.remaps : 1) / (d.in_seconds ? 1 : d.seconds);
}

std::string amount_text(const Difference& difference, double amount) {
  const char* const sign = amount < 0 ? "-" : "+";
  const char* const each = difference.per_remap ? " a remap" : "";
  if (difference.in_seconds) return sign + app::human_text(std::abs(amount), "s") + each;
  return sign + grouped_amount(amount) + " clocks" + each;
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

std::string blame_text(const Difference& difference, const Blame& blame) {
  if (!blame.function) return more_instructions(difference);
  const FunctionChange& f = *blame.function;
  const double whole = difference.busy.change();
  std::string out = place_text(f, blame.line);
  if (difference.by_function) out += " " + what_text(f);
  if (!blame.path.empty()) out += " in " + way_text(blame.path);
  out += ": " + amount_text(difference, f.share.change());
  if (whole != 0 && (whole > 0) == (f.share.change() > 0))
    out += fmt::format(" ({:.0f} % of the change)", 100 * f.share.change() / whole);
  if (blame.cause) {
    const bool alone = blame.by_cause == blame.cause->share.change();
    out += fmt::format(", of which {} by {}", amount_text(difference, blame.by_cause),
                       cause_text(*blame.cause, alone ? "" : "mostly "));
  }
  if (!blame.with.empty()) out += fmt::format("; code moved between it and {}", way_text(blame.with));
  for (const auto& [key, change] : blame.others)
    out += fmt::format("; {} {}", key.first, amount_text(difference, change));
  if (f.kind == ChangeKind::kWaits && difference.program_differs && !difference.moved_objects.empty())
    out += "; " + difference.moved_objects;
  for (const std::string& note : difference.notes) out += "; " + note;
  if (const std::string part = part_text(difference.part); !part.empty()) out += ", " + part;
  return out;
}

}  // namespace fovea::regression
