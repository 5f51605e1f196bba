/*
 * The board of the examples, on the twin. It ends the program after 1000 plausible rates. After 500 rates the supply
 * dips, so that no more edges come. The example must report the dip once, and the rates must go on. */
#include "board.h"
#include "twin.h"

#include <stdio.h>
#include <stdlib.h>

static void *rig;
static void (*interrupt)(void);
static uint64_t edge_ns;
static int in_interrupt;
static int used;
static int reports;

/* Largest number of sleeps, rates and reports together. This limit ends an example that makes no progress. */
#define STEPS 5000
static int steps;

static void step(void)
{
    if (++steps > STEPS) {
        printf("%d rates and %d reports in %d steps\n", used, reports, STEPS);
        exit(4);
    }
}

static void *twin(void)
{
    if (rig == NULL) {
        rig = zerorate_twin_new("seed=3");
    }
    return rig;
}

int32_t board_spi_transfer(void *context, uint8_t *bytes, size_t length)
{
    (void)context;
    return zerorate_twin_transfer(twin(), bytes, length);
}

int32_t board_rdy(void *context)
{
    (void)context;
    return zerorate_twin_rdy(twin());
}

void board_delay_us(void *context, uint32_t us)
{
    (void)context;
    zerorate_twin_delay_us(twin(), us);
}

uint64_t board_now_ns(void)
{
    return in_interrupt ? edge_ns : zerorate_twin_now_ns(twin());
}

void board_rdy_interrupt(void (*handler)(void))
{
    interrupt = handler;
}

void board_sleep(void)
{
    uint32_t seq;

    step();
    if (zerorate_twin_next_edge(twin(), &edge_ns, &seq) && interrupt != NULL) {
        in_interrupt = 1;
        interrupt();
        in_interrupt = 0;
    }
}

void board_use(uint32_t corrected_code, uint32_t lost)
{
    /* the rate of this unit at rest is within 10 deg/s (234880 codes) of zero */
    if ((lost != 0 && used != 500) || abs((int32_t)corrected_code - (1 << 23)) > 234880) {
        printf("corrected code %lu, %lu lost\n", (unsigned long)corrected_code, (unsigned long)lost);
        exit(2);
    }
    step();
    if (++used == 500) {
        zerorate_twin_set_fault(twin(), 3);
    }
    if (used == 1000) {
        zerorate_twin_free(rig);
        exit(reports == 1 ? 0 : 5);
    }
}

void board_report(const char *text)
{
    step();
    if (used != 500 || ++reports != 1) {
        printf("after %d rates: %s\n", used, text);
        exit(3);
    }
}
