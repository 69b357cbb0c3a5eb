#include "sw/fovea/report/sections.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "sw/fovea/explain/command.h"
#include "sw/fovea/report/html.h"
#include "sw/fovea/report/page.h"
#include "sw/fovea/results/names.h"

namespace fovea::report {
namespace {

constexpr std::array kKeyFigures{names::kRate,
                                 names::kDisplayed,
                                 names::kRepeated,
                                 names::kDropped,
                                 names::kRemapTimeMean,
                                 names::kRemapTimeMin,
                                 names::kRemapTimeMax,
                                 names::kLatencyMean,
                                 names::kLatencyMin,
                                 names::kLatencyMax,
                                 names::kStartupLutTime,
                                 names::kCaptureOverflows,
                                 names::kDisplayUnderflows,
                                 names::kCpuCycles,
                                 names::kCpuInstructions,
                                 names::kCpuSpare,
                                 names::kDdrUtilisation,
                                 names::kDdrEfficiency,
                                 names::kDdrReadBytes,
                                 names::kDdrWriteBytes,
                                 "replay.time",
                                 "replay.bandwidth"};

/// Large on top of a single run's page.
constexpr std::array kTiles{names::kRate, names::kRemapTimeMean, names::kLatencyMean,
                            names::kDdrUtilisation};

std::string text_of(const app::StatRow& figure) {
  return app::human_text(figure.value, figure.unit);
}

double as_double(const app::StatRow& figure) {
  return std::visit([](auto v) { return static_cast<double>(v); }, figure.value);
}

bool missed(const Results& run) {
  for (const auto* name :
       {names::kRepeated, names::kDropped, names::kCaptureOverflows, names::kDisplayUnderflows})
    if (run.value(name).value_or(0) > 0) return true;
  return false;
}

std::string verdict_of(const Results& run) {
  std::string text = app::verdict(run.stats);
  while (!text.empty() && text.back() == '\n') text.pop_back();
  const bool frames = !text.empty();
  if (!frames)
    text = run.command == "replay" ? "A replay of a bus trace: it has no frames."
                                   : "No corrected frame was displayed.";
  if (frames) text[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(text[0])));
  const std::string_view kind = !frames ? "plain" : missed(run) ? "missed" : "met";
  std::string out = fmt::format("<p class=\"verdict {}\">{}{}</p>", kind,
                                kind == "met"      ? "<span aria-hidden=\"true\">&#10003;</span> "
                                : kind == "missed" ? "<span aria-hidden=\"true\">&#10007;</span> "
                                                   : "",
                                escaped(text));
  if (!run.complete)
    out +=
        "<p class=\"note\">These results are partial: the run was stopped before its end, or the "
        "guest failed. The figures cover what was simulated.</p>";
  for (const auto& w : run.warnings)
    out +=
        fmt::format("<p class=\"note\">Warning ({}){}: {}</p>", escaped(w.kind),
                    w.count > 1 ? fmt::format(", {} times", w.count) : "", escaped(explain::without_folders(w.what)));
  return out;
}

std::string tiles(const Results& run) {
  std::string out;
  static constexpr std::array kNames{"new pictures on the display", "remap of a frame, mean",
                                     "from capture to display, mean", "SDRAM data bus in use"};
  for (std::size_t i = 0; i < kTiles.size(); ++i)
    if (const auto* figure = app::find(run.stats, kTiles[i]))
      out += fmt::format("<div class=\"tile\"><b>{}</b><span>{}</span></div>", figure_cell(figure),
                         kNames[i]);
  return out.empty() ? "" : "<div class=\"tiles\">" + out + "</div>";
}

/// A figure's change for people. Counts stay whole numbers; a ratio changes by points, so that it
/// is not taken for the relative change.
std::string change_text(const app::StatRow& a, const app::StatRow& b) {
  const auto *before = std::get_if<std::uint64_t>(&a.value),
             *after = std::get_if<std::uint64_t>(&b.value);
  if (before && after)
    return *after > *before ? "+" + app::human_text(*after - *before, b.unit)
                            : "-" + app::human_text(*before - *after, b.unit);
  const double change = as_double(b) - as_double(a);
  if (b.unit == "ratio") return fmt::format("{:+.3g} points", 100 * change);
  return (change > 0 ? "+" : "-") + app::human_text(std::abs(change), b.unit);
}

/// "-1.2 ms (-4.1 %)"; empty where there is nothing to compare.
std::string difference_cell(const app::StatRow* a, const app::StatRow* b) {
  // A rounding error of a sum of doubles is no difference.
  constexpr double kRounding = 1e-12;
  if (!a || !b) return "";
  const double before = as_double(*a), change = as_double(*b) - before;
  if (std::abs(change) <= kRounding * std::abs(before)) return "<data value=\"0\">same</data>";
  std::string text = change_text(*a, *b);
  if (before != 0) text += fmt::format(" ({:+.3g} %)", 100 * change / std::abs(before));
  return fmt::format("<data value=\"{}\">{}</data>", app::number_text(change), escaped(text));
}

/// Escaped, and no line ends between a number and its unit.
std::string sentence(std::string_view text) {
  std::string out = escaped(text);
  for (std::size_t i = 1; i + 1 < out.size(); ++i)
    if (out[i] == ' ' && out[i - 1] >= '0' && out[i - 1] <= '9')
      for (const std::string_view unit : {"%", "ms", "us"})
        if (std::string_view(out).substr(i + 1).starts_with(unit)) {
          out.replace(i, 1, "&nbsp;");
          break;
        }
  return out;
}

std::string finding_item(const explain::Finding& f) {
  std::string evidence;
  for (const auto& e : f.evidence) evidence += fmt::format("<code>{}</code> ", escaped(e));
  return fmt::format("<li>{}<span class=\"evidence\">from {}</span></li>", sentence(f.text), evidence);
}

std::string finding_list(const std::vector<explain::Finding>& findings) {
  if (findings.empty()) return absent("The figures of this run lead to no finding.");
  std::string out;
  for (const auto& f : findings) out += finding_item(f);
  return "<ul class=\"findings\">" + out + "</ul>";
}

/// What the figures say, in sentences: differences first.
std::string findings(const Runs& runs) {
  std::string out = runs.size() == 1 ? "<h3>What the figures say</h3>" : "";
  for (std::size_t i = 1; i < runs.size(); ++i) {
    const auto found = differences_of(runs, i);
    if (!found.empty())
      out += fmt::format("<h3>{} against A</h3>", run_label(i)) + finding_list(found);
  }
  out += panels(runs, [&](std::size_t i) { return finding_list(findings_of(runs[i])); });
  const std::string command = binds_command_of(runs.front());
  if (command.empty()) return out;
  return out + fmt::format(
                   "<p class=\"note\">A wait is where clocks went. Whether more speed at that place makes the remap "
                   "faster, runs show in which only that is changed: <code>{}</code></p>",
                   escaped(command));
}

std::string picture_html(const Picture& picture, const std::string& what) {
  return fmt::format("<img src=\"{}\" width=\"{}\" height=\"{}\" alt=\"{}\">", picture.uri,
                     picture.width, picture.height, escaped(what));
}

std::string shrunk_note(const Picture& picture) {
  return picture.shrunk == 1 ? ""
                             : fmt::format(" Shown at 1/{} of its {} x {} pixels.", picture.shrunk,
                                           picture.width, picture.height);
}

/// Two pictures over one another, which the script's controls uncover.
std::string compared(const std::string& id, const Picture& a, const std::string& name_a,
                     const Picture& b, const std::string& name_b, std::string_view sentence) {
  return fmt::format(
      "<figure class=\"compare\" id=\"{}\" data-a=\"{}\" "
      "data-b=\"{}\"><figcaption>{}{}</figcaption>"
      "<div class=\"stack\"><div class=\"one\">{}</div><div class=\"two\">{}</div></div></figure>",
      id, escaped(name_a), escaped(name_b), escaped(sentence), shrunk_note(b),
      picture_html(a, name_a), picture_html(b, name_b));
}

std::string pictures_of(const Runs& runs, std::size_t i, const RunPictures& p) {
  const std::string id = fmt::format("pictures-{}", run_label(i));
  if (!p.after)
    return absent(
        "This run has no pictures (frames/): it displayed none, or --no-frames left them out.");
  const std::string frame = fmt::format("Frame {}", *p.frame);
  if (!p.cameras.empty()) {
    std::string out = fmt::format(
        "<figure id=\"{}\"><figcaption>{}: the composed view on the display. Below it, what was sent last for each "
        "camera.{}</figcaption>"
        "<div class=\"stack\"><div class=\"one\">{}</div></div></figure><div class=\"cameras\">",
        id, frame, shrunk_note(*p.after), picture_html(*p.after, "display"));
    for (const auto& c : p.cameras)
      out += fmt::format("<figure><figcaption>Camera {}, for frame {}.{}</figcaption>{}</figure>", c.camera, c.frame,
                         shrunk_note(c.picture), picture_html(c.picture, fmt::format("what camera {} sent", c.camera)));
    return out + "</div>";
  }
  if (p.before)
    return compared(id, *p.before, "camera", *p.after, "display",
                    frame + ": what the camera sent, and the corrected picture on the display.");
  return fmt::format(
             "<figure id=\"{}\"><figcaption>{}: the corrected picture on the "
             "display.{}</figcaption>"
             "<div class=\"stack\"><div class=\"one\">{}</div></div></figure>",
             id, frame, shrunk_note(*p.after), picture_html(*p.after, "display")) +
         absent(
             "What the camera sent is not in this folder (camera/), so there is no comparison with "
             "it.");
}

std::string picture_difference(const Runs& runs, std::size_t i,
                               const std::vector<RunPictures>& all) {
  const auto& p = all[i];
  if (!p.from_first || !all[0].after || !p.after) return "";
  const auto& d = *p.from_first;
  const std::string names = fmt::format("{} and {}", title_of(runs, 0), title_of(runs, i));
  if (d.pixels == 0)
    return absent(
        fmt::format("The displayed frames {} of {} are equal, pixel for pixel.", *p.frame, names));
  const std::string share =
      fmt::format("{:.3g}", 100.0 * static_cast<double>(d.pixels) / static_cast<double>(d.all));
  return compared(fmt::format("difference-{}", run_label(i)), *all[0].after, run_label(0), *p.after,
                  run_label(i),
                  fmt::format("Frame {} of {}: {} of {} pixels differ ({} %), PSNR {:.1f} dB.",
                              *p.frame, names, d.pixels, d.all, share, d.psnr));
}

}  // namespace

