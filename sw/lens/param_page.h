/* The parameter page: how a host tells the firmware which lens and view it has.
 * It lies at the start of target memory (0x80000000), little-endian, doubles on 8-byte boundaries,
 * and is read once at start. Layout and meaning are described in README.md. */
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

#define PARAM_PAPER_LITERAL_FOCAL (1u << 0) /* equisolid focal by the paper's printed eq. (10) */
#define PARAM_PAIR_METHOD_B (1u << 1)       /* map the pair's centre instead of its first pixel */

typedef struct param_page {
  uint32_t magic;    /* PARAM_PAGE_MAGIC */
  uint32_t version;  /* PARAM_PAGE_VERSION */
  uint32_t bytes;    /* sizeof(param_page_t) */
  uint32_t checksum; /* makes all 32-bit words of the structure sum to 0 modulo 2^32 */

  uint32_t mapping; /* enum lens_mapping */
  uint32_t flags;   /* PARAM_... bits */
  uint32_t width;   /* pixels; 0: the standard's. Else a centred region of the standard's raster */
  uint32_t height;  /* lines; 0: the standard's */

  uint32_t table_count; /* entries of table_r in use, for LENS_TABLE */
  uint32_t repeats;     /* remaps of each captured frame, back to back; 0: one */

  double fov_deg;      /* full horizontal field of view over `width`, degrees */
  double focal_px;     /* lens focal length, px; 0: from fov_deg */
  double out_focal_px; /* focal length of the corrected view, px; 0: the lens focal length */
  double centre_x;     /* optical centre of the input relative to the picture's centre, px */
  double centre_y;
  double shift_x; /* shift of the output view, px */
  double shift_y;
  double in_aspect;  /* y scale / x scale of the lens image */
  double out_aspect; /* y scale / x scale of the output view */
  double theta_max;  /* largest angle the lens shows, radians; 0: no limit (needed for a table) */
  double table_r[PARAM_TABLE_MAX]; /* R in input x-pixels at theta = i * theta_max / (count - 1) */
} param_page_t;

typedef char
    param_page_size_check[sizeof(param_page_t) == 40 + 8 * (10 + PARAM_TABLE_MAX) ? 1 : -1];

/** Fills a page with defaults: equisolid, 180 degrees, square pixels, centred; and seals it. */
void param_page_default(param_page_t *page);

/** Sets magic, version, bytes and checksum. */
void param_page_seal(param_page_t *page);

/** 1 if magic, version, bytes and checksum are right, else 0. */
int param_page_valid(const param_page_t *page);

#ifdef __cplusplus
}
#endif
#endif
