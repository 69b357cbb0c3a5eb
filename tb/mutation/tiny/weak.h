#pragma once
#ifdef __cplusplus
extern "C" {
#endif
/// The value, at least low and at most high. Counts how often a limit was in force.
int clamp(int value, int low, int high);
int clamped(void);
#ifdef __cplusplus
}
#endif
