#include "sw/fovea/report/page.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "sw/fovea/files/checked_file.h"
#include "sw/fovea/report/assets.h"
#include "sw/fovea/report/chart_data.h"
#include "sw/fovea/report/html.h"
#include "sw/fovea/report/sections.h"

namespace fovea::report {
namespace {

constexpr std::string_view kStart =
    "<!DOCTYPE html>\n<html lang=\"en\">\n<meta charset=\"utf-8\">\n"
    "<meta name=\"generator\" content=\"fovea report\">\n";

/// A page is below 3 MB; pictures get what text and charts leave, and something in any case.
constexpr std::size_t kPageBytes = 2'900'000, kLeastPictureBytes = 400'000;

std::string data_json(const std::vector<Results>& runs) {
  nlohmann::ordered_json data{{"format", "fovea report 1"},
                              {"words", words_json()},
                              {"runs", nlohmann::ordered_json::array()}};
  for (std::size_t i = 0; i < runs.size(); ++i)
    data["runs"].push_back(chart_data(runs[i], runs.size() == 1 ? "" : run_label(i)));
  return script_json(data);
}

}  // namespace

std::string run_label(std::size_t index) { return std::string(1, static_cast<char>('A' + index)); }

bool is_report_page(std::string_view first_bytes) { return first_bytes.starts_with(kStart); }

std::string report_page(const std::vector<Results>& runs) {
  std::string title;
  for (const auto& run : runs) title += (title.empty() ? "" : "; ") + run.name;
  std::vector<Section> sections = sections_of(runs);
  const std::string script(kScript), data = data_json(runs);
  std::size_t used = script.size() + data.size() + kStyle.size();
  for (const auto& s : sections) used += s.html.size();
  const std::size_t left = std::max(kPageBytes - std::min(used, kPageBytes), kLeastPictureBytes);
  for (Section& s : sections)
    if (std::string_view(s.id) == "pictures") s.html = pictures_section(runs, choose_pictures(runs, left));
  std::string out = fmt::format(
      "{}<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; img-src data:; "
      "style-src 'unsafe-inline'; script-src '{}'\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
      "<meta name=\"color-scheme\" content=\"light dark\">\n"
      "<title>{} - Fovea report</title>\n<style>{}</style>\n",
      kStart, script_digest(script), escaped(title), kStyle);
  out += fmt::format(
      "<a class=\"skip\" href=\"#verdict\">Skip to the verdict</a>\n<header><h1>{}</h1>"
      "<div id=\"controls\"></div></header>\n<section aria-labelledby=\"system-title\">"
      "<h2 id=\"system-title\" class=\"unseen\">System</h2>{}</section>\n"
      "<nav aria-label=\"Sections\"><ul>",
      escaped(title), system_section(runs));
  for (const auto& s : sections)
    out += fmt::format("<li><a href=\"#{}\">{}</a></li>", s.id, s.title);
  out +=
      "</ul></nav>\n<main>\n<noscript><p class=\"note\">Charts need JavaScript; all figures are in "
      "the "
      "tables.</p></noscript>\n";
  for (const auto& s : sections)
    out += fmt::format(
        "<section id=\"{0}\" aria-labelledby=\"{0}-title\"><h2 "
        "id=\"{0}-title\">{1}</h2>\n{2}</section>\n",
        s.id, s.title, s.html);
  out += fmt::format(
      "</main>\n<script type=\"application/json\" "
      "id=\"data\">{}</script>\n<script>{}</script>\n</html>\n",
      data, script);
  return out;
}

std::string report_text(const std::vector<Results>& runs) {
  std::string out;
  const auto list = [&](const std::vector<explain::Finding>& findings) {
    for (const auto& f : findings) {
      out += "- " + app::printable(f.text) + "\n    from ";
      for (const auto& e : f.evidence)
        out += (&e == &f.evidence.front() ? "" : ", ") + app::printable(e);
      out += "\n";
    }
  };
  for (std::size_t i = 0; i < runs.size(); ++i) {
    out += app::printable(title_of(runs, i)) + "\n";
    if (const std::string text = system_text(runs[i]); !text.empty()) out += app::printable(text) + "\n";
    out += app::verdict(runs[i].stats);
    if (!runs[i].complete) out += "These results are partial.\n";
    list(findings_of(runs[i]));
    if (runs[i].slowest)
      for (const auto& r : app::slowest_of_each(*runs[i].slowest)) out += app::printable(slowest_sentence(r)) + "\n";
    if (const std::string command = binds_command_of(runs[i]); !command.empty())
      out += "What makes its remaps faster is found by runs: " + app::printable(command) + "\n";
  }
  for (std::size_t i = 1; i < runs.size(); ++i) {
    out += fmt::format("{} against A\n", run_label(i));
    list(differences_of(runs, i));
  }
  return out;
}

}  // namespace fovea::report
