#include "model/common/stats.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace fovea {
namespace {
constexpr unsigned kSubBits = 8;  // 256 buckets per factor of two
constexpr std::uint64_t kSubBuckets = 1u << kSubBits;

std::size_t bucket_of(std::uint64_t v) {
  if (v < kSubBuckets) return v;
  const unsigned exponent = static_cast<unsigned>(std::bit_width(v)) - 1 - kSubBits;
  return (static_cast<std::size_t>(exponent + 1) << kSubBits) +
         ((v >> exponent) & (kSubBuckets - 1));
}

std::uint64_t upper_edge(std::size_t bucket) {
  if (bucket < kSubBuckets) return bucket;
  const std::size_t exponent = (bucket >> kSubBits) - 1;
  return ((kSubBuckets + (bucket & (kSubBuckets - 1)) + 1) << exponent) - 1;
}
}  // namespace

StatBase::StatBase(StatGroup& group, std::string name, std::string unit, std::string sentence)
    : name_(group.prefix().empty() ? name : group.prefix() + "." + name),
      unit_(std::move(unit)),
      sentence_(std::move(sentence)) {
  group.stats_.push_back(this);
}

void Histogram::add(std::uint64_t v) {
  const std::size_t b = bucket_of(v);
  if (b >= buckets_.size()) buckets_.resize(b + 1);
  ++buckets_[b];
  ++count_;
  sum_ += v;
  max_ = std::max(max_, v);
  min_ = std::min(min_, v);
}

std::uint64_t Histogram::quantile(double q) const {
  const auto rank = static_cast<std::uint64_t>(std::ceil(q * static_cast<double>(count_)));
  std::uint64_t seen = 0;
  for (std::size_t b = 0; b < buckets_.size(); ++b) {
    seen += buckets_[b];
    if (seen >= rank && seen > 0) return std::min(upper_edge(b), max_);
  }
  return max_;
}

}  // namespace fovea
