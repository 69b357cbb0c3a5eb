#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <utility>

#include "sw/fovea/limits/answers.h"
#include "sw/fovea/results/names.h"
#include "sw/fovea/results/outputs.h"

namespace fovea::limits {
namespace {

using Answer = Bisection::Answer;

std::string cell(std::string_view text) {
  if (text.find_first_of(",\"\n") == text.npos) return std::string(text);
  std::string out = "\"";
  for (const char c : text) out += c == '"' ? std::string("\"\"") : std::string(1, c);
  return out + "\"";
}

std::string line(const std::vector<std::string>& cells) {
  std::vector<std::string> out;
  for (const std::string& c : cells) out.push_back(cell(c));
  return fmt::format("{}\n", fmt::join(out, ","));
}

std::string number(const std::optional<double>& v) { return v ? app::number_text(*v) : ""; }

const char* word(Answer answer) {
  switch (answer) {
    case Answer::kLargest: return "largest";
    case Answer::kSmallest: return "smallest";
    case Answer::kAll: return "all";
    case Answer::kBetween: return "between";
    case Answer::kNone: return "none";
    case Answer::kUnknown: break;
  }
  return "unknown";
}

/// The columns of --over: keys, or values.
std::vector<std::string> over_cells(const Study& study, bool keys) {
  std::vector<std::string> out;
  for (const std::string& s : study.over()) {
    const auto at = s.find('=');
    out.push_back(keys ? s.substr(0, at) : s.substr(at + 1));
  }
  return out;
}

void add_result(const points::PointResult& r, std::vector<std::string>& row) {
  row.insert(row.end(), {number(r.stat(names::kRate)), number(r.stat(names::kRemapTimeMean)),
                         number(r.stat(names::kRemapTimeMax)), number(r.stat(names::kDdrUtilisation)),
                         number(r.stat(names::kLatencyMax)), number(slack(r))});
}
constexpr const char* kResult[] = {names::kRate,           names::kRemapTimeMean, names::kRemapTimeMax,
                                   names::kDdrUtilisation, names::kLatencyMax,    "left_of_frame_period"};

struct SearchRow {
  std::string what;
  std::optional<unsigned> priority;
  const ValueSearch* search;
  std::function<std::string(std::uint64_t)> name;
  std::function<double(std::uint64_t)> moved;
};

std::vector<std::string> row_of(const SearchRow& r, std::optional<std::uint64_t> good) {
  std::vector<std::string> row = {r.what, r.priority ? std::to_string(*r.priority) : ""};
  if (r.search->failure()) {
    row.insert(row.end(), {"unknown", "", "", "", r.search->failure()->why, "", ""});
    row.insert(row.end(), std::size(kResult), "");
    return row;
  }
  const auto o = r.search->outcome();
  const bool edge = o.answer == Answer::kLargest || o.answer == Answer::kSmallest;
  row.push_back(word(o.answer));
  row.push_back(good ? r.name(*good) : "");
  row.push_back(good && r.moved && *good > 0 ? app::number_text(r.moved(*good)) : "");
  row.push_back(edge ? r.name(o.bad) : good ? "" : r.name(0));
  row.push_back(edge ? r.search->at(o.bad).verdict.why : good ? "" : r.search->at(0).verdict.why);
  row.push_back(o.monotonic ? "yes" : "no");
  row.push_back(std::to_string(r.search->tried().size()));
  add_result(r.search->at(good.value_or(0)).result, row);
  return row;
}

}  // namespace

std::string limits_csv(const std::vector<std::unique_ptr<Study>>& studies) {
  std::vector<std::string> header = over_cells(*studies.front(), true);
  header.insert(header.end(),
                {"searched", "priority", "answer", "good", "moved_MBps", "bad", "why_bad", "monotonic", "tried"});
  header.insert(header.end(), std::begin(kResult), std::end(kResult));
  std::string out = line(header);
  for (const auto& study : studies) {
    const std::vector<std::string> over = over_cells(*study, false);
    const auto add = [&](const std::vector<std::string>& cells) {
      std::vector<std::string> row = over;
      row.insert(row.end(), cells.begin(), cells.end());
      out += line(row);
    };
    if (study->find())
      add(row_of(
          {study->range()->key(), {}, study->find(), [&](std::uint64_t n) { return study->range()->text(n); }, {}},
          study->find()->answer()));
    for (const auto& load : study->loads())
      add(row_of({"load on " + load->place().port, load->place().priority, &load->search(),
                  [&](std::uint64_t n) { return load->rate_text(n); }, [&](std::uint64_t n) { return load->moved(n); }},
                 load->answer()));
    if (study->plain()) {
      const Verdict& v = study->plain_verdict();
      const char* const kinds[] = {"met", "not met", "unknown"};
      std::vector<std::string> row = {"as it is", "", kinds[static_cast<int>(v.kind)], "", "", "", v.why, "", ""};
      add_result(*study->plain(), row);
      add(row);
    }
  }
  return out;
}

std::string binds_csv(const std::vector<std::unique_ptr<Study>>& studies) {
  std::vector<std::string> header = over_cells(*studies.front(), true);
  header.insert(header.end(),
                {"at", "resource", "binds", "gain", "metric", "plain", "reference", "relaxed", "unit", "by", "settings",
                 "remark", "origin", "low", "plain_low", "gain_low", "high", "plain_high", "gain_high"});
  std::string out = line(header);
  for (const auto& study : studies) {
    if (!study->binds() || study->binds()->failure()) continue;
    const Binds& b = *study->binds();
    for (const Binds::Row& r : b.rows()) {
      std::vector<std::string> row = over_cells(*study, false), settings = r.relaxation.settings;
      settings.insert(settings.end(), r.relaxation.options.begin(), r.relaxation.options.end());
      row.insert(
          row.end(),
          {study->binds_at(), r.relaxation.name,
           !r.gain        ? ""
           : r.binds()    ? "yes"
           : r.may_bind() ? "perhaps"
                          : "no",
           number(r.gain), b.metric(), number(b.plain()), number(r.before), number(r.after), b.unit(),
           r.relaxation.replay ? "replay" : "run", fmt::format("{}", fmt::join(settings, " ")),
           r.relaxation.idle.empty() ? r.failure : r.relaxation.idle, std::string(to_string(r.relaxation.origin)),
           fmt::format("{}", fmt::join(r.relaxation.low, " ")), number(r.low().plain), number(r.low().gain),
           fmt::format("{}", fmt::join(r.relaxation.high, " ")), number(r.high().plain), number(r.high().gain)});
      out += line(row);
    }
  }
  return out;
}

std::string points_csv(std::vector<points::Runner::Entry> entries, const std::vector<Condition>& conditions) {
  // Searches that run at once add their points in the order in which runs end, which depends on the host.
  std::stable_sort(entries.begin(), entries.end(), [](const auto& a, const auto& b) {
    return std::pair(a.point.label, points::key_of(a.point)) < std::pair(b.point.label, points::key_of(b.point));
  });
  std::string out = line({"folder", "command", "point", "status", "verdict", "why"});
  for (const auto& [point, result] : entries) {
    if (!result) continue;
    std::vector<std::string> row = {result->folder.filename().string(), point.command, point.label,
                                    std::to_string(result->status)};
    if (point.command == "run") {
      const Verdict v = judge(*result, conditions);
      const char* const kinds[] = {"met", "not met", "unknown"};
      row.insert(row.end(), {v.longer && !v.good() ? "once" : kinds[static_cast<int>(v.kind)], v.why});
    } else {
      row.insert(row.end(), {"", result->message});
    }
    out += line(row);
  }
  return out;
}

}  // namespace fovea::limits
