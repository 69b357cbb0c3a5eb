/* A parameter page of version 3, linked to the place where the loader would put one: the firmware refuses it. */
#include "model/contract/param_page.h"

extern const uint32_t old_page[4];
const uint32_t old_page[4]
    __attribute__((section(".param_page"), used)) = {PARAM_PAGE_MAGIC, 3u, 1264u, 0u};
