#include "model/common/check.h"

#include <cstdio>
#include <cstdlib>
#include <utility>

namespace fovea {
namespace {

thread_local Diagnostics* current = nullptr;

}  // namespace

void check_failed(const char* expression, const char* file, int line, const std::string& what) {
  std::fprintf(stderr, "fovea: own defect: %s (%s) at %s:%d\n", what.c_str(), expression, file,
               line);
  std::fflush(nullptr);
  // quick_exit runs no destructors, which could fail on the inconsistent state. Status 4 is
  // documented.
  std::quick_exit(4);
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

Diagnostics::Counts Diagnostics::counts() const {
  Counts counts;
  for (const auto& line : counts_.list())
    counts[{static_cast<Kind>(line.group), line.text}] += line.count;
  return counts;
}

DiagnosticsRef DiagnosticsRef::current() { return fovea::current ? DiagnosticsRef(*fovea::current) : DiagnosticsRef(); }

DiagnosticsScope::DiagnosticsScope(Diagnostics& diagnostics)
    : own_(&diagnostics), outer_(std::exchange(current, &diagnostics)) {}

DiagnosticsScope::~DiagnosticsScope() {
  FOVEA_CHECK(current == own_, "the scopes of diagnostics end out of their order");
  current = outer_;
}

}  // namespace fovea
