/* The analogue multiplexer that leads one of the cameras to the video decoder (PARAM_MULTIPLEXER): channel n is that
 * of camera n, and its number is on the select lines, lowest bit first.
 *
 * The lines are pins 40 to 42 of GPIO bank 1. Their fields in PINMUX4 are neighbours, and 0, their reset value, makes
 * them GPIO (Linux mach-davinci/dm365.c, MUX_CFG). Nothing else of this board is on them: DIP switches have pins 0 to
 * 15, UART0 18 and 19, I2C 20 and 21, the memory interface 52 and up, phase marks 64 to 75. A resistor pulls each line
 * down, so that camera 0 is led through as long as nothing drives the pins. */
#ifndef FOVEA_CONTRACT_MULTIPLEXER_H
#define FOVEA_CONTRACT_MULTIPLEXER_H

#define MULTIPLEXER_BANK 1u /* pins 32 to 63 */
#define MULTIPLEXER_LOW 8u
#define MULTIPLEXER_LINES 3u
#define MULTIPLEXER_CHANNELS (1u << MULTIPLEXER_LINES)
#define MULTIPLEXER_PIN_MASK ((MULTIPLEXER_CHANNELS - 1u) << MULTIPLEXER_LOW)
/* Levels of the bank's pins that select a channel, and the channel that they select. */
#define MULTIPLEXER_WORD(channel) ((channel) << MULTIPLEXER_LOW & MULTIPLEXER_PIN_MASK)
#define MULTIPLEXER_CHANNEL(word) (((word)&MULTIPLEXER_PIN_MASK) >> MULTIPLEXER_LOW)

#endif
