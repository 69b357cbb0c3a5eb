/* What there is to say of cameras that take turns, and of the display. */
#ifndef FOVEA_FIRMWARE_CAMERA_EVENTS_H
#define FOVEA_FIRMWARE_CAMERA_EVENTS_H

/** Says on the UART what has happened to cameras and display since the last call, oldest first. */
void camera_events_say(void);

#endif
