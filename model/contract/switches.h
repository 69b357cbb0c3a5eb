/* The board's DIP switches: what an installer chooses without a computer. Switch n is the level of GPIO pin n.
 * Everything else is in the parameter page (param_page.h). Each field is a pair: its lowest switch, and how many
 * switches it has. */
#ifndef FOVEA_CONTRACT_SWITCHES_H
#define FOVEA_CONTRACT_SWITCHES_H

#include <stdint.h>

#define SWITCH_COUNT 16u

#define SWITCH_STANDARD_IN 0u, 1u  /* enum switch_standard, of the camera */
#define SWITCH_STANDARD_OUT 1u, 1u /* of the display */
#define SWITCH_SIZE_IN 2u, 3u      /* enum switch_size, of the captured picture */
#define SWITCH_SIZE_OUT 5u, 3u     /* of the corrected and displayed picture */
#define SWITCH_MAPPING 8u, 3u      /* 0: as the page says; n: enum lens_mapping n - 1 */
#define SWITCH_SHIFT_X 11u, 2u     /* enum switch_shift, added to the page's shift of the view */
#define SWITCH_SHIFT_Y 13u, 2u     /* switch 15 is not used */

#define SWITCH_GET(pins, field) SWITCH_GET_FIELD(pins, field)
#define SWITCH_GET_FIELD(pins, low, width) (((uint32_t)(pins) >> (low)) & ((1u << (width)) - 1u))
#define SWITCH_PUT(field, code) SWITCH_PUT_FIELD(field, code)
#define SWITCH_PUT_FIELD(low, width, code) (((uint32_t)(code) & ((1u << (width)) - 1u)) << (low))

enum switch_standard { SWITCH_PAL = 0 /* 625/50 */, SWITCH_NTSC = 1 /* 525/60 */ };

/* Sizes that the paper names. */
enum switch_size {
  SWITCH_SIZE_OF_PAGE = 0,
  SWITCH_720X576 = 1,
  SWITCH_720X480 = 2,
  SWITCH_720X486 = 3,
  SWITCH_640X480 = 4,
  SWITCH_800X600 = 5
};

enum switch_shift { SWITCH_CENTRED = 0, SWITCH_FORWARD = 1 /* right, down */, SWITCH_BACK = 2 };
#define SWITCH_SHIFT_PIXELS 32

#endif
