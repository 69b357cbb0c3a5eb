#include "model/engine/backends.h"

#include <array>

#include "model/common/check.h"
#include "model/engine/core/tlm_backend.h"
#ifdef FOVEA_ENGINE_RTL
#include "model/engine/rtl/pair_backend.h"
#include "model/engine/rtl/rtl_backend.h"
#endif

namespace fovea::engine {
#ifdef FOVEA_ENGINE_RTL
namespace {

rtl::Waves waves_of(const EngineParams& p) {
  using Trigger = rtl::Waves::Trigger;
  constexpr std::array kTriggers{Trigger::kBusy, Trigger::kJob, Trigger::kInterrupt, Trigger::kError};
  const Picoseconds length = p.waves_length();
  return {.file = p.waves_file(),
          .trigger = kTriggers[p.waves_trigger.index()],
          .skip = static_cast<std::uint64_t>(p.waves_skip()),
          .from = p.waves_from(),
          .length = length ? length : kNever};
}

}  // namespace
#endif

namespace {

/// @throws UserError for sizes that the RTL is not built with
[[maybe_unused]] void require_built_sizes(const EngineParams& params) {
  for (const ParamBase* p :
       {static_cast<const ParamBase*>(&params.cache), static_cast<const ParamBase*>(&params.prefetch)})
    if (p->text() != p->default_text())
      throw UserError("key '" + p->key() + "': the RTL is built with " + p->default_text() +
                      " alone; engine=tlm takes '" + p->text() + "'");
}

}  // namespace

std::unique_ptr<EngineBackend> make_backend(const EngineParams& params, const Clock& clock,
                                            EngineBackend::Host& host, [[maybe_unused]] Comparison comparison) {
  const Geometry geometry{.log_lines = params.log_cache_lines(),
                          .prefetch = static_cast<unsigned>(params.prefetch())};
  const auto tlm = [&clock, geometry](EngineBackend::Host& h) {
    return std::make_unique<TlmBackend>(clock, h, geometry);
  };
  // Without an engine nothing runs: the block is made to print its registers.
  if (params.kind.is("tlm") || params.kind.is("none")) return tlm(host);
#ifdef FOVEA_ENGINE_RTL
  require_built_sizes(params);
  const auto recorded = std::make_shared<rtl::RtlBackend*>(nullptr);  // belongs to the backend that is returned
  const auto rtl = [&](EngineBackend::Host& h) {
    auto made = std::make_unique<rtl::RtlBackend>(h, clock, rtl::RtlBackend::Options{.waves = waves_of(params)});
    *recorded = made.get();
    return made;
  };
  if (params.kind.is("rtl")) return rtl(host);
  const bool rtl_owns = params.kind.is("both");
  const auto differ = [recorded, say = std::move(comparison.on_difference)](const std::string& what, Picoseconds at) {
    (*recorded)->finish_at(at + kPsPerUs);
    say(what);
  };
  const rtl::PairBackend::Maker as_rtl = rtl, as_tlm = tlm;
  auto pair = std::make_unique<rtl::PairBackend>(host, clock, rtl_owns ? as_rtl : as_tlm, rtl_owns ? as_tlm : as_rtl,
                                                 differ);
  pair->on_compared = std::move(comparison.on_equal);
  pair->on_skipped = std::move(comparison.on_skipped);
  pair->planted = planted_difference;
  return pair;
#endif
  throw UserError("key 'engine': '" + params.kind() +
                  "' needs Verilator, which was missing when this program was built; allowed: none, tlm");
}

}  // namespace fovea::engine
