/* The functions that the examples need. Implement them with your vendor's library. The tests use the twin. */
#ifndef BOARD_H
#define BOARD_H

#include <stddef.h>
#include <stdint.h>

/* Sends `length` bytes and replaces them by the received ones: SPI mode 3, most significant bit first, at most 10 MHz,
 * CS low from the first bit to the last. Returns 0, or another number for an error. */
int32_t board_spi_transfer(void *context, uint8_t *bytes, size_t length);
/* Returns the level of RDY: 1, 0, or negative for an error. */
int32_t board_rdy(void *context);
void board_delay_us(void *context, uint32_t us);
/* Returns the time of a monotonic clock, ns. */
uint64_t board_now_ns(void);
/* Calls `handler` on each falling edge of RDY, from the next edge on. With null it stops. */
void board_rdy_interrupt(void (*handler)(void));
/* Sleeps until the next interrupt. A timer ends the sleep after 10 ms. Returns at once if an interrupt is pending. */
void board_sleep(void);
/* Uses the corrected rate, a 24-bit code. `lost` is the number of samples lost just before this one. */
void board_use(uint32_t corrected_code, uint32_t lost);
/* Shows a message to the user. */
void board_report(const char *text);

#endif
