// Parameters of the EDMA. None of the clocks and sizes is public for this chip.
#pragma once
#include "model/common/param.h"

namespace fovea::dma {

struct EdmaParams : ParamGroup {
  using U = IntParam::Unit;
  IntParam reset_priority{*this,
                          "reset_priority",
                          U::kCount,
                          7,
                          0,
                          7,
                          "QUEPRI out of reset, for each queue; 0 highest",
                          Origin::kAssumed,
                          "no public figure; Linux writes 7, 7, 7, 0",
                          {"0", "7", "0 on some sister chips; firmware that cares writes QUEPRI"}};
  IntParam event_clocks{*this,
                        "event_clocks",
                        U::kCount,
                        2,
                        1,
                        64,
                        "clocks from an event's entry into its queue to its turn",
                        Origin::kAssumed,
                        "no public figure",
                        {"1", "8", "the hand-over from a queue to the logic that reads sets, or a few clocks more"}};
  IntParam request_clocks{*this,
                          "request_clocks",
                          U::kCount,
                          8,
                          1,
                          128,
                          "clocks from one transfer request to the next: reading, submitting and "
                          "updating a set of 8 words",
                          Origin::kAssumed,
                          "no public figure",
                          {"4", "24", "8 words at 1 to 3 clocks each; 4 if two words are read at once"}};
  IntParam completion_clocks{*this,
                             "completion_clocks",
                             U::kCount,
                             2,
                             1,
                             64,
                             "clocks from the last acknowledgement to the completion code",
                             Origin::kAssumed,
                             "no public figure",
                             {"1", "8", "a hand-over between two blocks on one clock"}};
  EdmaParams() : ParamGroup("edma") {}
};

struct EdmaTcParams : ParamGroup {
  using U = IntParam::Unit;
  IntParam burst{*this,
                 "burst",
                 U::kBytes,
                 32,
                 16,
                 64,
                 "default burst size of TC0, TC2 and TC3: 16, 32 or 64; TC1 has 32, or 64 with "
                 "MISC.TPTC1_BST (TI's register header)",
                 Origin::kAssumed,
                 "TC1's reset value",
                 {"16B", "64B", "a sister chip, C642x, has 16, 32 and 64 (TI EDMA3 LLD)"}};
  IntParam fifo{*this,
                "fifo",
                U::kBytes,
                256,
                128,
                512,
                "data FIFO; it must hold two bursts of 64 bytes",
                Origin::kFamily,
                "SPRUH82C: TCCFG.FIFOSIZE of AM1808, 128 or 256",
                {"128B", "256B", "AM1808 has 128 and 256, C6745 256"}};
  IntParam depth{*this,
                 "depth",
                 U::kCount,
                 4,
                 1,
                 4,
                 "destination registers: requests whose writes may be under way",
                 Origin::kFamily,
                 "SPRUH82C: TCCFG.DREGDEPTH of AM1808",
                 {"2", "4", "AM1808 has 4, AM335x 2 or 4"}};
  IntParam outstanding{*this,
                       "outstanding",
                       U::kCount,
                       4,
                       1,
                       16,
                       "reads, and writes, that may be under way at once",
                       Origin::kAssumed,
                       "no public figure; the data FIFO limits reads as well",
                       {"2", "16", "256 bytes of FIFO hold four bursts of 64 or sixteen of 16"}};
  EdmaTcParams() : ParamGroup("edma.tc") {}
};

}  // namespace fovea::dma
