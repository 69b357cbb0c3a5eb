// Reads which mutant is on (FOVEA_MUTANT) and maps the file that records what is evaluated
// (FOVEA_MUTANT_REACHED); linked to every program of the mutated build.
#include <fcntl.h>
#include <stdlib.h>
#include <sys/mman.h>
#include <unistd.h>

enum { kMutants = 65536 };
static unsigned char ignored[kMutants];
unsigned char *fovea_mutant_reached = ignored;
int fovea_mutant_on = -1;

__attribute__((constructor(101))) static void start(void) {
  const char *on = getenv("FOVEA_MUTANT");
  const char *file = getenv("FOVEA_MUTANT_REACHED");
  if (on) fovea_mutant_on = atoi(on);
  if (!file) return;
  const int fd = open(file, O_RDWR);
  if (fd < 0) abort();
  void *map = mmap(0, kMutants, PROT_READ | PROT_WRITE, MAP_SHARED, fd, 0);
  if (map == MAP_FAILED) abort();
  close(fd);
  fovea_mutant_reached = (unsigned char *)map;
}
