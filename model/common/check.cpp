#include "model/common/check.h"

#include <cstdio>
#include <cstdlib>

namespace fovea {

void check_failed(const char* expression, const char* file, int line, const std::string& what) {
  std::fprintf(stderr, "fovea: own defect: %s (%s) at %s:%d\n", what.c_str(), expression, file,
               line);
  std::fflush(nullptr);
  // quick_exit runs no destructors, which could fail on the inconsistent state. Status 4 is
  // documented.
  std::quick_exit(4);
}

Diagnostics& Diagnostics::instance() {
  static Diagnostics d;
  return d;
}

void Diagnostics::not_modelled(const std::string& what) {
  note(Kind::kNotModelled, what);
  if (strict_) throw NotModelled("not modelled: " + what);
}

void Diagnostics::configuration(const std::string& what) {
  if (strict_) throw UserError(what);
  note(Kind::kConfiguration, what);
}

void Diagnostics::note(Kind kind, const std::string& what) {
  using Show = BoundedCounts::Show;
  const Show show = counts_.add(static_cast<unsigned>(kind), what);
  if (show == Show::kNothing || !sink_) return;
  if (show == Show::kText) sink_(kind, what);
  if (show == Show::kLastOfKind) sink_(kind, what + " (others like this one are only counted)");
  if (show == Show::kNoMore) sink_(kind, "warnings of further kinds are only counted");
}

std::map<std::pair<Diagnostics::Kind, std::string>, std::uint64_t> Diagnostics::counts() const {
  std::map<std::pair<Kind, std::string>, std::uint64_t> counts;
  for (const auto& line : counts_.list())
    counts[{static_cast<Kind>(line.group), line.text}] += line.count;
  return counts;
}

}  // namespace fovea
