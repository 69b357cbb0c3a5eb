#include "sw/fovea/report/binds.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "model/common/check.h"
#include "sw/fovea/explain/words.h"
#include "sw/fovea/files/checked_file.h"
#include "sw/fovea/report/html.h"
#include "sw/fovea/report/results.h"
#include "sw/fovea/report/sections.h"
#include "sw/fovea/results/csv.h"

namespace fovea::report {
namespace {

std::optional<double> number_or_nothing(const results::CsvPlace& place, const std::string& field) {
  if (field.empty()) return std::nullopt;
  return results::number(place, field);
}

/// "assumed: 25 % to 57 %", of parameters whose figures are not public.
std::string belief(const Relaxed& r) {
  if (r.origin != "assumed" && r.origin != "family") return "";
  if (!r.gain_low || !r.gain_high) return r.origin;
  return fmt::format("{}: {} to {}", r.origin, explain::percent(*r.gain_low), explain::percent(*r.gain_high));
}

/// A double is written with as many digits as it takes to be read back.
bool same(double a, double b) { return std::abs(a - b) <= 1e-12 * std::abs(b); }

}  // namespace

std::vector<Relaxed> load_binds(const std::filesystem::path& folder, const Results& run) {
  const std::filesystem::path file = folder / "binds.csv";
  const std::string name = app::one_line(folder.string());
  std::error_code error;
  if (!std::filesystem::exists(file, error))
    throw UserError(
        fmt::format("--limits '{}': it has no binds.csv; allowed: a folder of 'fovea limits --binds'", name));
  static constexpr std::array<std::string_view, 14> kColumns{
      "resource", "binds", "metric",   "unit",      "by",      "settings", "remark",
      "gain",     "plain", "reference", "relaxed", "origin", "gain_low", "gain_high"};
  std::vector<Relaxed> out;
  std::optional<std::pair<std::string, double>> other;  // a figure of another run
  results::each_csv_row(file, kColumns, [&](const results::CsvPlace& at, std::span<const std::string> f) {
    Relaxed r{f[0],
              f[1],
              f[2],
              f[3],
              f[4],
              f[5],
              f[6],
              number_or_nothing(at, f[7]),
              number_or_nothing(at, f[8]),
              number_or_nothing(at, f[9]),
              number_or_nothing(at, f[10]),
              f[11],
              number_or_nothing(at, f[12]),
              number_or_nothing(at, f[13])};
    if (!r.plain) return;
    const auto own = run.value(r.metric);
    if (own && same(*r.plain, *own))
      out.push_back(std::move(r));
    else
      other = {r.metric, *r.plain};
  });
  if (out.empty() && other) {
    const auto own = run.value(other->first);
    throw UserError(fmt::format("--limits '{}': it is about runs with {} = {}, '{}' has {}; allowed: answers about the "
                                "same experiment with the same settings",
                                name, app::one_line(other->first, 60), other->second,
                                app::one_line(run.folder.string()), own ? fmt::format("{}", *own) : "no such figure"));
  }
  return out;
}

std::vector<explain::Finding> binds_findings(const std::vector<Relaxed>& rows) {
  std::map<std::string, std::vector<const Relaxed*>> by_metric;
  for (const Relaxed& r : rows) by_metric[r.metric].push_back(&r);
  std::vector<explain::Finding> out;
  for (const auto& [metric, of] : by_metric) {
    std::vector<std::string> binding;
    std::size_t tried = 0;
    for (const Relaxed* r : of) {
      tried += r->gain.has_value();
      if (r->binds == "yes" && r->gain)
        binding.push_back(fmt::format("{} ({} better{}{})", r->resource, explain::percent(*r->gain),
                                      belief(*r).empty() ? "" : "; ", belief(*r)));
    }
    if (tried == 0) continue;
    const std::string others = fmt::format("{} of the {} resources that were relaxed", tried - binding.size(), tried);
    out.push_back(
        {"binds",
         binding.empty()
             ? fmt::format("Nothing binds {}: none of the {} resources makes it more than 2 % better if it "
                           "is relaxed alone.",
                           metric, tried)
             : fmt::format("What binds {}, as runs show in which it alone is relaxed: {}; {} change it by less.",
                           metric, fmt::join(binding, ", "), others),
         {"binds.csv"}});
  }
  return out;
}

std::string binds_section(const Runs& runs) {
  const std::vector<Relaxed>& rows = runs.front().binds;
  if (rows.empty()) return {};
  Table table("Resources that were relaxed, one at a time; one binds if the figure gets more than 2 % better",
              {"Resource", "Binds", "#Better by", "Figure", "#Before", "#Relaxed", "By", "Settings", "Believed"});
  const auto cell = [](const std::optional<double>& v, const std::string& unit) {
    return v ? fmt::format("<data value=\"{}\">{}</data>", app::number_text(*v), escaped(app::human_text(*v, unit)))
             : std::string("-");
  };
  for (const Relaxed& r : rows)
    table.row({escaped(r.resource), r.binds.empty() ? escaped(r.remark) : escaped(r.binds), cell(r.gain, "ratio"),
               fmt::format("<code>{}</code>", escaped(r.metric)), cell(r.reference, r.unit), cell(r.relaxed, r.unit),
               escaped(r.by), fmt::format("<code>{}</code>", escaped(r.settings)), escaped(belief(r))});
  return table.empty() ? absent("No resource was relaxed.") : table.html();
}

}  // namespace fovea::report
