#ifndef FOVEA_ISS_MIX_H
#define FOVEA_ISS_MIX_H

#include <stdint.h>

#ifdef __cplusplus
extern "C"
#endif
/** Runs the mix from its initial state. @return a checksum of its results */
uint32_t mix_run(uint32_t turns);

#endif
