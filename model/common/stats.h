// Statistics: each is declared with its unit and a description where it is counted.
#pragma once
#include <cstdint>
#include <functional>
#include <string>
#include <variant>
#include <vector>

#include "model/common/census.h"

namespace fovea {

class StatGroup;

/// A value in stats.json. Names are `<group>.<name>` in lower_snake and never change.
class StatBase {
 public:
  using Value = std::variant<std::uint64_t, double>;
  StatBase(StatGroup& group, std::string name, std::string unit, std::string sentence);
  virtual ~StatBase() = default;
  StatBase(const StatBase&) = delete;
  StatBase& operator=(const StatBase&) = delete;
  const std::string& name() const { return name_; }
  const std::string& unit() const { return unit_; }
  const std::string& sentence() const { return sentence_; }
  virtual Value value() const = 0;
  /// Called when the measurement window opens.
  virtual void reset() = 0;

 private:
  std::string name_, unit_, sentence_;
};

class Counter : public StatBase {
 public:
  using StatBase::StatBase;
  void operator+=(std::uint64_t n) { count_ += n; }
  void operator++() { ++count_; }
  std::uint64_t count() const { return count_; }
  Value value() const override { return count_; }
  void reset() override { count_ = 0; }

 private:
  std::uint64_t count_ = 0;
};

/// The largest value that was noted in the measurement window.
class Maximum : public StatBase {
 public:
  using StatBase::StatBase;
  void note(std::uint64_t v) { most_ = v > most_ ? v : most_; }
  Value value() const override { return most_; }
  void reset() override { most_ = 0; }

 private:
  std::uint64_t most_ = 0;
};

/// A value computed on request from counters, which are reset on their own.
class Formula : public StatBase {
 public:
  Formula(StatGroup& group, std::string name, std::string unit, std::string sentence,
          std::function<Value()> f)
      : StatBase(group, std::move(name), std::move(unit), std::move(sentence)), f_(std::move(f)) {}
  Value value() const override { return f_(); }
  void reset() override {}

 private:
  std::function<Value()> f_;
};

/// Log-linear histogram of durations in picoseconds: 256 buckets per factor of two (relative error
/// below 0.4 %); minimum, maximum and sum are exact.
class Histogram {
 public:
  void add(std::uint64_t v);
  void reset() { *this = Histogram(); }
  std::uint64_t count() const { return count_; }
  std::uint64_t min() const { return count_ ? min_ : 0; }
  std::uint64_t max() const { return max_; }
  double mean() const {
    return count_ ? static_cast<double>(sum_) / static_cast<double>(count_) : 0;
  }
  /// Upper edge of the bucket that holds the q-quantile (0 < q <= 1), but at most max(). 0 if
  /// empty.
  std::uint64_t quantile(double q) const;

 private:
  std::vector<std::uint64_t> buckets_;
  std::uint64_t count_ = 0, sum_ = 0, max_ = 0, min_ = ~std::uint64_t{0};
};

/// The statistics of a block; `prefix` is the block's dotted name.
class StatGroup : public Census<StatGroup> {
 public:
  explicit StatGroup(std::string prefix) : prefix_(std::move(prefix)) {}
  StatGroup(const StatGroup&) = delete;
  StatGroup& operator=(const StatGroup&) = delete;
  const std::string& prefix() const { return prefix_; }
  const std::vector<StatBase*>& stats() const { return stats_; }
  void reset() {
    for (auto* s : stats_) s->reset();
    on_reset();
  }

 protected:
  ~StatGroup() = default;
  /// Resets state that is not a StatBase (histograms, time integrals).
  virtual void on_reset() {}

 private:
  friend class StatBase;
  std::string prefix_;
  std::vector<StatBase*> stats_;
};

}  // namespace fovea
