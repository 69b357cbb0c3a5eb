/* EDMA3: transfers that software triggers, or the end of another transfer. Channel n uses parameter
 * set n; which completion code a set reports is the caller's choice. Sources: SPRUEE4A (EDMA3 of
 * the DM35x), TI's register header cslr_sys (system module), Linux drivers/dma/ti/edma.c. */
#ifndef FOVEA_FIRMWARE_EDMA_H
#define FOVEA_FIRMWARE_EDMA_H

#include <stdint.h>

#define EDMA_CHANNELS 64u /* also the number of completion codes */
#define EDMA_SETS 256u    /* those from 64 on belong to no channel: links only */
#define EDMA_QUEUES 4u    /* queue n feeds transfer controller n */

/* Options of a set. */
#define EDMA_AB_SYNC (1u << 2) /* a trigger moves a frame of arrays; otherwise one array */
#define EDMA_STATIC (1u << 3)  /* the set stays as it is: neither counted down nor linked */
#define EDMA_EARLY (1u << 11)  /* reports when a request is submitted, not when it has ended */
#define EDMA_CODE(n) ((uint32_t)(n) << 12)
#define EDMA_INTERRUPT (1u << 20)      /* reports code n at the end of the set's last request */
#define EDMA_INTERRUPT_EACH (1u << 21) /* reports it at the end of each request before that */
#define EDMA_CHAIN (1u << 22)          /* triggers channel n at the end of the last request */
#define EDMA_CHAIN_EACH (1u << 23)     /* triggers it at the end of each request before that */

#define EDMA_PAIR(low, high) ((uint32_t)(uint16_t)(low) | (uint32_t)(uint16_t)(high) << 16)
#define EDMA_NO_LINK 0xFFFFu
#define EDMA_LINK(set) (0x4000u + 32u * (set))

/** A parameter set as it is in the controller. Internal RAM is at physical address 0x10000. */
typedef struct edma_set {
  uint32_t options;
  uint32_t source;
  uint32_t counts; /* EDMA_PAIR(bytes of an array, arrays of a frame) */
  uint32_t destination;
  uint32_t array_steps; /* EDMA_PAIR(source, destination), bytes, -32768 to 32767 */
  uint32_t link;        /* EDMA_PAIR(EDMA_LINK(set) or EDMA_NO_LINK, arrays of further frames) */
  uint32_t frame_steps; /* EDMA_PAIR(source, destination), bytes */
  uint32_t frames;
} edma_set_t;

/** Switches the channel controller and the transfer controllers on, gives all channels to the ARM's
 * region, ends what was pending and clears errors; bursts of transfer controller 1 are 64 bytes
 * long from now on. No transfer may be under way. All channels are mapped to queue 0. */
void edma_init(void);

/** Maps a channel to a queue. Not while it is triggered. */
void edma_map(uint32_t channel, uint32_t queue);

/** Writes a whole set: eight register accesses. */
void edma_write_set(uint32_t set, const edma_set_t *value);

/** Lets a write to word 0 to 7 of a set trigger it: QDMA channel 0 to 7 serves it through a queue.
 * The set should have EDMA_STATIC, so that what the write does not name stays as it was. */
void edma_open_quick(uint32_t quick_channel, uint32_t set, uint32_t word, uint32_t queue);
void edma_close_quick(void); /* all of them */

/** Triggers channel 0 to 63 by software. */
void edma_start(uint32_t channel);

/** 1 if completion code 0 to 63 has been reported since edma_clear(). */
int edma_done(uint32_t code);
void edma_clear(uint32_t code);

/** Polls for the code and clears it. @return 0 if it was not there at any of `polls` looks; see
 * edma_errors() for the reason */
int edma_wait(uint32_t code, uint32_t polls);

/** 0, or bits of what went wrong since edma_clear_errors(): 0 a missed event or an empty set, 1 a
 * queue over its threshold or too many codes, 4 + n an error of transfer controller n. */
uint32_t edma_errors(void);

/** Clears all errors, and lets channels be triggered again that an error had blocked. */
void edma_clear_errors(void);

/** Opens the interrupt of a code: from then on IRQ_EDMA_CCINT0 is raised when it is reported while
 * no other open one is pending. The interrupt controller is the caller's business. */
void edma_open_interrupt(uint32_t code);

#endif
