#include "sw/fovea/limits/answers.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "sw/fovea/outputs.h"

namespace fovea::limits {
namespace {

using Answer = Bisection::Answer;

std::string joined(const Settings& settings) { return fmt::format("{}", fmt::join(settings, ", ")); }

/// What a run had left: the share of a frame period that its longest remap does not take.
std::optional<double> slack(const points::PointResult& r) {
  const auto rate = r.stat("frame.rate"), longest = r.stat("frame.remap_time.max");
  if (!rate || !longest || *rate <= 0) return std::nullopt;
  return 1 - *longest * *rate;
}

std::string slack_text(const points::PointResult& r) {
  const auto left = slack(r);
  if (!left) return "";
  if (*left < 0) return fmt::format("; the longest remap takes {:.1f} % more than a frame period", -100 * *left);
  return fmt::format("; the longest remap leaves {:.1f} % of a frame period", 100 * *left);
}

std::string odd_text(const Bisection::Outcome& o, const std::function<std::string(std::uint64_t)>& name) {
  if (o.monotonic) return "";
  return fmt::format("  Not monotonic: {} meets the conditions although a value before it does not.\n", name(o.odd));
}

std::string find_text(const Study& study) {
  const ValueSearch& s = *study.find();
  const std::string& key = study.range()->key();
  const auto name = [&](std::uint64_t n) { return study.range()->text(n); };
  if (s.failure()) return fmt::format("{}: no answer, {}.\n", key, s.failure()->why);
  const auto o = s.outcome();
  const std::uint64_t last = study.range()->last();
  switch (o.answer) {
    case Answer::kAll:
      return fmt::format("{}: all values that were tried from {} to {} meet the conditions{}.\n", key, name(0),
                         name(last), slack_text(s.at(last).result));
    case Answer::kNone:
      return fmt::format("{}: neither {} ({}) nor {} ({}) meets the conditions.\n", key, name(0), s.at(0).verdict.why,
                         name(last), s.at(last).verdict.why) +
             odd_text(o, name);
    default:
      return fmt::format("{}: {} is the {} value that meets the conditions{}. With {}: {}.\n", key, name(o.good),
                         o.answer == Answer::kLargest ? "largest" : "smallest", slack_text(s.at(o.good).result),
                         name(o.bad), s.at(o.bad).verdict.why) +
             odd_text(o, name);
  }
}

std::string load_text(const LoadSearch& load) {
  const ValueSearch& s = load.search();
  std::string out = fmt::format("  port {}, priority {}: ", load.place().port, load.place().priority);
  if (s.failure()) return out + fmt::format("no answer, {}\n", s.failure()->why);
  const auto name = [&](std::uint64_t n) { return load.rate_text(n); };
  const auto o = s.outcome();
  if (o.answer == Answer::kAll) {
    const std::uint64_t last = load.last();
    return out + fmt::format("{}, {:.1f} MB/s{}\n", name(last), load.moved(last), slack_text(s.at(last).result));
  }
  if (o.answer != Answer::kLargest) return out + "none\n";
  if (o.good == 0) return out + fmt::format("none; with {}: {}\n", name(o.bad), s.at(o.bad).verdict.why);
  return out +
         fmt::format("{} ({:.1f} MB/s moved){}. With {}: {}\n", name(o.good), load.moved(o.good),
                     slack_text(s.at(o.good).result), name(o.bad), s.at(o.bad).verdict.why) +
         odd_text(o, name);
}

/// Bytes that a place bears, MB/s.
double borne(const LoadSearch& load) {
  const auto o = load.search().outcome();
  if (o.answer == Answer::kAll) return load.moved(load.last());
  return o.answer == Answer::kLargest && o.good > 0 ? load.moved(o.good) : 0;
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

std::string binds_text(const Study& study) {
  const Binds& b = *study.binds();
  const std::string at = study.binds_at().empty() ? "" : " at " + study.binds_at();
  if (b.failure()) return fmt::format("What binds {}{}: no answer, {}.\n", b.metric(), at, b.failure()->why);
  const auto value = [&](double v) { return app::human_text(v, b.unit()); };
  std::string out = fmt::format("What binds {}{} ({}), each resource relaxed alone and run again:\n", b.metric(), at,
                                value(*b.plain()));
  Settings little, worse, idle, failed;
  bool any = false;
  for (const Binds::Row& row : b.rows()) {
    const Relaxation& r = row.relaxation;
    if (row.binds()) {
      any = true;
      std::string sentence = r.resource;
      sentence[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(sentence[0])));
      out += fmt::format("  {} binds: {} ({}) it is {}, {:.1f} % better{}.\n", sentence, r.how, settings_text(r),
                         value(*row.after), 100 * *row.gain, r.replay ? ", by replay" : "");
    } else if (row.gain) {
      (*row.gain < -kBinds ? worse : little).push_back(fmt::format("{} ({:+.1f} %)", r.name, 100 * *row.gain));
    } else {
      (r.idle.empty() ? failed : idle).push_back(fmt::format("{} ({})", r.name, r.idle.empty() ? row.failure : r.idle));
    }
  }
  if (!any) out += "  Nothing that was relaxed makes it more than 2 % better.\n";
  if (!little.empty()) out += fmt::format("  Does not bind: {}.\n", fmt::join(little, ", "));
  if (!worse.empty()) out += fmt::format("  Makes it worse: {}.\n", fmt::join(worse, ", "));
  if (!idle.empty()) out += fmt::format("  Not tried: {}.\n", fmt::join(idle, "; "));
  if (!failed.empty()) out += fmt::format("  Without a figure: {}.\n", fmt::join(failed, "; "));
  if (!b.remark().empty()) out += "  " + b.remark() + "\n";
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
  std::string out = fmt::format("Conditions: {}.\n", joined(all));
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