std::string title_of(const Runs& runs, std::size_t index) {
  return runs.size() == 1 ? runs[index].name
                          : fmt::format("{}: {}", run_label(index), runs[index].name);
}

std::string figure_cell(const app::StatRow* figure) {
  if (!figure) return "";
  return fmt::format("<data data-figure=\"{}\" value=\"{}\">{}</data>", escaped(figure->name),
                     app::number_text(figure->value), escaped(text_of(*figure)));
}

std::string panels(const Runs& runs, const std::function<std::string(std::size_t)>& inside) {
  std::string out;
  for (std::size_t i = 0; i < runs.size(); ++i) {
    out += "<div class=\"panel\">";
    if (runs.size() > 1) out += fmt::format("<h3>{}</h3>", escaped(title_of(runs, i)));
    out += inside(i) + "</div>";
  }
  return fmt::format("<div class=\"panels\">{}</div>", out);
}

std::string chart(std::string_view kind, std::size_t run, std::string_view sentence) {
  return fmt::format(
      "<figure class=\"chart\"><figcaption>{}</figcaption>"
      "<div data-chart=\"{}\" data-run=\"{}\"></div></figure>",
      escaped(sentence), kind, run);
}

std::string absent(std::string_view sentence) {
  return fmt::format("<p class=\"absent\">{}</p>", escaped(sentence));
}

