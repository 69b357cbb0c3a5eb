#include "state.h"

#define USED_IN(section_name) __attribute__((used, section(section_name)))

fw_state_t fw_state USED_IN(".uncached.state");
uint32_t frame_stride USED_IN(".uncached.stride");
uint32_t lut[LUT_ENTRIES_MAX] USED_IN(".frames.lut") __attribute__((aligned(4096)));
uint8_t frame_in[IN_COUNT * FRAME_STRIDE_MAX] USED_IN(".frames.in") __attribute__((aligned(4096)));
#if OUT_COUNT > 0
uint8_t frame_out[OUT_COUNT * FRAME_STRIDE_MAX] USED_IN(".frames.out")
    __attribute__((aligned(4096)));
#endif
