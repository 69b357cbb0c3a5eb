#include "choices.h"

#include <stddef.h>

#include "../drivers/timer.h"
#include "../drivers/uart_queue.h"
#include "console.h"
#include "pipeline_turns.h"
#include "sw/lens/region.h"
#include "view_tables.h"

/* At least what the longest answer takes: `status` for eight cameras. */
#define ANSWER_BYTES 2048u

static struct {
  const config_t *config;
  struct view *views;
  console_line_t line;
  struct choice {
    int32_t zoom, shift_x, shift_y; /* percent, pixels; 100 and 0 with a region of interest */
    int32_t roi[4];                 /* left, top, width, height; a width of 0: none */
    uint32_t mapping;
  } camera[CAMERAS_MAX];
  uint8_t sequence[TURNS_SEQUENCE_MAX];
  uint32_t length;
} choices;

void choices_start(const config_t *config, struct view *views) {
  choices.config = config;
  choices.views = views;
  for (uint32_t n = 0; n < config->cameras; ++n) {
    choices.camera[n] = (struct choice){.zoom = 100, .mapping = CONSOLE_MAPPING_OF_PAGE};
    choices.sequence[choices.length++] = (uint8_t)n;
  }
  uart_queue_start();
  uart_queue_puts("console: help lists the commands\n");
}

static void refuse(const char *why) {
  uart_queue_puts("refused: ");
  uart_queue_puts(why);
  uart_queue_puts("\n");
}

static lens_region_t region_of(const int32_t roi[4]) {
  return (lens_region_t){(double)roi[0], (double)roi[1], (double)roi[2], (double)roi[3]};
}

/* Takes a region of interest into what is wanted. @return 0 for one that cannot be, which is said */
static int choose_roi(struct choice *wanted, const int32_t roi[4]) {
  const uint32_t width = choices.config->width, height = choices.config->height;
  const lens_region_t region = region_of(roi);
  if (!lens_region_fits(&region, width, height)) {
    uart_queue_puts("refused: roi is within the ");
    uart_queue_put_uint(width);
    uart_queue_puts("x");
    uart_queue_put_uint(height);
    uart_queue_puts(" pixels of the picture, at least a quarter as wide or as high\n");
    return 0;
  }
  *wanted = (struct choice){.zoom = 100, .mapping = wanted->mapping};
  for (unsigned i = 0; i < 4u; ++i) wanted->roi[i] = roi[i];
  return 1;
}

/* The page's view with what was chosen. @return a null pointer, or why that is no lens */
static const char *chosen_view(uint32_t camera, const struct choice *c, lens_view_t *view) {
  *view = choices.config->views[camera];
  if (c->mapping != CONSOLE_MAPPING_OF_PAGE) view->mapping = c->mapping;
  view->shift_x += c->shift_x;
  view->shift_y += c->shift_y;
  lens_t lens;
  lens_result_t result = lens_init(&lens, view, choices.config->width, choices.config->height);
  const int region = c->roi[2] != 0;
  if (result == LENS_OK && (region || c->zoom != 100)) {
    if (view->mapping == LENS_NONE) return "mapping none has no scale; only with zoom 100 and no roi";
    const lens_region_t roi = region_of(c->roi);
    if (region)
      lens_show_region(view, &lens, &roi);
    else
      view->out_focal_px = lens.out_focal * c->zoom / 100.0;
    result = lens_init(&lens, view, choices.config->width, choices.config->height);
  }
  return result == LENS_OK ? NULL : lens_result_text(result);
}

static void say_view(uint32_t camera) {
  const struct choice *c = &choices.camera[camera];
  if (c->roi[2] != 0) {
    uart_queue_puts("roi");
    for (unsigned i = 0; i < 4u; ++i) {
      uart_queue_puts(" ");
      uart_queue_put_int(c->roi[i]);
    }
  } else {
    uart_queue_puts("zoom ");
    uart_queue_put_int(c->zoom);
    uart_queue_puts(" %, shift ");
    uart_queue_put_int(c->shift_x);
    uart_queue_puts(" ");
    uart_queue_put_int(c->shift_y);
  }
  uart_queue_puts(", mapping ");
  uart_queue_puts(console_mapping_word(c->mapping));
}

static void change_view(uint32_t camera, const struct choice *wanted) {
  static lens_view_t view;
  const char *why = chosen_view(camera, wanted, &view);
  if (why != NULL) {
    refuse(why);
    return;
  }
  const uint32_t start = timer_ticks();
  if (!view_tables_rebuild(choices.views, camera, &view)) {
    refuse("no memory for a further table");
    return;
  }
  choices.camera[camera] = *wanted;
  uart_queue_puts("camera ");
  uart_queue_put_uint(camera);
  uart_queue_puts(": ");
  say_view(camera);
  uart_queue_puts(", new table after ");
  uart_queue_put_uint((timer_ticks() - start) / TIMER_TICKS_PER_MS);
  uart_queue_puts(" ms\n");
}

static void say_turns(void) {
  uart_queue_puts("turns:");
  for (uint32_t n = 0; n < choices.length; ++n) {
    uart_queue_puts(" ");
    uart_queue_put_uint(choices.sequence[n]);
  }
  uart_queue_puts("\n");
}

static void say_status(void) {
  say_turns();
  for (uint32_t n = 0; n < choices.config->cameras; ++n) {
    uart_queue_puts("camera ");
    uart_queue_put_uint(n);
    uart_queue_puts(": ");
    uart_queue_puts(pipeline_state(n));
    uart_queue_puts(", clock ");
    uart_queue_put_int(pipeline_clock_ppm(n));
    uart_queue_puts(" ppm off, ");
    say_view(n);
    uart_queue_puts("\n");
  }
}

static void obey(const char *text) {
  command_t command;
  const char *wrong = command_parse(text, choices.config->cameras, &command);
  if (wrong != NULL) {
    refuse(wrong);
    return;
  }
  struct choice wanted = choices.camera[command.camera];
  switch (command.kind) {
    case COMMAND_NOTHING:
      return;
    case COMMAND_HELP:
      uart_queue_puts(console_help());
      return;
    case COMMAND_STATUS:
      say_status();
      return;
    case COMMAND_CAMERAS:
      for (uint32_t n = 0; n < command.count; ++n) choices.sequence[n] = command.list[n];
      choices.length = command.count;
      pipeline_choose(command.list, command.count);
      say_turns();
      return;
    case COMMAND_ZOOM:
      wanted.zoom = command.value[0];
      wanted.roi[2] = 0;
      break;
    case COMMAND_SHIFT:
      wanted.shift_x = command.value[0];
      wanted.shift_y = command.value[1];
      wanted.roi[2] = 0;
      break;
    case COMMAND_ROI:
      if (!choose_roi(&wanted, command.value)) return;
      break;
    case COMMAND_MAPPING:
      wanted.mapping = command.mapping;
      break;
  }
  change_view(command.camera, &wanted);
}

/* One line a call, and only with room for its answer, so that no frame waits for the line of UART0. */
void choices_work(void) {
  char c;
  while (uart_queue_room() >= ANSWER_BYTES && uart_queue_read(&c)) {
    const int end = console_feed(&choices.line, c);
    const char echo[2] = {end ? '\n' : c, '\0'};
    uart_queue_puts(echo);
    if (!end) continue;
    obey(choices.line.text);
    return;
  }
}
