// What this core does with UNPREDICTABLE forms: where the behaviour of an ARM9E core is known, that
// (hardware tests of the ARM946E-S), otherwise what a plain data path does.
#include "model/cpu/core/isa.h"

namespace fovea::cpu {
namespace {

constexpr const char* kShifts = "data shift by register, compare";
constexpr const char* kProducts = "multiply, long multiply, dsp";
constexpr const char* kPcOperand = "an operand reads 8 ahead; a result is lost";
constexpr const char* kOld = "uses what the registers held before";

// clang-format off
constexpr IsaReaction kReactions[] = {
    {"d != 15", "data shift by register", "branches, as without the shift"},
    {"n != 15", kShifts, "reads 12 ahead"},
    {"m != 15", kShifts, "reads 12 ahead"},
    {"s != 15", kShifts, "reads 12 ahead"},
    {"d != 15", kProducts, kPcOperand},
    {"n != 15", kProducts, kPcOperand},
    {"m != 15", kProducts, kPcOperand},
    {"s != 15", kProducts, kPcOperand},
    {"d != 15", "saturate, clz", kPcOperand},
    {"n != 15", "saturate", kPcOperand},
    {"m != 15", "saturate, clz", kPcOperand},
    {"n != m", "multiply, long multiply, thumb multiply", kOld},
    {"d != m", "long multiply", kOld},
    {"n != d", "long multiply, dsp", "keeps the upper half of the result"},
    {"d != 15", "status", "the result is lost"},
    {"m != 15", "status", "reads 8 ahead"},
    {"f != 0", "status", "writes nothing"},
    {"n != 15", "load, store, narrow, double", "the address is relative to 8 ahead; no write-back"},
    {"n != d", "load, narrow, double", "a loaded value goes before the write-back; a stored one is the old one"},
    {"n != d", "store", "stores the old value"},
    {"n != d+1", "double", "a loaded value goes before the write-back; a stored one is the old one"},
    {"d != 15", "load", "LDRT branches as LDR does; a byte is lost"},
    {"d != 15", "store", "stores 12 ahead"},
    {"d != 15", "narrow", "a loaded value is lost; stores 12 ahead"},
    {"m != 15", "load, store, narrow, double", "the offset reads 8 ahead"},
    {"n != m", "load, store, narrow, double", "the base moves by its old value"},
    {"d != 14", "double", "the second word is the pc's: it branches; stores 12 ahead"},
    {"m != d", "double", kOld},
    {"m != d+1", "double", kOld},
    {"n != 15", "block", "the base is 8 ahead; the moved one is lost"},
    {"l != 0", "block, thumb block", "transfers nothing; the base moves by 16 words"},
    {"n not in l", "block", "the moved base stays, unless the base is the last of several"},
    {"n first in l", "block, thumb block", "stores the old base"},
    {"W = 0", "block", "the base of the present mode moves"},
    {"n != 15", "swap", "the address is 8 ahead"},
    {"m != 15", "swap", "stores 8 ahead"},
    {"d != 15", "swap", "the loaded value is lost"},
    {"n != m", "swap", kOld},
    {"n != d", "swap", kOld},
    {"m != 15", "preload", "nothing, as always"},
    {"m != 15", "branch", "goes 8 ahead"},
    {"m != 15", "thumb branch", "goes to ARM code 4 ahead, of a multiple of 4"},
    {"c = 14", "exception", "obeys the condition"},
    {"d != 15", "coprocessor", "CP15 gets 12 ahead; others are undefined"},
    {"n != 15", "coprocessor", "undefined"},
    {"n != d", "coprocessor", "undefined"},
    {"d or m > 7", "thumb high", "as with a high register"},
    {"n or m > 7", "thumb high", "as with a high register"},
    {"n != 15", "thumb high", "reads 4 ahead"},
};
// clang-format on

}  // namespace

std::span<const IsaReaction> isa_reactions() { return kReactions; }

}  // namespace fovea::cpu
