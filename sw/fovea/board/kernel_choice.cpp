#include "sw/fovea/board/kernel_choice.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <vector>

#include "model/common/check.h"
#include "model/contract/words.h"

namespace fovea::app {
namespace {

std::uint32_t kernel_code(const board::BoardParams& params) {
  return contract::code_of(contract::kKernels, params.firmware.kernel());
}

std::string_view word_of(std::uint32_t kernel) {
  for (const contract::Word& w : contract::kKernels)
    if (w.code == kernel) return w.word;
  return {};
}

bool needs_engine(const board::BoardParams& params) {
  return contract::facts_of(kernel_code(params)).mover == PARAM_BY_ENGINE;
}

/// The words of the engine's kernels, of those with a form for several sources if `views`.
std::vector<std::string_view> kernels_of_engine(bool views) {
  std::vector<std::string_view> out;
  for (const contract::KernelFacts& k : contract::kKernelFacts)
    if (k.mover == PARAM_BY_ENGINE && (k.views || !views)) out.push_back(word_of(k.code));
  return out;
}

/// What the program takes instead; empty: nothing is known against the kernel.
std::string_view replaced_by(const board::BoardParams& params) {
  const contract::KernelFacts& kernel = contract::facts_of(kernel_code(params));
  const bool missing = needs_engine(params) && !params.soc.engine.present();
  if (!params.firmware.view.is("single")) return missing || !kernel.views ? word_of(KERNEL_STRIPS) : "";
  return missing ? word_of(kernel.otherwise) : "";
}

}  // namespace

void check_kernel(const board::BoardParams& params) {
  if (!params.own_program()) return;
  const EnumParam &kernel = params.firmware.kernel, &view = params.firmware.view, &engine = params.soc.engine.kind;
  const DiagnosticsRef diagnostics = DiagnosticsRef::current();
  const std::string_view instead = replaced_by(params);
  const bool computes = needs_engine(params) && instead.empty();
  if (!instead.empty() && needs_engine(params) && !params.soc.engine.present())
    diagnostics.configuration(fmt::format("{}={} needs the remap engine, and {} = {}: the program takes {}",
                                          kernel.key(), kernel(), engine.key(), engine(), instead));
  else if (!instead.empty())
    diagnostics.configuration(
        fmt::format("{}={} has no form for several sources: with {}={} the program takes {}, as with fastest",
                    kernel.key(), kernel(), view.key(), view(), instead));
  if (params.soc.engine.present() && !computes)
    diagnostics.configuration(
        fmt::format("{}={} has nothing to do: {} = {} uses the core; kernels of the engine: {}", engine.key(), engine(),
                    kernel.key(), kernel(), fmt::join(kernels_of_engine(!view.is("single")), ", ")));
}

std::string kernel_that_ran(const board::BoardParams& params, std::string_view uart) {
  if (params.hosted) return {};
  constexpr std::string_view kLine = "kernel: ";
  std::vector<std::string> ran;
  while (!uart.empty()) {
    const std::string_view line = uart.substr(0, uart.find('\n'));
    uart.remove_prefix(std::min(line.size() + 1, uart.size()));
    if (!line.starts_with(kLine)) continue;
    std::string name(line.substr(kLine.size(), std::min(line.find(','), line.size()) - kLine.size()));
    if (contract::code_of(contract::kKernels, name) == ~0u) continue;
    if (std::ranges::find(ran, name) == ran.end()) ran.push_back(std::move(name));
  }
  const EnumParam& kernel = params.firmware.kernel;
  if (!ran.empty() && !kernel.is("fastest") && replaced_by(params).empty() &&
      std::ranges::find(ran, kernel()) == ran.end())
    DiagnosticsRef::current().configuration(fmt::format("{}={} was asked for, and {} ran; uart.log has the reason",
                                                        kernel.key(), kernel(), fmt::join(ran, ", ")));
  return fmt::format("{}", fmt::join(ran, ", "));
}

}  // namespace fovea::app
