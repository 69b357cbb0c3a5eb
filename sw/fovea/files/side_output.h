// Outputs beside the results of a run: if one of them fails, the results are kept.
#pragma once
#include <new>
#include <string>
#include <string_view>
#include <vector>

#include "model/common/check.h"

namespace fovea::app {

/// Why outputs that were asked for are missing, one sentence for each. A run with any has status 2.
using LostOutputs = std::vector<std::string>;

/// Calls make(), which makes the output `name`. What the host lacks (memory, room on the disk) goes to `lost`; own
/// defects and requests to stop go on.
template <class F>
void side_output(std::string_view name, LostOutputs& lost, F make) {
  try {
    make();
  } catch (const UserError& e) {
    lost.push_back(std::string(name) + " is missing: " + e.what());
  } catch (const std::bad_alloc&) {
    lost.push_back(std::string(name) + " is missing: out of memory");
  }
}

}  // namespace fovea::app
