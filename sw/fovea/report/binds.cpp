#include "sw/fovea/report/binds.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "model/common/check.h"
#include "sw/fovea/checked_file.h"
#include "sw/fovea/explain/words.h"
#include "sw/fovea/report/csv.h"
#include "sw/fovea/report/html.h"
#include "sw/fovea/report/results.h"
#include "sw/fovea/report/sections.h"

namespace fovea::report {
namespace {

constexpr std::size_t kMaxBytes = 16u << 20;

std::optional<double> number_or_nothing(const CsvPlace& place, const std::string& field) {
  if (field.empty()) return std::nullopt;
  return number(place, field);
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
  std::map<std::string, std::size_t> columns;
  std::vector<Relaxed> out;
  std::optional<std::pair<std::string, double>> other;  // a figure of another run
  each_csv_record(file, app::read_file(file, kMaxBytes),
                  [&](const CsvPlace& place, std::span<const std::string> fields) {
                    const auto refuse = [&](const std::string& why) {
                      throw UserError(fmt::format("{}:{}: {}", app::one_line(file.string()), place.line, why));
                    };
                    if (columns.empty()) {
                      for (std::size_t i = 0; i < fields.size(); ++i) columns[fields[i]] = i;
                      for (const char* column : {"resource", "binds", "gain", "metric", "plain", "reference", "relaxed",
                                                 "unit", "by", "settings", "remark", "origin", "gain_low", "gain_high"})
                        if (!columns.contains(column)) refuse(fmt::format("there is no column '{}'", column));
                      return;
                    }
                    if (fields.size() != columns.size())
                      refuse(fmt::format("{} fields; the header has {}", fields.size(), columns.size()));
                    const auto text = [&](const char* column) { return fields[columns.at(column)]; };
                    Relaxed r{text("resource"),
                              text("binds"),
                              text("metric"),
                              text("unit"),
                              text("by"),
                              text("settings"),
                              text("remark"),
                              number_or_nothing(place, text("gain")),
                              number_or_nothing(place, text("plain")),
                              number_or_nothing(place, text("reference")),
                              number_or_nothing(place, text("relaxed")),
                              text("origin"),
                              number_or_nothing(place, text("gain_low")),
                              number_or_nothing(place, text("gain_high"))};
                    if (!r.plain) return;
                    const auto own = run.value(r.metric);
                    if (own && same(*r.plain, *own))
                      out.push_back(std::move(r));
                    else
                      other = {r.metric, *r.plain};
                  });
  if (columns.empty()) throw UserError(fmt::format("{}:1: the header is missing", app::one_line(file.string())));
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

std::string binds_section(const std::vector<Relaxed>& rows) {
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
