/* The functions that an example needs. Implement them with your vendor's library; the tests use the twin. */
#ifndef BOARD_H
#define BOARD_H

#include <stddef.h>
#include <stdint.h>

/* Transfers in SPI mode 3, most significant bit first, at most 10 MHz; CS is low from the first bit to the last.
 * Returns 0, or an error. */
int32_t board_spi_transfer(void *context, uint8_t *bytes, size_t length);
/* Returns the level of RDY: 1, 0, or negative for an error. */
int32_t board_rdy(void *context);
void board_delay_us(void *context, uint32_t us);
/* Returns the time of a monotonic clock, ns. */
uint64_t board_now_ns(void);
/* Calls `handler` on each falling edge of RDY, from the next on. With null it stops. */
void board_rdy_interrupt(void (*handler)(void));
/* Sleeps until an interrupt, for 10 ms at most (a timer). Returns at once if an interrupt is pending. */
void board_sleep(void);
/* Uses the corrected rate, a code of 24 bits. `lost` is the number of samples lost just before it. */
void board_use(uint32_t corrected_code, uint32_t lost);
/* Reports a message to whoever uses the board. */
void board_report(const char *text);

#endif
