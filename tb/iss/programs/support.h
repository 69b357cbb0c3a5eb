#pragma once
#include <stdint.h>
void host_write(const char *text, uint32_t bytes);
__attribute__((format(printf, 1, 2))) void say(const char *format, ...);
