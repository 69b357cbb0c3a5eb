#include "param_page.h"

static uint32_t word_sum(const param_page_t *page) {
  const unsigned char *bytes = (const unsigned char *)page;
  uint32_t sum = 0;
  for (unsigned i = 0; i < sizeof *page; i += 4)
    sum += (uint32_t)bytes[i] | (uint32_t)bytes[i + 1] << 8 | (uint32_t)bytes[i + 2] << 16 |
           (uint32_t)bytes[i + 3] << 24;
  return sum;
}

void param_page_seal(param_page_t *page) {
  page->magic = PARAM_PAGE_MAGIC;
  page->version = PARAM_PAGE_VERSION;
  page->bytes = sizeof *page;
  page->checksum = 0;
  page->checksum = 0u - word_sum(page);
}

int param_page_valid(const param_page_t *page) {
  return page->magic == PARAM_PAGE_MAGIC && page->version == PARAM_PAGE_VERSION &&
         page->bytes == sizeof *page && word_sum(page) == 0;
}

void param_page_default(param_page_t *page) {
  unsigned char *bytes = (unsigned char *)page;
  for (unsigned i = 0; i < sizeof *page; ++i) bytes[i] = 0;
  page->mapping = LENS_EQUISOLID;
  page->fov_deg = 180.0;
  page->in_aspect = 1.0;
  page->out_aspect = 1.0;
  param_page_seal(page);
}
