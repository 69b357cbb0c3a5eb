#include "model/cpu/core/stalls.h"

namespace fovea::cpu {
namespace {

constexpr std::array kRows = {
#define FOVEA_ROW(constant, name, sentence, label, waits_for, others) \
  CauseInfo{Cause::constant, name, sentence, label, waits_for, others},
    FOVEA_STALL_CAUSES(FOVEA_ROW)
#undef FOVEA_ROW
};

}  // namespace

constinit const std::span<const CauseInfo> kCauseTable = kRows;

}  // namespace fovea::cpu
