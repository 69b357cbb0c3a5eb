#include "sw/fovea/limits/answers.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "sw/fovea/results/names.h"
#include "sw/fovea/results/outputs.h"

namespace fovea::limits {
namespace {

using Answer = Bisection::Answer;

std::string joined(const Settings& settings) { return fmt::format("{}", fmt::join(settings, ", ")); }

std::string slack_text(const points::PointResult& r) {
  const auto left = slack(r);
  if (!left) return "";
  if (*left < 0) return fmt::format("; the longest remap takes {:.1f} % more than a frame period", -100 * *left);
  return fmt::format("; the longest remap leaves {:.1f} % of a frame period", 100 * *left);
}

/// A loop that has slipped shows every frame, but later. Empty: this one shows its frames no later than the other one.
std::string later_text(const points::PointResult& r, const points::PointResult& than, const std::string& name) {
  const auto late = r.stat(names::kLatencyMax), before = than.stat(names::kLatencyMax), rate = steady_rate(r);
  if (!late || !before || !rate || (*late - *before) * *rate < 0.5) return "";
  return fmt::format("; frames are shown {} after their capture, {} later than with {}, as the loop has slipped",
                     app::human_text(*late, "s"), app::human_text(*late - *before, "s"), name);
}

/// Of an answer that is an edge.
std::string edge_text(const Study& study, const Bisection::Outcome& o) {
  const ValueSearch& s = *study.find();
  const auto name = [&](std::uint64_t n) { return study.range()->text(n); };
  const bool largest = o.answer == Answer::kLargest;
  const std::uint64_t end = largest ? 0 : study.range()->last();
  std::string out = fmt::format("{}: ", study.range()->key());
  if (o.monotonic)
    out += fmt::format("{} is the {} of the {} values tried that meets the conditions", name(o.good),
                       largest ? "largest" : "smallest", s.tried().size());
  else
    out += fmt::format("from {} {} to {} every value that was tried meets the conditions, {} were tried", name(end),
                       largest ? "up" : "down", name(o.good), s.tried().size());
  out +=
      fmt::format("{}{}. With {}: {}.\n", slack_text(s.at(o.good).result),
                  later_text(s.at(o.good).result, s.at(end).result, name(end)), name(o.bad), s.at(o.bad).verdict.why);
  if (!o.monotonic)
    out += fmt::format(
        "  Not monotonic: beyond that, {} meets the conditions too, although a value before it does not. "
        "--probes 1000 tries up to 1000 more values.\n",
        name(o.odd));
  return out;
}

std::string find_text(const Study& study) {
  const ValueSearch& s = *study.find();
  const std::string& key = study.range()->key();
  const auto name = [&](std::uint64_t n) { return study.range()->text(n); };
  if (s.failure()) return fmt::format("{}: no answer, {}.\n", key, s.failure()->why);
  const auto o = s.outcome();
  const std::uint64_t last = study.range()->last();
  const auto ends = [&] {
    return fmt::format("{} ({}) nor {} ({})", name(0), s.at(0).verdict.why, name(last), s.at(last).verdict.why);
  };
  switch (o.answer) {
    case Answer::kAll: {
      const std::uint64_t tightest = *s.answer();
      const std::uint64_t other = tightest == last ? 0 : last;
      return fmt::format(
          "{}: all {} values that were tried from {} to {} meet the conditions. The tightest is {}{}{}.\n", key,
          s.tried().size(), name(0), name(last), name(tightest), slack_text(s.at(tightest).result),
          later_text(s.at(tightest).result, s.at(other).result, name(other)));
    }
    case Answer::kNone:
      return fmt::format("{}: neither {} meets the conditions, nor does one of the {} values tried.\n", key, ends(),
                         s.tried().size());
    case Answer::kBetween:
      return fmt::format(
          "{}: neither {} meets the conditions, but {} between them does{}. --probes 1000 tries up to "
          "1000 more values.\n",
          key, ends(), name(o.good), slack_text(s.at(o.good).result));
    default:
      return edge_text(study, o);
  }
}

/// What was moved and, behind it, what was asked for: the memory may not give it.
std::string load_rate(const LoadSearch& load, std::uint64_t n) {
  return fmt::format("{:.1f} MB/s moved ({})", load.moved(n),
                     n == load.last() ? load.rate_text(n) : "asked for " + load.rate_text(n));
}

std::string load_text(const LoadSearch& load) {
  const ValueSearch& s = load.search();
  std::string out = fmt::format("  port {}, priority {}: ", load.place().port, load.place().priority);
  if (s.failure()) return out + fmt::format("no answer, {}\n", s.failure()->why);
  const auto o = s.outcome();
  const auto most = load.answer();
  if (!most) return out + "none\n";
  out += *most == 0 ? "none" : load_rate(load, *most) + slack_text(s.at(*most).result);
  if (o.answer == Answer::kLargest) out += fmt::format(". With {}: {}", load.rate_text(o.bad), s.at(o.bad).verdict.why);
  out += "\n";
  if (!o.monotonic && o.answer == Answer::kLargest)
    out += fmt::format("  Not monotonic: with {} the conditions are met too.\n", load.rate_text(o.odd));
  return out;
}

/// Bytes that a place bears, MB/s.
double borne(const LoadSearch& load) {
  const auto most = load.answer();
  return most && *most > 0 ? load.moved(*most) : 0;
}

std::string demand_text(const Study& study) {
  std::string out;
  for (const Demand& d : demands()) {
    Settings yes, perhaps, no;
    bool every = true;  // port and priority that was tried has an answer
    for (const auto& load : study.loads()) {
      if (load->search().failure()) {
        every = false;
        continue;
      }
      const double most = borne(*load);
      (most >= d.high ? yes : most >= d.low ? perhaps : no)
          .push_back(fmt::format("{}/{}", load->place().port, load->place().priority));
    }
    const std::string need = d.low == d.high ? fmt::format("{:.1f} MB/s", d.likely)
                                             : fmt::format("{:.0f} ({:.0f} to {:.0f}) MB/s", d.likely, d.low, d.high);
    out += fmt::format("  {} needs {}: ", d.name, need);
    if (yes.empty() && perhaps.empty() && no.empty()) out += "no answer";
    else if (every && perhaps.empty() && no.empty())
      out += "it can run beside this at every port and priority that was tried";
    else if (every && yes.empty() && perhaps.empty()) out += "it cannot run beside this";
    else {
      const auto list = [&](const char* word, const Settings& at) {
        return at.empty() ? std::string() : fmt::format("{} at {}; ", word, fmt::join(at, " "));
      };
      out += list("yes", yes) + list("perhaps", perhaps) + list("no", no);
      out.resize(out.size() - 2);
    }
    out += fmt::format(". [{}]\n", d.source);
  }
  return out;
}

std::string settings_text(const Relaxation& r) {
  Settings all = r.settings;
  all.insert(all.end(), r.options.begin(), r.options.end());
  return fmt::format("{}", fmt::join(all, ", "));
}

/// What is believed of a resource, and what relaxing it gains at both ends of that. Empty: its figures are known.
std::string belief_text(const Study& study, const Binds::Row& row) {
  const Relaxation& r = row.relaxation;
  if (!r.believed()) return "";
  const auto end = [&](const std::vector<std::string>& settings, const Binds::Row::End& e) {
    if (!e.plain || !e.gain) return fmt::format("{}: no figure", fmt::join(settings, ", "));
    return fmt::format("with {} it would be {} and {:.1f} % of that would go", fmt::join(settings, ", "),
                       app::human_text(*e.plain, study.binds()->unit()), 100 * *e.gain);
  };
  return fmt::format("    This is {}: {}; {}.\n",
                     r.origin == Origin::kAssumed ? "assumed, no public figure" : "known of sister chips only",
                     end(r.low, row.low()), end(r.high, row.high()));
}

/// "bridge_vpfe (+0.1 %; assumed, +0.0 to +0.3 %)".
std::string gain_text(const Binds::Row& row) {
  const Relaxation& r = row.relaxation;
  std::string out = fmt::format("{} ({:+.1f} %", r.name, 100 * *row.gain);
  if (r.believed()) {
    out += fmt::format("; {}", to_string(r.origin));
    const auto low = row.low().gain, high = row.high().gain;
    out += low && high ? fmt::format(", {:+.1f} to {:+.1f} %", 100 * *low, 100 * *high) : ", ends not known";
  }
  return out + ")";
}

std::string sentence_of(const Study& study, const Binds::Row& row) {
  const Relaxation& r = row.relaxation;
  std::string resource = r.resource;
  resource[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(resource[0])));
  return fmt::format("  {} binds: {} ({}) it is {}, {:.1f} % better{}.\n", resource, r.how, settings_text(r),
                     app::human_text(*row.after, study.binds()->unit()), 100 * *row.gain,
                     r.replay ? ", by replay" : "") +
         belief_text(study, row);
}

std::string binds_text(const Study& study) {
  const Binds& b = *study.binds();
  const std::string at = study.binds_at().empty() ? "" : " at " + study.binds_at();
  if (b.failure()) return fmt::format("What binds {}{}: no answer, {}.\n", b.metric(), at, b.failure()->why);
  std::string out = fmt::format("What binds {}{} ({}), each resource relaxed alone and run again:\n", b.metric(), at,
                                app::human_text(*b.plain(), b.unit()));
  Settings perhaps, little, worse, idle, failed;
  bool any = false;
  for (const Binds::Row& row : b.rows()) {
    const Relaxation& r = row.relaxation;
    if (row.binds()) {
      any = true;
      out += sentence_of(study, row);
    } else if (row.gain) {
      (row.may_bind() ? perhaps : *row.gain < -kBinds ? worse : little).push_back(gain_text(row));
    } else {
      (r.idle.empty() ? failed : idle).push_back(fmt::format("{} ({})", r.name, r.idle.empty() ? row.failure : r.idle));
    }
  }
  if (!any) out += "  Nothing that was relaxed makes it more than 2 % better.\n";
  const auto add = [&](const char* what, const Settings& list, const char* between) {
    if (!list.empty()) out += fmt::format("  {}: {}.\n", what, fmt::join(list, between));
  };
  add("Does not bind as it is, but may within what is believed", perhaps, "; ");
  add("Does not bind", little, ", ");
  add("Makes it worse", worse, ", ");
  add("Not tried", idle, "; ");
  add("Without a figure", failed, "; ");
  return out;
}

std::string plain_text(const Study& study) {
  const Verdict& v = study.plain_verdict();
  if (v.good()) return fmt::format("It meets the conditions{}.\n", slack_text(*study.plain()));
  if (v.kind == Verdict::Kind::kUnknown) return fmt::format("No answer, {}.\n", v.why);
  return fmt::format("It does not meet the conditions as it is: {}.\n", v.why);
}

}  // namespace

std::string answers_text(const std::vector<std::unique_ptr<Study>>& studies, const Question& question,
                         const std::vector<Condition>& conditions) {
  Settings all;
  for (const Condition& c : conditions) all.push_back(text_of(c));
  std::string out =
      fmt::format("Conditions: {}; the remaps of a frame take no longer than its period on average.\n", joined(all));
  for (const auto& study : studies) {
    if (!study->over().empty()) out += fmt::format("\n{}:\n", joined(study->over()));
    if (study->find()) out += find_text(*study);
    if (study->plain() && (!question.load || !study->plain_verdict().good())) out += plain_text(*study);
    if (!study->loads().empty()) {
      out += fmt::format("The largest additional load ({} bursts of {} bytes, {}, in {} slots), by port and "
                         "priority (0 is the highest):\n",
                         question.shape.kind, question.shape.bytes, question.shape.pattern, question.shape.slots);
      for (const auto& load : study->loads()) out += load_text(*load);
      out += demand_text(*study);
    }
    if (study->binds()) out += binds_text(*study);
  }
  return out;
}

}  // namespace fovea::limits