Table::Table(std::string caption, std::vector<std::string> headings)
    : caption_(std::move(caption)), headings_(std::move(headings)) {}

void Table::row(const std::vector<std::string>& cells) {
  rows_ += "<tr>";
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const bool is_number = headings_[i].starts_with('#');
    rows_ += i == 0 ? "<th scope=\"row\">" + cells[i] + "</th>"
                    : fmt::format("<td{}>{}</td>", is_number ? " class=\"n\"" : "", cells[i]);
  }
  rows_ += "</tr>\n";
}

std::string Table::html() const {
  std::string head;
  for (const auto& h : headings_) {
    const bool is_number = h.starts_with('#');
    head += fmt::format("<th scope=\"col\"{}>{}</th>", is_number ? " class=\"n\"" : "",
                        escaped(is_number ? h.substr(1) : h));
  }
  return fmt::format(
      "<div class=\"scroll\" tabindex=\"0\" role=\"group\" aria-label=\"{}\"><table>"
      "<caption>{}</caption><thead><tr>{}</tr></thead><tbody>\n{}</tbody></table></div>",
      escaped(caption_), escaped(caption_), head, rows_);
}

std::vector<explain::FunctionClocks> functions_of(const Results& run) {
  if (!run.profile) return {};
  const bool frames = std::any_of(run.profile->begin(), run.profile->end(),
                                  [](const ProfileRow& r) { return r.phase == "frames"; });
  std::map<std::string, explain::FunctionClocks> sums;
  for (const auto& r : *run.profile) {
    if (frames && r.phase != "frames" && r.phase != "remap") continue;
    explain::FunctionClocks& f = sums[r.function];
    f.name = r.function;
    f.clocks += static_cast<double>(r.clocks);
    f.causes[r.cause] += static_cast<double>(r.clocks);
  }
  std::vector<explain::FunctionClocks> out;
  for (auto& [name, f] : sums) out.push_back(std::move(f));
  return out;
}

