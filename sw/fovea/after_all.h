// The rank of what happens after every master's acts of an instant.
#pragma once
#include "model/common/masters.h"

namespace fovea::app {

/// For EndOfInstant::at(): masters have the ranks below.
inline constexpr unsigned kAfterAll = static_cast<unsigned>(kMasterCount);

}  // namespace fovea::app
