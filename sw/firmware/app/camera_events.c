#include "camera_events.h"

#include "../drivers/uart.h"
#include "pipeline_turns.h"
#include "say.h"

void camera_events_say(void) {
  uint32_t camera;
  const char *what;
  while (pipeline_event(&camera, &what)) {
    uart_puts("camera ");
    uart_put_uint(camera);
    uart_puts(": ");
    uart_puts(what);
    uart_puts("\n");
  }
  uint32_t late_fields;
  display_event_t event;
  while ((event = pipeline_display_event(&late_fields)) != DISPLAY_NOTHING) {
    uart_puts("display: ");
    uart_puts(display_event_text(event));
    if (event == DISPLAY_FINE) {
      uart_puts(", fields with late data: ");
      uart_put_uint(late_fields);
    }
    uart_puts("\n");
  }
}
