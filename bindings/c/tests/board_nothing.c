/* A board that does nothing but call an interrupt handler when it is set. The examples link with it for cores that
 * the tests do not emulate. */
#include "board.h"

int32_t board_spi_transfer(void *context, uint8_t *bytes, size_t length)
{
    (void)context;
    (void)bytes;
    (void)length;
    return 0;
}

int32_t board_rdy(void *context)
{
    (void)context;
    return 0;
}

void board_delay_us(void *context, uint32_t us)
{
    (void)context;
    (void)us;
}

uint64_t board_now_ns(void)
{
    return 0;
}

void board_rdy_interrupt(void (*handler)(void))
{
    handler();
}

void board_sleep(void)
{
}

void board_use(uint32_t corrected_code, uint32_t lost)
{
    (void)corrected_code;
    (void)lost;
}

void board_report(const char *text)
{
    (void)text;
}
