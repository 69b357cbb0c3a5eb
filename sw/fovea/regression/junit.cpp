#include <fmt/format.h>

#include "sw/fovea/compare/compare.h"
#include "sw/fovea/files/checked_file.h"
#include "sw/fovea/files/xml.h"
#include "sw/fovea/regression/check.h"

namespace fovea::regression {

std::string junit_xml(const CheckResult& result, const RunFigures& run, const Baseline& baseline,
                      const std::string& when) {
  const std::string suite = "fovea." + app::xml_text(run.subject.label());
  // Elements in the order, and attributes, that the schemas of Ant's JUnit task, Maven Surefire and
  // Jenkins' xUnit plugin demand; the time of a comparison is not measured.
  std::string out = fmt::format(
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuites>\n"
      "  <testsuite package=\"fovea\" id=\"0\" name=\"{}\" timestamp=\"{}\" hostname=\"localhost\" "
      "tests=\"{}\" failures=\"{}\" errors=\"0\" skipped=\"0\" time=\"0\">\n    <properties>\n",
      suite, when, result.findings.size(), result.failures());
  const auto property = [&out](std::string_view name, const std::string& value) {
    out += fmt::format("      <property name=\"{}\" value=\"{}\"/>\n", name, app::xml_text(value));
  };
  property("simulator", run.simulator());
  property("baseline", baseline.file.string());
  property("results", run.folder.string());
  out += "    </properties>\n";
  for (const auto& f : result.findings) {
    out += fmt::format("    <testcase name=\"{}\" classname=\"{}\" time=\"0\"", app::xml_text(f.expected->name),
                       suite);
    if (f.verdict != Verdict::kFail) {
      out += "/>\n";
      continue;
    }
    std::string body = f.words;
    if (!f.expected->reason.empty()) body += "\nreason: " + f.expected->reason;
    if (!result.blame.empty()) body += "\nblamed: " + result.blame;
    if (!result.advice.empty()) body += "\n" + result.advice;
    out += fmt::format(">\n      <failure type=\"{}\" message=\"{}\">{}</failure>\n    </testcase>\n",
                       kind_name(f.expected->kind), app::xml_text(f.words), app::xml_text(body));
  }
  const std::string log = check_text(result, run, baseline, true);
  out += fmt::format("    <system-out>{}</system-out>\n    <system-err></system-err>\n"
                     "  </testsuite>\n</testsuites>\n",
                     app::xml_text(log));
  return out;
}

}  // namespace fovea::regression
