#ifndef FOVEA_ISS_MIX_H
#define FOVEA_ISS_MIX_H

#include <stdint.h>

#ifdef __cplusplus
extern "C"
#endif
/** Runs the mix from the start. @return a sum over what it left */
uint32_t mix_run(uint32_t turns);

#endif
