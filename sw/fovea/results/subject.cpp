#include "sw/fovea/results/subject.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "sw/fovea/files/checked_file.h"

namespace fovea::regression {

std::string_view subject_key(ResultKind kind) {
  return kind == ResultKind::kRun ? "experiment" : kind == ResultKind::kExec ? "program" : "trace";
}

std::string_view command_of(ResultKind kind) {
  return kind == ResultKind::kRun ? "run" : kind == ResultKind::kExec ? "exec" : "replay";
}

std::string Subject::text() const {
  std::string out = fmt::format("{} '{}", subject_key(kind), name);
  for (const auto& a : arguments) out += " " + a;
  out += "'";
  if (!options.empty()) out += fmt::format(" with {}", fmt::join(options, " "));
  return app::one_line(out);
}

std::string Subject::label() const {
  std::string out = name;
  for (const auto* words : {&arguments, &options})
    for (const auto& word : *words) out += " " + word;
  return app::one_line(out);
}

}  // namespace fovea::regression
