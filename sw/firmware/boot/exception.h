/* Exceptions without a handler. */
#ifndef FOVEA_FIRMWARE_EXCEPTION_H
#define FOVEA_FIRMWARE_EXCEPTION_H

#include <stdint.h>

/** Prints the cause and stops; called by the exception entries. */
void fatal_exception(uint32_t kind, uint32_t pc) __attribute__((noreturn));

#endif
