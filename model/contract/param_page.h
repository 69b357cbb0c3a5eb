/* The parameter page: everything that the firmware is told apart from the DIP switches (switches.h). A loader puts
 * it into internal RAM at PARAM_PAGE_BASE (memory_map.h), where the boot code finds it before DDR2 works. The layout
 * is little-endian without padding; the same header is compiled for host and target.
 *
 * An enumeration is a list X(constant, code, "word"): the code is in the page, the word in the experiment's key. */
#ifndef FOVEA_CONTRACT_PARAM_PAGE_H
#define FOVEA_CONTRACT_PARAM_PAGE_H

#include <stddef.h>
#include <stdint.h>

#include "model/contract/memory_map.h"

#ifdef __cplusplus
#define PARAM_ASSERT(condition) static_assert(condition, #condition)
extern "C" {
#else
#define PARAM_ASSERT(condition) _Static_assert(condition, #condition)
#endif

#define PARAM_CONSTANT(constant, code, ...) constant = (code),

#define PARAM_PAGE_MAGIC 0x41564F46u /* bytes "FOVA" */
#define PARAM_PAGE_VERSION 5u        /* changes with every change of the layout or of a meaning */
#define PARAM_CAMERAS_MAX 8u
#define PARAM_TABLE_MAX 129u

#define PARAM_MAPPINGS(X)                    \
  X(LENS_NONE, 0, "none")                    \
  X(LENS_RECTILINEAR, 1, "rectilinear")      \
  X(LENS_LINEAR, 2, "linear")                \
  X(LENS_ORTHOGRAPHIC, 3, "orthographic")    \
  X(LENS_EQUISOLID, 4, "equisolid")          \
  X(LENS_STEREOGRAPHIC, 5, "stereographic")  \
  X(LENS_TABLE, 6, "kannala_brandt")
enum lens_mapping { PARAM_MAPPINGS(PARAM_CONSTANT) };

#define PARAM_PAIR_METHODS(X)            \
  X(PAIR_FIRST_PIXEL, 0, "A")            \
  X(PAIR_CENTRE, 1, "B")
enum param_pair_method { PARAM_PAIR_METHODS(PARAM_CONSTANT) };

/* Who moves a kernel's pixels; of `fastest`, which is none itself, the kernel in its place says that. */
enum param_mover { PARAM_BY_CORE, PARAM_BY_EDMA, PARAM_BY_ENGINE, PARAM_BY_ANOTHER };

/* How a frame is remapped (sw/firmware/README.md): X(constant, code, word, who moves the pixels, the kernel that the
 * firmware takes in its place where lens or chip do not allow it (of several sources: `strips`), whether it has a form
 * for several sources). All but three give the same picture: `copy` does not correct; `engine_grid` and
 * `engine_radial` follow the lens, but not its table. Those after `ldm` read a form of the look-up table that the
 * firmware derives from it at the start. The last one of a chain fits every lens and refers to itself. A new row comes
 * last, with the next code (model/howto/add-a-kernel.md). */
#define PARAM_KERNELS(X)                                                          \
  X(KERNEL_PLAIN, 0, "plain", PARAM_BY_CORE, KERNEL_PLAIN, 1)                     \
  X(KERNEL_LDM, 1, "ldm", PARAM_BY_CORE, KERNEL_LDM, 1)                           \
  X(KERNEL_STRIPS, 2, "strips", PARAM_BY_CORE, KERNEL_STRIPS, 1)                  \
  X(KERNEL_OFFSETS, 3, "offsets16", PARAM_BY_CORE, KERNEL_STRIPS, 0)              \
  X(KERNEL_DELTAS, 4, "deltas4", PARAM_BY_CORE, KERNEL_OFFSETS, 0)                \
  X(KERNEL_CODES, 5, "codes", PARAM_BY_CORE, KERNEL_DELTAS, 0)                    \
  X(KERNEL_STAGED, 6, "staged", PARAM_BY_EDMA, KERNEL_CODES, 0)                   \
  X(KERNEL_GATHER, 7, "gather", PARAM_BY_EDMA, KERNEL_CODES, 0)                   \
  X(KERNEL_RUNS, 8, "runs", PARAM_BY_EDMA, KERNEL_CODES, 0)                       \
  X(KERNEL_COPY, 9, "copy", PARAM_BY_EDMA, KERNEL_CODES, 0)                       \
  X(KERNEL_FASTEST, 10, "fastest", PARAM_BY_ANOTHER, KERNEL_STAGED, 1)            \
  X(KERNEL_ENGINE, 11, "engine", PARAM_BY_ENGINE, KERNEL_STAGED, 1)               \
  X(KERNEL_ENGINE_GRID, 12, "engine_grid", PARAM_BY_ENGINE, KERNEL_STAGED, 0)     \
  X(KERNEL_ENGINE_RADIAL, 13, "engine_radial", PARAM_BY_ENGINE, KERNEL_STAGED, 0) \
  /* the end */
enum param_kernel { PARAM_KERNELS(PARAM_CONSTANT) KERNEL_COUNT };

/* The look-up tables of a run that measures the remap loop by itself: table k is that of the camera's view, moved to
 * the right by k * PARAM_TABLE_STEP_PX (lens_view_t, shift_x). The step is odd, so that the first pixels of the pairs
 * are other pixels in each neighbouring table. */
#define PARAM_TABLES_MAX 4u
#define PARAM_TABLE_STEP_PX 7.0

#define PARAM_FLOWS(X)         \
  X(FLOW_DOUBLE, 0, "double")  \
  X(FLOW_SERIAL, 1, "serial")
enum param_flow { PARAM_FLOWS(PARAM_CONSTANT) };

/* How the look-up table is computed: in double precision, in software on this core, or in fixed point. */
#define PARAM_BUILDERS(X)              \
  X(BUILDER_DOUBLE, 0, "soft_float")   \
  X(BUILDER_FIXED, 1, "fixed_point")
enum param_table_builder { PARAM_BUILDERS(PARAM_CONSTANT) };

/* The masters whose priority a register of the chip holds; words as in model/common/masters.h. */
#define PARAM_MASTERS(X)                    \
  X(PRIORITY_ARM, 0, "arm")                 \
  X(PRIORITY_EDMA_TC0, 1, "edma_tc0")       \
  X(PRIORITY_EDMA_TC1, 2, "edma_tc1")       \
  X(PRIORITY_EDMA_TC2, 3, "edma_tc2")       \
  X(PRIORITY_EDMA_TC3, 4, "edma_tc3")       \
  X(PRIORITY_VPFE, 5, "vpfe")               \
  X(PRIORITY_VPBE, 6, "vpbe")               \
  X(PRIORITY_IMCOP, 7, "remap_engine")
enum param_master { PARAM_MASTERS(PARAM_CONSTANT) PRIORITY_COUNT = 16 };
#define PRIORITY_LOWEST 7u
#define PRIORITY_OF_RESET 0xFFu /* the register keeps its reset value */

/* One PLL controller. Each divider holds its ratio - 1, as in the chip's registers. */
typedef struct param_pll {
  uint16_t multiplier; /* PLLM: half of the multiplier, 1 to 1023 */
  uint8_t pre_divider, post_divider;
  uint8_t dividers[9]; /* of SYSCLK1 to SYSCLK9; the second PLL has five */
  uint8_t reserved[3];
} param_pll_t;

typedef struct param_clocks {
  param_pll_t pll1, pll2;   /* DDR2, bus and video; core */
  uint32_t vpss_clk_ctrl;   /* VPSS_CLK_CTRL: which of them gives the encoder's 27 MHz */
  uint32_t core_khz;        /* what comes of it, for messages */
  uint32_t ddr_khz;
  uint32_t sdtimr, sdtimr2; /* timing of DDR2 in clocks, as the controller's registers have it */
  uint32_t sdrcr;           /* refresh interval */
} param_clocks_t;

typedef struct param_console {
  uint32_t uart;    /* number of the UART; 0 */
  uint32_t divisor; /* of 24 MHz / 16; 13 is 115200 Bd */
} param_console_t;

#define PARAM_PAPER_LITERAL_FOCAL (1u << 0) /* equisolid focal length by the paper's printed equation (10) */

/* Lens and view of a camera; sw/lens/README.md has the geometry. */
typedef struct lens_view {
  uint32_t mapping;     /* enum lens_mapping */
  uint32_t flags;       /* PARAM_PAPER_LITERAL_FOCAL */
  uint32_t pair_method; /* enum param_pair_method */
  uint32_t table_count; /* number of entries of table_r in use, for LENS_TABLE */
  double fov_deg;       /* full horizontal field of view over the picture's width, degrees */
  double focal_px;      /* focal length of the lens, px; 0: computed from fov_deg */
  double out_focal_px;  /* focal length of the corrected view, px; 0: that of the lens */
  double centre_x;      /* optical centre of the input, relative to the picture's centre, px */
  double centre_y;
  double shift_x; /* shift of the output view, px */
  double shift_y;
  double in_aspect;  /* y scale / x scale of the lens image */
  double out_aspect; /* y scale / x scale of the output view */
  double theta_max;  /* largest angle that the lens images, radians; 0: no limit (a table needs one) */
  double table_r[PARAM_TABLE_MAX]; /* R in x-pixels of the input at theta = i * theta_max / (count - 1) */
} lens_view_t;

#define PARAM_CAMERA_GENLOCKED (1u << 0) /* its syncs are those of all cameras with this flag */

typedef struct param_camera {
  uint32_t input; /* of the video decoder: a code of its register 00 */
  uint32_t flags; /* PARAM_CAMERA_GENLOCKED */
  lens_view_t view;
} param_camera_t;

#define PARAM_OVERLAY (1u << 0)    /* a blinking box, blended through the data cache */
#define PARAM_SELF_PATCH (1u << 1) /* the program patches its own code once */
#define PARAM_ENGINE (1u << 2)     /* the chip has the remap engine; without, its registers are a bus error */
#define PARAM_DISPLAY_FREE (1u << 3) /* the display starts on its own, not in step with the camera; only a program
                                        with a console does that */
#define PARAM_CHECK_CAPTURE (1u << 4) /* frames of which a part was not written are left out; only a program for
                                         several cameras does that */
#define PARAM_MULTIPLEXER (1u << 6) /* an analogue multiplexer under GPIO leads one of the cameras to the decoder's
                                       input of camera 0 (multiplexer.h); only a program with a console knows it */
#define PARAM_DIGITAL (1u << 5) /* the camera is a progressive one at the digital port, without a decoder; its size is
                                   that of SWITCH_SIZE_IN, all of which is captured */

typedef struct param_page {
  uint32_t magic;    /* PARAM_PAGE_MAGIC */
  uint32_t version;  /* PARAM_PAGE_VERSION */
  uint32_t bytes;    /* of the page: those before `camera`, and those of camera_count cameras */
  uint32_t checksum; /* makes all 32-bit words of these bytes sum to 0 modulo 2^32 */

  param_clocks_t clocks;
  param_console_t console;
  uint8_t priority[PRIORITY_COUNT]; /* by enum param_master: 0 (highest) to 7, or PRIORITY_OF_RESET */

  uint32_t kernel;        /* enum param_kernel */
  uint32_t table_builder; /* enum param_table_builder */
  uint32_t flow;          /* enum param_flow */
  uint32_t repeats;       /* number of consecutive remaps for each captured frame; 0: one */
  uint32_t tables;        /* number of look-up tables and of source frames, used in turn; 0: one */
  uint32_t flags;         /* PARAM_OVERLAY, PARAM_SELF_PATCH, PARAM_ENGINE, PARAM_DISPLAY_FREE,
                             PARAM_CHECK_CAPTURE, PARAM_DIGITAL, PARAM_MULTIPLEXER */
  uint32_t width;         /* pixels of a centred region; 0: all. Only with SWITCH_SIZE_OF_PAGE of the display */
  uint32_t height;        /* lines of it; 0: all */
  uint32_t camera_count;  /* 1 to PARAM_CAMERAS_MAX */
  uint32_t watchdog_us;   /* period of the watchdog; 0: off. Only a program for several cameras uses it */

  param_camera_t camera[PARAM_CAMERAS_MAX];
} param_page_t;

PARAM_ASSERT(sizeof(param_pll_t) == 16);
PARAM_ASSERT(sizeof(param_clocks_t) == 56);
PARAM_ASSERT(sizeof(lens_view_t) == 16 + 8 * (10 + PARAM_TABLE_MAX));
PARAM_ASSERT(offsetof(lens_view_t, fov_deg) == 16);
PARAM_ASSERT(offsetof(lens_view_t, table_r) == 96);
PARAM_ASSERT(sizeof(param_camera_t) == 8 + sizeof(lens_view_t));
PARAM_ASSERT(offsetof(param_page_t, clocks) == 16);
PARAM_ASSERT(offsetof(param_page_t, console) == 72);
PARAM_ASSERT(offsetof(param_page_t, priority) == 80);
PARAM_ASSERT(offsetof(param_page_t, kernel) == 96);
PARAM_ASSERT(offsetof(param_page_t, camera_count) == 128);
PARAM_ASSERT(offsetof(param_page_t, camera) == 136);
PARAM_ASSERT(sizeof(param_page_t) == 136 + PARAM_CAMERAS_MAX * sizeof(param_camera_t));
PARAM_ASSERT(sizeof(param_page_t) <= PARAM_PAGE_BYTES);

typedef enum param_page_result {
  PARAM_PAGE_OK = 0,
  PARAM_PAGE_BAD_MAGIC,
  PARAM_PAGE_BAD_VERSION,
  PARAM_PAGE_TOO_SMALL,
  PARAM_PAGE_TOO_LARGE,
  PARAM_PAGE_BAD_CHECKSUM,
  PARAM_PAGE_BAD_CAMERAS,
  PARAM_PAGE_BAD_CLOCKS,
  PARAM_PAGE_BAD_CONSOLE,
  PARAM_PAGE_BAD_PRIORITY,
  PARAM_PAGE_RESULTS
} param_page_result_t;

/** Checks everything that the boot code relies on. Runs in internal RAM: calls no other function. What the page says
 * of the application (kernel, lens, ...) is checked by the application. */
param_page_result_t param_page_check(const param_page_t *page);

/** A sentence for a message about a result. */
const char *param_page_text(param_page_result_t result);

/** Sets magic, version, bytes and checksum. The camera count must be right. */
void param_page_seal(param_page_t *page);

#ifdef __cplusplus
}
#endif
#endif
