#include "sw/fovea/limits/load_search.h"

#include <fmt/format.h>

#include <cmath>
#include <fstream>
#include <sstream>

#include "sw/fovea/files/checked_file.h"
#include "sw/fovea/results/names.h"

namespace fovea::limits {
namespace {

constexpr double kMega = 1e6;

/// The first captured sample of the first displayed frame, rounded to ns; "0ns" if that is not known.
std::string first_capture(const points::PointResult& plain) {
  std::ifstream file(plain.folder / "run" / "frames.csv");
  std::string header, row;
  if (!std::getline(file, header) || !std::getline(file, row)) return "0ns";
  std::istringstream names(header), cells(row);
  for (std::string name, cell; std::getline(names, name, ',') && std::getline(cells, cell, ',');)
    if (name == "capture_start_ns" && !cell.empty()) return cell.substr(0, cell.find('.')) + "ns";
  return "0ns";
}

/// A load may keep the firmware from showing any frame. Such a run need not wait for the experiment's own limit:
/// until this time after power-up, one second after the plain run's first frame. Empty: the experiment's own limit
/// is earlier, or there is nothing to go by.
std::string start_limit(const points::PointResult& plain, const ParamSet& params) {
  constexpr double kLater = 1;
  const auto* own = dynamic_cast<const IntParam*>(params.find("run.start_limit"));
  const auto first = plain.stat(names::kStartupFirstFrame);
  if (!own || !first || static_cast<double>((*own)()) * 1e-12 <= *first + kLater) return "";
  return fmt::format("run.start_limit={:.0f}ms", (*first + kLater) * 1e3);
}

double bytes_per_second(const points::PointResult& r, const std::string& port) {
  const double window = r.stat(names::kWindow).value_or(0);
  const double bytes = r.stat("bus." + port + ".read_bytes").value_or(0) +
                       r.stat("bus." + port + ".write_bytes").value_or(0);
  return window > 0 ? bytes / window : 0;
}

}  // namespace

LoadSearch::LoadSearch(Session& session, const Settings& base, const LoadPlace& place,
                       const LoadShape& shape, const std::string& group, const points::PointResult& plain,
                       const ParamSet& params)
    : place_(place), shape_(shape), group_(group), start_(first_capture(plain)),
      start_limit_(start_limit(plain, params)), before_(bytes_per_second(plain, place.port)),
      last_(static_cast<std::uint64_t>(std::ceil(shape.most / shape.step))),
      search_(std::make_unique<ValueSearch>(session, base, last_,
                                            [this](std::uint64_t n) { return settings(n); },
                                            [this](std::uint64_t n) { return label(n); })) {}

std::string LoadSearch::label(std::uint64_t n) const {
  if (n == 0) return "";
  return fmt::format("{} on port {}, priority {}", rate_text(n), place_.port, place_.priority);
}

Settings LoadSearch::settings(std::uint64_t n) const {
  if (n == 0) return {};
  const auto set = [&](const char* key, const auto& value) {
    return fmt::format("{}.{}={}", group_, key, value);
  };
  const std::string priority = place_.port == "load" ? set("priority", place_.priority)
                                                     : fmt::format("priority.{}={}", place_.port, place_.priority);
  // Each slot pauses behind its own burst; the burst's own time is not counted, so that the rate is
  // at most the one that is asked for.
  const double gap = shape_.slots * shape_.bytes / (static_cast<double>(n) * shape_.step * kMega) * 1e12;
  Settings out = {set("port", place_.port), priority, set("outstanding", shape_.slots)};
  if (n < last_) out.push_back(set("gap", fmt::format("{:.0f}ps", gap)));
  for (auto& s : {set("bytes", fmt::format("{}B", shape_.bytes)), set("pattern", shape_.pattern),
                  set("kind", shape_.kind), set("start", start_)})
    out.push_back(s);
  if (!start_limit_.empty()) out.push_back(start_limit_);
  return out;
}

std::string LoadSearch::rate_text(std::uint64_t n) const {
  if (n == last_) return "as much as the port takes";
  return fmt::format("{:g} MB/s", static_cast<double>(n) * shape_.step);
}

std::optional<std::uint64_t> LoadSearch::answer() const {
  if (search_->failure()) return std::nullopt;
  return search_->outcome().answer == Bisection::Answer::kAll ? std::optional(last_) : search_->answer();
}

double LoadSearch::moved(std::uint64_t n) const {
  return (bytes_per_second(search_->at(n).result, place_.port) - before_) / kMega;
}

std::string free_load(const ParamSet& params) {
  for (const char* group : {"load", "load.1", "load.2", "load.3"}) {
    const auto* p = dynamic_cast<const IntParam*>(params.find(std::string(group) + ".outstanding"));
    if (p && (*p)() == 0) return group;
  }
  throw UserError("--load: the experiment uses every synthetic load itself, or the program has none");
}

const std::vector<Demand>& demands() {
  // A macroblock row of references, the picture itself and its reconstruction go through the SDRAM:
  // 1.5 bytes a pixel in 4:2:0 for each pass over the picture.
  static const double pass = 720.0 * 576 * 25 * 1.5 / kMega;
  static const std::vector<Demand> all = {
      {"USB 2.0 at high speed, bulk", 53.248, 53.248, 53.248,
       "USB 2.0 specification 5.8.4: 13 x 512 bytes a microframe"},
      {"H.264 encoder, 720x576 at 25/s", 3 * pass, 5 * pass, 8 * pass,
       "assumed, no public figure: 5 passes over the picture of 1.5 bytes a pixel; belief: 3 (source read, "
       "reference read and reconstruction written once) to 8 (references read several times)"}};
  return all;
}

}  // namespace fovea::limits
