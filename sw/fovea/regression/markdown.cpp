// The result of a check for the page of a merge request.
#include <fmt/format.h>

#include <algorithm>

#include "sw/fovea/compare/compare.h"
#include "sw/fovea/files/checked_file.h"
#include "sw/fovea/regression/check.h"

namespace fovea::regression {
namespace {

/// Text that Markdown shows as it is.
std::string plain(const std::string& text) {
  std::string out;
  for (const char c : app::one_line(text, 1000)) {
    if (std::string_view("\\`*<>|~&[").find(c) != std::string_view::npos) out += '\\';
    out += c;
  }
  return out;
}

/// A name as code.
std::string code(const std::string& name) {
  std::string out = app::one_line(name);
  std::replace(out.begin(), out.end(), '`', '\'');
  return "`" + out + "`";
}

std::string expected_value(const Finding& f) {
  if (!f.expected->value) return "no value";
  return figure_text({f.expected->value, f.expected->unit, f.got && f.got->whole});
}

std::string got_value(const Finding& f) {
  if (!f.got || f.got->unit != f.expected->unit || !f.got->value) return f.words;
  std::string out = figure_text(*f.got);
  if (f.expected->value && *f.expected->value != 0 && *f.got->value != *f.expected->value)
    out += fmt::format(" ({}; {})", percent_text((*f.got->value - *f.expected->value) / std::abs(*f.expected->value)),
                       allowed_text(*f.expected));
  else
    out += fmt::format(" ({})", allowed_text(*f.expected));
  return out;
}

/// The figure that the five lines are about, and the others that fail.
std::string figure_line(const std::vector<const Finding*>& sorted, std::size_t failures, const std::string& label) {
  if (!failures)
    return fmt::format("all {} of {} pass; the largest deviation has {}", sorted.size(), code(label),
                       code(sorted.front()->expected->name));
  std::string out = fmt::format("{} of {} is worse", code(sorted.front()->expected->name), code(label));
  constexpr std::size_t kNamed = 4;
  for (std::size_t i = 1; i < std::min(failures, kNamed); ++i)
    out += (i == 1 ? ", and so is " : ", ") + code(sorted[i]->expected->name);
  if (failures > kNamed) out += fmt::format(" and {} more", failures - kNamed);
  return out;
}

}  // namespace

std::string markdown_text(const CheckResult& result, const RunFigures& run, const Baseline& baseline) {
  const std::size_t failures = result.failures();
  std::vector<const Finding*> sorted = findings_by_size(result);
  if (!failures)
    std::stable_sort(sorted.begin(), sorted.end(), [](const auto* a, const auto* b) { return a->size() > b->size(); });
  std::string who = "nobody", why = "no figure is worse than its tolerance allows";
  if (failures) {
    who = result.blamed.empty() ? "not known" : code(result.blamed);
    why = result.blame;
    if (why.starts_with(result.blamed)) why.erase(0, result.blamed.size());
    why.erase(0, why.find_first_not_of(": "));
    if (why.empty())
      why = baseline.reference.empty() ? "the baseline has no reference" : "the core's clocks do not tell";
    if (!result.advice.empty()) why += "; " + result.advice;
  }
  return fmt::format("- **figure**: {}\n- **before**: {}\n- **after**: {}\n- **who**: {}\n- **why**: {}\n",
                     figure_line(sorted, failures, run.subject.label()), plain(expected_value(*sorted.front())),
                     plain(got_value(*sorted.front())), who, plain(why));
}

}  // namespace fovea::regression
