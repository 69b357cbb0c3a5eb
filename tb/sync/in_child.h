// One run in a process of its own (a second elaboration in one process fails), with or without a planted
// error of the horizon.
#pragma once
#include <functional>
#include <string>

#include "tb/e2e/in_child.h"
#include "tb/sync/late_horizon.h"

namespace fovea::sync {

/// What `run` returns, in a process in which every horizon is `late` by so much; empty if it failed. The
/// only place that plants the error.
inline std::string in_child(Picoseconds late, const std::function<std::string()>& run) {
  const test::ChildSays said = test::child_says([&] {
    planted_late_horizon = late;
    return run();
  });
  return said.ok ? said.text : "";
}

/// The first line in which two records differ; empty if they are equal.
inline std::string first_difference(const std::string& strict, const std::string& fast) {
  for (std::size_t line = 0; line < strict.size() && line < fast.size();) {
    const std::size_t es = strict.find('\n', line), ef = fast.find('\n', line);
    if (strict.substr(line, es - line) != fast.substr(line, ef - line))
      return "strict:  " + strict.substr(line, es - line) + "\ndefault: " + fast.substr(line, ef - line);
    line = es + 1;
  }
  return strict.size() == fast.size() ? "" : "one record is longer";
}

}  // namespace fovea::sync
