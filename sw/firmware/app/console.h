/* Commands that are typed on UART0 while the program runs: lines and what they mean. No hardware access, so that it
 * can be tested on the host. */
#ifndef FOVEA_FIRMWARE_CONSOLE_H
#define FOVEA_FIRMWARE_CONSOLE_H

#include <stdint.h>

#include "turns.h"

#define CONSOLE_LINE_MAX 79u
#define CONSOLE_ZOOM_MIN 25
#define CONSOLE_ZOOM_MAX 400
#define CONSOLE_SHIFT_MAX 1000
#define CONSOLE_MAPPING_OF_PAGE 0xFFu

typedef struct console_line {
  char text[CONSOLE_LINE_MAX + 1u];
  uint32_t length; /* CONSOLE_LINE_MAX + 1: too long; the rest is thrown away */
} console_line_t;

/** Takes a typed character; backspace takes the last one back.
 * @return 1 at the end of a line (CR or LF): `text` holds it until the next call */
int console_feed(console_line_t *line, char c);

typedef enum command_kind {
  COMMAND_NOTHING = 0, /* an empty line */
  COMMAND_HELP,
  COMMAND_STATUS,
  COMMAND_CAMERAS, /* list */
  COMMAND_ZOOM,    /* camera, value[0] in percent */
  COMMAND_SHIFT,   /* camera, value[0] and value[1] in pixels */
  COMMAND_ROI,     /* camera, value[0] to value[3]: left, top, width, height in pixels */
  COMMAND_MAPPING  /* camera, mapping */
} command_kind_t;

typedef struct command {
  command_kind_t kind;
  uint32_t camera;
  uint32_t count; /* of `list` */
  uint8_t list[TURNS_SEQUENCE_MAX];
  int32_t value[4];
  uint32_t mapping; /* enum lens_mapping, or CONSOLE_MAPPING_OF_PAGE */
} command_t;

/** What a line means on a board with so many cameras.
 * @return a null pointer, or what is wrong with it */
const char *command_parse(const char *line, uint32_t cameras, command_t *command);

/** The commands, a line for each. */
const char *console_help(void);

const char *console_mapping_word(uint32_t mapping);

#endif
