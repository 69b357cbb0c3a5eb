#include "camera_events.h"

#include "../drivers/uart.h"
#include "pipeline.h"
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
}
