/* What there is to say of cameras that take turns. */
#ifndef FOVEA_FIRMWARE_CAMERA_EVENTS_H
#define FOVEA_FIRMWARE_CAMERA_EVENTS_H

/** Says on the UART what has happened to cameras since the last call, oldest first. */
void camera_events_say(void);

#endif
