#include "console.h"

#include <stddef.h>

int console_feed(console_line_t *line, char c) {
  if (c == '\r' || c == '\n') {
    const uint32_t used = line->length;
    line->text[used <= CONSOLE_LINE_MAX ? used : 0u] = '\0';
    line->length = 0;
    if (used > CONSOLE_LINE_MAX) line->text[0] = '?', line->text[1] = '\0';
    return 1;
  }
  if (c == '\b' || c == 0x7F) {
    if (line->length != 0 && line->length <= CONSOLE_LINE_MAX) --line->length; /* what is too long stays so */
  } else if (line->length <= CONSOLE_LINE_MAX) {
    line->text[line->length] = c;
    ++line->length;
  }
  return 0;
}

const char *console_help(void) {
  return "help                 this text\n"
         "status               cameras, their turns and views\n"
         "camera all           the cameras in turn\n"
         "camera N [N ...]     only these, in this order, up to 16\n"
         "zoom N PERCENT       camera N's view, 25 to 400; 100 as the parameter page says\n"
         "shift N X Y          its view to the right and down, up to 1000 pixels either way\n"
         "roi N X Y W H        instead of both: this rectangle of the picture at zoom 100, shift 0 0,\n"
         "                     enlarged until it fills the display in one direction\n"
         "mapping N WORD       its lens: page (as the parameter page says), none, rectilinear, linear,\n"
         "                     orthographic, equisolid, stereographic, kannala_brandt\n"
         "A new table is built between the frames, and used from a whole frame on.\n";
}

static const char *skip_blanks(const char *p) {
  while (*p == ' ' || *p == '\t') ++p;
  return p;
}

/* Whether the next word is this one; then `*p` goes behind it. */
static int word(const char **p, const char *text) {
  const char *at = skip_blanks(*p);
  while (*text != '\0' && *at == *text) {
    ++at;
    ++text;
  }
  if (*text != '\0' || (*at != '\0' && *at != ' ' && *at != '\t')) return 0;
  *p = at;
  return 1;
}

/* A whole number of at most six digits. */
static int number(const char **p, int32_t *value) {
  const char *at = skip_blanks(*p);
  const int negative = *at == '-';
  if (negative) ++at;
  int32_t out = 0;
  unsigned digits = 0;
  for (; *at >= '0' && *at <= '9' && digits < 7u; ++at, ++digits) out = out * 10 + (*at - '0');
  if (digits == 0 || digits > 6u || (*at != '\0' && *at != ' ' && *at != '\t')) return 0;
  *value = negative ? -out : out;
  *p = at;
  return 1;
}

static int at_end(const char *p) { return *skip_blanks(p) == '\0'; }

static int camera_number(const char **p, uint32_t cameras, uint32_t *camera) {
  int32_t value;
  if (!number(p, &value) || value < 0 || (uint32_t)value >= cameras) return 0;
  *camera = (uint32_t)value;
  return 1;
}

#define MAPPING_WORD(constant, code, text) [constant] = text,
static const char *const kMappings[] = {PARAM_MAPPINGS(MAPPING_WORD)};
enum { kMappingCount = sizeof kMappings / sizeof *kMappings };

const char *console_mapping_word(uint32_t mapping) {
  return mapping < kMappingCount ? kMappings[mapping] : "page";
}

static const char *parse_cameras(const char *p, uint32_t cameras, command_t *c) {
  c->kind = COMMAND_CAMERAS;
  if (word(&p, "all") && at_end(p)) {
    for (; c->count < cameras; ++c->count) c->list[c->count] = (uint8_t)c->count;
    return NULL;
  }
  while (!at_end(p)) {
    uint32_t camera;
    if (c->count == TURNS_SEQUENCE_MAX) return "at most 16 cameras in a sequence";
    if (!camera_number(&p, cameras, &camera)) return "no such camera";
    c->list[c->count++] = (uint8_t)camera;
  }
  return c->count != 0 ? NULL : "camera needs numbers, or all";
}

static const char *parse_mapping(const char *p, command_t *c) {
  c->kind = COMMAND_MAPPING;
  c->mapping = CONSOLE_MAPPING_OF_PAGE;
  if (word(&p, "page") && at_end(p)) return NULL;
  for (uint32_t n = 0; n < kMappingCount; ++n) {
    if (!word(&p, kMappings[n]) || !at_end(p)) continue;
    c->mapping = n;
    return NULL;
  }
  return "no such mapping";
}

static const char *parse_shift(const char *p, command_t *c) {
  c->kind = COMMAND_SHIFT;
  for (unsigned i = 0; i < 2u; ++i)
    if (!number(&p, &c->value[i]) || c->value[i] < -CONSOLE_SHIFT_MAX || c->value[i] > CONSOLE_SHIFT_MAX)
      return "shift is -1000 to 1000 pixels, twice";
  return at_end(p) ? NULL : "shift is -1000 to 1000 pixels, twice";
}

/* Whether it is in the picture is not known here. */
static const char *parse_roi(const char *p, command_t *c) {
  c->kind = COMMAND_ROI;
  for (unsigned i = 0; i < 4u; ++i)
    if (!number(&p, &c->value[i])) return "roi is left, top, width and height in pixels";
  return at_end(p) ? NULL : "roi is left, top, width and height in pixels";
}

const char *command_parse(const char *line, uint32_t cameras, command_t *c) {
  *c = (command_t){.kind = COMMAND_NOTHING};
  const char *p = line;
  if (at_end(p)) return NULL;
  if (word(&p, "help") && at_end(p)) {
    c->kind = COMMAND_HELP;
    return NULL;
  }
  if (word(&p, "status") && at_end(p)) {
    c->kind = COMMAND_STATUS;
    return NULL;
  }
  if (word(&p, "camera")) return parse_cameras(p, cameras, c);
  const int zoom = word(&p, "zoom"), shift = !zoom && word(&p, "shift");
  const int roi = !zoom && !shift && word(&p, "roi");
  if (!zoom && !shift && !roi && !word(&p, "mapping")) return "unknown; help lists the commands";
  if (!camera_number(&p, cameras, &c->camera)) return "no such camera";
  if (zoom) {
    c->kind = COMMAND_ZOOM;
    if (!number(&p, &c->value[0]) || !at_end(p) || c->value[0] < CONSOLE_ZOOM_MIN ||
        c->value[0] > CONSOLE_ZOOM_MAX)
      return "zoom is 25 to 400 percent";
    return NULL;
  }
  return shift ? parse_shift(p, c) : roi ? parse_roi(p, c) : parse_mapping(p, c);
}
