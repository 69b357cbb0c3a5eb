// The same functions and objects under other names, in two attributions.
#pragma once
#include <string>
#include <vector>

#include "sw/fovea/compare/attribution.h"

namespace fovea::regression {

/// `before` with the names that its functions and objects have in `after`. A function that is gone is the same as one
/// that is new if they have the same code, or the same name in another file, or if they alone are gone and new in
/// their file. An object that is gone is the same as a new one of its
/// size, if they are at one address or no others of this size are gone or new.
Attribution with_names_of(const Attribution& before, const Attribution& after);

/// Objects that lie elsewhere, by the distance: "frame_out moved by +4,096 bytes", "lut and 3 more moved by ...". Empty
/// if none does. Both have the same names.
std::string moved_objects_text(const Attribution& before, const Attribution& after);

/// Whether a function has other code; `known` is false if that cannot be told. One that only one run executes has not:
/// it is the caller that changed.
struct CodeChange {
  bool known = false, changed = false;
};
CodeChange code_change(const Attribution& before, const Attribution& after, const FunctionKey& key);

}  // namespace fovea::regression
