#include "model/contract/param_page.h"

static uint32_t bytes_of(uint32_t cameras) {
  uint32_t bytes = (uint32_t)offsetof(param_page_t, camera);
  while (cameras-- != 0) bytes += (uint32_t)sizeof(param_camera_t);
  return bytes;
}

/* The words of the page whatever they are members of. */
typedef uint32_t __attribute__((may_alias)) word_t;

static uint32_t word_sum(const param_page_t *page, uint32_t bytes) {
  const word_t *word = (const word_t *)page;
  uint32_t sum = 0;
  for (uint32_t i = 0; i < bytes; i += 4) sum += *word++;
  return sum;
}

static int possible(const param_pll_t *pll) {
  if (pll->multiplier == 0 || pll->multiplier > 1023u) return 0;
  if (pll->pre_divider > 31u || pll->post_divider > 31u) return 0;
  for (unsigned i = 0; i < sizeof pll->dividers; ++i)
    if (pll->dividers[i] > 31u) return 0;
  return 1;
}

param_page_result_t param_page_check(const param_page_t *page) {
  if (page->magic != PARAM_PAGE_MAGIC) return PARAM_PAGE_BAD_MAGIC;
  if (page->version != PARAM_PAGE_VERSION) return PARAM_PAGE_BAD_VERSION;
  /* The camera count is read only if it is inside the page. */
  if (page->bytes < bytes_of(1)) return PARAM_PAGE_TOO_SMALL;
  if (page->bytes > sizeof *page) return PARAM_PAGE_TOO_LARGE;
  if (page->camera_count == 0 || page->camera_count > PARAM_CAMERAS_MAX)
    return PARAM_PAGE_BAD_CAMERAS;
  if (page->bytes < bytes_of(page->camera_count)) return PARAM_PAGE_TOO_SMALL;
  if (page->bytes > bytes_of(page->camera_count)) return PARAM_PAGE_TOO_LARGE;
  if (word_sum(page, page->bytes) != 0) return PARAM_PAGE_BAD_CHECKSUM;
  if (!possible(&page->clocks.pll1) || !possible(&page->clocks.pll2)) return PARAM_PAGE_BAD_CLOCKS;
  if (page->console.uart != 0 || page->console.divisor == 0 || page->console.divisor > 0xFFFFu)
    return PARAM_PAGE_BAD_CONSOLE;
  for (unsigned i = 0; i < PRIORITY_COUNT; ++i)
    if (page->priority[i] > PRIORITY_LOWEST && page->priority[i] != PRIORITY_OF_RESET)
      return PARAM_PAGE_BAD_PRIORITY;
  return PARAM_PAGE_OK;
}

const char *param_page_text(param_page_result_t result) {
  switch (result) {
    case PARAM_PAGE_OK:
      return "ok";
    case PARAM_PAGE_BAD_MAGIC:
      return "there is none (unknown magic)";
    case PARAM_PAGE_BAD_VERSION:
      return "unknown version; this firmware reads version 5";
    case PARAM_PAGE_TOO_SMALL:
      return "too small for its version and its cameras";
    case PARAM_PAGE_TOO_LARGE:
      return "too large for its version and its cameras";
    case PARAM_PAGE_BAD_CHECKSUM:
      return "its checksum is wrong";
    case PARAM_PAGE_BAD_CAMERAS:
      return "the number of cameras must be 1 to 8";
    case PARAM_PAGE_BAD_CLOCKS:
      return "a PLL's multiplier must be 1 to 1023, its dividers 1 to 32";
    case PARAM_PAGE_BAD_CONSOLE:
      return "the console must be UART0 with a divisor of 1 to 65535";
    case PARAM_PAGE_BAD_PRIORITY:
      return "a priority must be 0 to 7, or 255 for that of reset";
    case PARAM_PAGE_RESULTS:
      break;
  }
  return "unknown";
}

PARAM_ASSERT(PARAM_PAGE_VERSION == 5);
PARAM_ASSERT(PARAM_CAMERAS_MAX == 8);

void param_page_seal(param_page_t *page) {
  page->magic = PARAM_PAGE_MAGIC;
  page->version = PARAM_PAGE_VERSION;
  page->bytes = bytes_of(page->camera_count);
  page->checksum = 0;
  page->checksum = 0u - word_sum(page, page->bytes);
}