/// Refers to `run` and `functions`.
static explain::Inputs inputs_of(const Results& run,
                                 std::span<const explain::FunctionClocks> functions) {
  explain::Inputs in{.stats = run.stats, .stalls = {}, .frames = {}, .functions = functions};
  if (run.stalls) in.stalls = *run.stalls;
  if (run.frames) in.frames = *run.frames;
  in.parameter = [&run](std::string_view key) {
    const auto* p = run.parameter(key);
    return p ? p->value : std::string();
  };
  return in;
}

std::vector<explain::Finding> findings_of(const Results& run) {
  const auto functions = functions_of(run);
  std::vector<explain::Finding> out = explain::explain(inputs_of(run, functions));
  for (auto& f : binds_findings(run.binds)) out.push_back(std::move(f));
  return out;
}

std::vector<explain::Finding> differences_of(const Runs& runs, std::size_t index) {
  return explain::explain_difference(inputs_of(runs[0], {}), run_label(0),
                                     inputs_of(runs[index], {}), run_label(index));
}

std::string verdict_section(const Runs& runs) {
  std::string out = panels(runs, [&](std::size_t i) { return verdict_of(runs[i]); });
  if (runs.size() == 1) out += tiles(runs[0]);
  return out + findings(runs);
}

std::string key_section(const Runs& runs) {
  std::vector<std::string> headings{"Figure"};
  for (std::size_t i = 0; i < runs.size(); ++i) {
    headings.push_back("#" + (runs.size() == 1 ? "Value" : title_of(runs, i)));
    if (i > 0) headings.push_back(fmt::format("#{} - A", run_label(i)));
  }
  headings.push_back("Meaning");
  Table table("Key figures of the measured window", headings);
  for (const char* name : kKeyFigures) {
    const app::StatRow* first = nullptr;
    std::vector<std::string> cells{fmt::format("<code>{}</code>", name)};
    for (std::size_t i = 0; i < runs.size(); ++i) {
      const auto* figure = app::find(runs[i].stats, name);
      if (!first) first = figure;
      cells.push_back(figure_cell(figure));
      if (i > 0) cells.push_back(difference_cell(app::find(runs[0].stats, name), figure));
    }
    if (!first) continue;
    cells.push_back(escaped(first->description));
    table.row(cells);
  }
  return table.html();
}

std::string pictures_section(const Runs& runs, const std::vector<RunPictures>& pictures) {
  std::string out = panels(runs, [&](std::size_t i) { return pictures_of(runs, i, pictures[i]); });
  for (std::size_t i = 1; i < runs.size(); ++i) out += picture_difference(runs, i, pictures);
  return out;
}

std::string figures_section(const Runs& runs) {
  std::vector<std::string> headings{"Figure"};
  for (std::size_t i = 0; i < runs.size(); ++i) {
    headings.push_back("#" + (runs.size() == 1 ? "Value" : title_of(runs, i)));
    if (i > 0) headings.push_back(fmt::format("#{} - A", run_label(i)));
  }
  headings.push_back("Meaning");
  Table table("All figures that are not zero", headings);
  std::vector<const app::StatRow*> rows;
  for (const auto& run : runs)
    for (const auto& s : run.stats)
      if (as_double(s) != 0 &&
          std::none_of(rows.begin(), rows.end(), [&](const auto* r) { return r->name == s.name; }))
        rows.push_back(&s);
  for (const auto* row : rows) {
    std::vector<std::string> cells{fmt::format("<code>{}</code>", escaped(row->name))};
    for (std::size_t i = 0; i < runs.size(); ++i) {
      const auto* figure = app::find(runs[i].stats, row->name);
      cells.push_back(figure_cell(figure));
      if (i > 0) cells.push_back(difference_cell(app::find(runs[0].stats, row->name), figure));
    }
    cells.push_back(escaped(row->description));
    table.row(cells);
  }
  return "<details><summary>Show the table</summary>" + table.html() + "</details>";
}

}  // namespace fovea::report
