/* The end of a program that cannot go on. */
#ifndef FOVEA_FIRMWARE_FAIL_H
#define FOVEA_FIRMWARE_FAIL_H

/** Prints the reason of a failure, marks the phase and stops. It is in pipeline.c, which all programs with video have;
 * the header is one of its own so that what the pipeline itself uses may fail, too. */
void fail(const char *what, const char *why) __attribute__((noreturn));

#endif
