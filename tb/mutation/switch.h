// The switch of a mutant, included by every file that scripts/mutate changed.
#ifndef FOVEA_MUTATION_SWITCH_H_
#define FOVEA_MUTATION_SWITCH_H_
#ifdef __arm__
// Target programs are not mutated: their tests would need another build for each mutant.
#define fovea_mutant(id) 0
#else
#ifdef __cplusplus
extern "C" {
#endif
extern unsigned char *fovea_mutant_reached;  // one byte each: evaluated so far
extern int fovea_mutant_on;
#ifdef __cplusplus
}
#endif
static inline int fovea_mutant(int id) {
  fovea_mutant_reached[id] = 1;
  return id == fovea_mutant_on;
}
#endif
#endif
