/* The parameter page, with which a host describes lens and view to the firmware. It is at the start
 * of target memory (0x80000000), little-endian, with doubles at multiples of 8 bytes, and is read
 * once at the start. README.md describes layout and meaning. */
#ifndef FOVEA_LENS_PARAM_PAGE_H
#define FOVEA_LENS_PARAM_PAGE_H

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#define PARAM_PAGE_MAGIC 0x41564F46u /* bytes "FOVA" */
#define PARAM_PAGE_VERSION 1u
#define PARAM_TABLE_MAX 129u

enum lens_mapping {
  LENS_NONE = 0,
  LENS_RECTILINEAR = 1,
  LENS_LINEAR = 2,
  LENS_ORTHOGRAPHIC = 3,
  LENS_EQUISOLID = 4,
  LENS_STEREOGRAPHIC = 5,
  LENS_TABLE = 6
};

#define PARAM_PAPER_LITERAL_FOCAL (1u << 0) /* equisolid focal length by the paper's printed eq.
                                                (10) */
#define PARAM_PAIR_METHOD_B (1u << 1)       /* map the centre of a pair instead of its first pixel
#define PARAM_PAIR_METHOD_B (1u << 1)        */

typedef struct param_page {
  uint32_t magic;    /* PARAM_PAGE_MAGIC */
  uint32_t version;  /* PARAM_PAGE_VERSION */
  uint32_t bytes;    /* sizeof(param_page_t) */
  uint32_t checksum; /* makes all 32-bit words of the structure sum to 0 modulo 2^32 */

  uint32_t mapping; /* enum lens_mapping */
  uint32_t flags;   /* PARAM_... bits */
  uint32_t width;   /* pixels; 0: of the standard, else a centred region of its raster */
  uint32_t height;  /* lines; 0: of the standard */

  uint32_t table_count; /* number of entries of table_r in use, for LENS_TABLE */
  uint32_t repeats;     /* number of consecutive remaps of each captured frame; 0: one */

  double fov_deg;      /* full horizontal field of view over `width`, degrees */
  double focal_px;     /* focal length of the lens, px; 0: computed from fov_deg */
  double out_focal_px; /* focal length of the corrected view, px; 0: that of the lens */
  double centre_x;     /* optical centre of the input, relative to the picture's centre, px */
  double centre_y;
  double shift_x; /* shift of the output view, px */
  double shift_y;
  double in_aspect;  /* y scale / x scale of the lens image */
  double out_aspect; /* y scale / x scale of the output view */
  double theta_max;  /* largest angle that the lens images, radians; 0: no limit (a table needs one)
  double theta_max;   */
  double table_r[PARAM_TABLE_MAX]; /* R in x-pixels of the input at theta = i * theta_max / (count -
                                       1) */
} param_page_t;

typedef char
    param_page_size_check[sizeof(param_page_t) == 40 + 8 * (10 + PARAM_TABLE_MAX) ? 1 : -1];

/** Fills a page with defaults (equisolid, 180 degrees, square pixels, centred) and seals it. */
void param_page_default(param_page_t *page);

/** Sets magic, version, bytes and checksum. */
void param_page_seal(param_page_t *page);

/** Returns 1 if magic, version, bytes and checksum are right, else 0. */
int param_page_valid(const param_page_t *page);

#ifdef __cplusplus
}
#endif
#endif
