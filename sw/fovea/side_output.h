// Outputs beside the results: one that cannot be written does not take the results along.
#pragma once
#include <new>
#include <string>
#include <string_view>
#include <vector>

#include "model/common/check.h"

namespace fovea::app {

/// Calls `f`, which writes the output that `option` asks for. If the host refuses it (a full disk, no memory, an
/// encoder that has ended), the reason joins `lost` as a sentence, and the caller goes on with the results.
template <class F>
void side_output(std::vector<std::string>& lost, std::string_view option, F&& f) {
  try {
    f();
  } catch (const UserError& e) {
    lost.emplace_back(e.what());
  } catch (const std::bad_alloc&) {
    lost.push_back(std::string(option) + ": out of memory");
  }
}

}  // namespace fovea::app
