// The largest additional load that an experiment bears on a port of the crossbar.
#pragma once
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "sw/fovea/limits/session.h"

namespace fovea::limits {

/// What the additional load looks like, apart from how much it is.
struct LoadShape {
  unsigned bytes = 64, slots = 4;
  std::string pattern = "sequential", kind = "read";
  double step = 20, most = 1400;  ///< MB/s (10^6 bytes/s)
};

/// Port and priority of a load; the priority is that of the port's register, or of the load itself.
struct LoadPlace {
  std::string port;
  unsigned priority = 0;
};

/// Rate n is n * step; the last one has no pauses and so is as much as the port takes. The load begins
/// with the first captured sample of the first displayed frame, so that start-up is as it was. A run that shows
/// no frame within a second after the time of the plain run's first one is a bad value.
class LoadSearch {
 public:
  LoadSearch(Session& session, const Settings& base, const LoadPlace& place, const LoadShape& shape,
             const std::string& group, const points::PointResult& plain, const ParamSet& params);

  ValueSearch& search() { return *search_; }
  const ValueSearch& search() const { return *search_; }
  const LoadPlace& place() const { return place_; }
  std::uint64_t last() const { return last_; }
  /// The largest load that is borne; nothing if not even none is, or nothing is known.
  std::optional<std::uint64_t> answer() const;
  /// "340 MB/s", or "as much as the port takes" for the last one: what is asked for.
  std::string rate_text(std::uint64_t n) const;
  /// MB/s that the load moved in the window of a point, from its statistics.
  double moved(std::uint64_t n) const;

 private:
  Settings settings(std::uint64_t n) const;
  std::string label(std::uint64_t n) const;
  LoadPlace place_;
  LoadShape shape_;
  std::string group_, start_;
  std::string start_limit_;  ///< as a setting
  double before_ = 0;  ///< bytes a second on that port without the load
  std::uint64_t last_;
  std::unique_ptr<ValueSearch> search_;
};

/// The first of load, load.1 ... that the experiment does not use. @throws UserError if all are used
std::string free_load(const ParamSet& params);

/// Traffic that a user may want to run beside the correction.
struct Demand {
  std::string name;
  double low, likely, high;  ///< MB/s; all the same if a document gives the figure
  std::string source;
};
const std::vector<Demand>& demands();

}  // namespace fovea::limits
