/* Files: write, read, seek, append, rename, remove, and errors. */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

static void check(const char *what, int ok) { printf("%s: %s\n", what, ok ? "yes" : "NO"); }

static void show(const char *name) {
  char line[80];
  FILE *f = fopen(name, "r");
  if (!f) {
    printf("%s: cannot be opened, ENOENT %d\n", name, errno == ENOENT);
    return;
  }
  while (fgets(line, sizeof line, f)) printf("%s: %s", name, line);
  fclose(f);
}

int main(void) {
  static unsigned char block[20000], back[20000];
  unsigned i;
  struct stat s;
  FILE *f = fopen("out.txt", "w");
  if (!f) return 3;
  for (i = 0; i < 20; ++i) fprintf(f, "line %u of the file\n", i);
  fclose(f);
  f = fopen("out.txt", "a");
  fputs("appended\n", f);
  fclose(f);
  show("out.txt");

  for (i = 0; i < sizeof block; ++i) block[i] = (unsigned char)(i * i >> 3);
  f = fopen("data.bin", "wb+");
  check("written", fwrite(block, 1, sizeof block, f) == sizeof block);
  check("rewound", fseek(f, 0, SEEK_SET) == 0);
  check("read", fread(back, 1, sizeof back, f) == sizeof back);
  check("equal", memcmp(block, back, sizeof block) == 0);
  check("sought", fseek(f, 12345, SEEK_SET) == 0 && fgetc(f) == block[12345]);
  check("told", ftell(f) == 12346);
  check("from the end", fseek(f, -10, SEEK_END) == 0 && fgetc(f) == block[sizeof block - 10]);
  fseek(f, 100, SEEK_SET);
  fputc('!', f);
  fclose(f);
  check("size", stat("data.bin", &s) == 0 && s.st_size == (long)sizeof block);

  f = fopen("input.txt", "r");
  check("input is there", f != NULL);
  if (f) {
    int a = 0, b = 0;
    printf("%d fields", fscanf(f, "%d %d", &a, &b));
    printf(": %d\n", a + b);
    fclose(f);
  }
  check("renamed", rename("out.txt", "moved.txt") == 0);
  show("out.txt");
  check("second file", (f = fopen("gone.txt", "w")) != NULL);
  if (f) fclose(f);
  check("removed", remove("gone.txt") == 0);
  show("gone.txt");
  check("remove nothing fails", remove("gone.txt") != 0);
  check("open in no folder fails", fopen("nowhere/x", "w") == NULL);
  return 0;
}
