// A set of the parameter RAM (PaRAM): fields, classes of sets, and what a transfer leaves behind.
// Field positions: Linux drivers/dma/ti/edma.c; meaning: SPRUEE4A, SPRUH82C (EDMA3 of sister chips).
#pragma once
#include <array>
#include <cstdint>

#include "model/common/transfer_request.h"

namespace fovea::dma {

inline constexpr unsigned kParamWords = 8;
/// Words of a set.
enum ParamWord : unsigned { kOpt, kSrc, kAbCnt, kDst, kBidx, kLinkReload, kCidx, kCcnt };

struct ParamSet {
  std::array<std::uint32_t, kParamWords> word{};

  static constexpr std::uint32_t kSourceConstant = 1u << 0, kDestinationConstant = 1u << 1;
  static constexpr std::uint32_t kSyncAb = 1u << 2, kStatic = 1u << 3, kEarly = 1u << 11;
  static constexpr std::uint32_t kFinalInterrupt = 1u << 20, kIntermediateInterrupt = 1u << 21,
                                 kFinalChain = 1u << 22, kIntermediateChain = 1u << 23;
  static constexpr std::uint32_t kNoLink = 0xFFFF;

  static constexpr unsigned kWidest = 5;  ///< largest FWID: 256 bits; 6 and 7 are reserved

  bool opt(std::uint32_t bit) const { return word[kOpt] & bit; }
  unsigned width() const { return word[kOpt] >> 8 & 7; }  ///< FWID: 8 << n bits
  unsigned tcc() const { return word[kOpt] >> 12 & 0x3F; }
  std::uint32_t acnt() const { return word[kAbCnt] & 0xFFFF; }
  std::uint32_t bcnt() const { return word[kAbCnt] >> 16; }
  std::uint32_t ccnt() const { return word[kCcnt] & 0xFFFF; }
  std::uint32_t link() const { return word[kLinkReload] & 0xFFFF; }
  std::uint32_t bcnt_reload() const { return word[kLinkReload] >> 16; }

  /// All counts 0: nothing to transfer, an error. One of them 0: a legal transfer of no bytes.
  bool null() const { return !acnt() && !bcnt() && !ccnt(); }
  bool dummy() const { return !null() && (!acnt() || !bcnt() || !ccnt()); }
  /// The next request exhausts the set: it is the final one.
  bool final() const {
    return null() || dummy() || (ccnt() == 1 && (opt(kSyncAb) || bcnt() == 1));
  }

  /// The next transfer request: one array (A-synchronised) or one frame of BCNT arrays. For a set that
  /// is neither null nor dummy.
  TransferRequest request() const;
  /// Counts and addresses after a request that was not the final one.
  void advance();
  /// What a link to 0xFFFF leaves: a null set.
  static ParamSet unlinked() {
    ParamSet s;
    s.word[kLinkReload] = kNoLink;
    return s;
  }

  bool operator==(const ParamSet&) const = default;

 private:
  void move(ParamWord index);
};

}  // namespace fovea::dma
