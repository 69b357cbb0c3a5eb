#include "field_watch.h"

void field_watch_init(field_watch_t *w, int is_625) {
  /* From the first active line of a field, at which the lines are counted, to that of the other one: 313 lines from
   * line 23 to 336 and 312 back, 263 from 20 to 283 and 262 back. A line has 1728 or 1716 periods of 27 MHz. */
  *w = (field_watch_t){.nominal = {is_625 ? 312u * 1536u : 399637u, is_625 ? 313u * 1536u : 401163u}};
  field_watch_restart(w);
}

void field_watch_restart(field_watch_t *w) {
  w->unknown = 2;
  w->suspected = 0;
}

void field_watch_frame(field_watch_t *w) { w->irregular = 0; }

static int is_wrong(int32_t late) {
  return late > (int32_t)FIELD_TOLERANCE_TICKS || late < -(int32_t)FIELD_TOLERANCE_TICKS;
}

static watch_event_t measure(field_watch_t *w, uint32_t camera, int32_t late) {
  w->camera[camera].ticks += late;
  if (++w->camera[camera].fields < FIELD_DRIFT_FIELDS) return WATCH_NOTHING;
  /* Thousandths of a thousandth: the sum is below 2^15, so nothing overflows. */
  const int32_t whole = (int32_t)((w->nominal[0] + w->nominal[1]) / 2u * FIELD_DRIFT_FIELDS / 1000u);
  const int32_t ppm = w->camera[camera].ticks * 1000 / whole;
  w->camera[camera].ppm = ppm;
  w->camera[camera].ticks = 0;
  w->camera[camera].fields = 0;
  const int32_t off = ppm < 0 ? -ppm : ppm;
  const int was_off = w->camera[camera].off;
  const int is_off = off > (was_off ? FIELD_DRIFT_PPM - FIELD_DRIFT_HYSTERESIS_PPM : FIELD_DRIFT_PPM);
  w->camera[camera].off = is_off;
  return is_off == was_off ? WATCH_NOTHING : is_off ? WATCH_CLOCK_OFF : WATCH_CLOCK_RIGHT;
}

watch_event_t field_watch_field(field_watch_t *w, uint32_t camera, int second, uint32_t now) {
  /* The distance to the start of the second field is that of its first active line from the first field's. */
  const uint32_t distance = now - w->last, nominal = w->nominal[second != 0];
  const int32_t late = (int32_t)(distance - nominal);
  const uint32_t before = w->before;
  const int suspected = w->suspected;
  w->last = now;
  w->before = camera;
  w->suspected = 0;
  if (w->unknown != 0) {
    --w->unknown;
    return WATCH_NOTHING;
  }
  if (suspected) { /* the distance has the suspicious field start at its other end */
    if (!is_wrong(late)) return WATCH_SUSPECT_SHORT;
    w->irregular = 1;
    return WATCH_NOTHING;
  }
  if (camera != before && !second && late > (int32_t)FIELD_TOLERANCE_TICKS && late < (int32_t)nominal) {
    w->suspected = 1;
    w->suspect = before;
    return WATCH_NOTHING;
  }
  if (is_wrong(late)) {
    w->irregular = 1;
    w->unknown = 1; /* which of its two ends was wrong? The next frame, or another camera's, may be right */
    return WATCH_NOTHING;
  }
  return measure(w, camera, late);
}
