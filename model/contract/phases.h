/* Phase marks: how firmware shows on GPIO pins what it is doing. The model follows frames by them. */
#ifndef FOVEA_CONTRACT_PHASES_H
#define FOVEA_CONTRACT_PHASES_H

enum phase {
  PHASE_RESET = 0, /* nothing was marked yet */
  PHASE_BOOT = 1,
  PHASE_LUT = 2,
  PHASE_IDLE = 3,
  PHASE_REMAP_START = 4, /* before the cache is invalidated */
  PHASE_REMAP_END = 5,   /* after the result has left cache and write buffer */
  PHASE_FLIP = 6,        /* immediately before the OSD's address registers are written */
  PHASE_FAILED = 7       /* the firmware has stopped; the last line on the UART says why */
};

/* Output word of GPIO bank 2, pins 64 to 75: the phase, and the frame's number modulo 256. */
#define PHASE_BANK 2u
#define PHASE_PIN_MASK 0xFFFu
#define PHASE_COUNT 16u
#define PHASE_SEQUENCES 256u
#define PHASE_WORD(phase, sequence) ((uint32_t)(phase) | ((sequence) & (PHASE_SEQUENCES - 1u)) << 4)
#define PHASE_OF(word) ((word) & (PHASE_COUNT - 1u))
#define PHASE_SEQUENCE(word) (((word) >> 4) & (PHASE_SEQUENCES - 1u))

#endif
