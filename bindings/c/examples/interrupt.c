/*
 * Samples in the interrupt of RDY, and corrects in the main loop. No sample is lost while the main loop empties the
 * queue in time, and each lost sample is counted. While the interrupt is enabled, the gyroscope belongs to it alone.
 * This example was not run on a board. The tests run it on the twin. */
#include "board.h"
#include "zerorate.h"

/* Length of the queue. It divides 2^32, so that the counters may wrap. The interrupt writes, the main loop reads. */
#define QUEUE 16u

static zerorate_gyro gyro;
static zerorate_sample queue[QUEUE];
static volatile uint32_t written;
static volatile uint32_t taken;
static volatile zerorate_status failure;

/* Keeps the compiler from reordering the accesses to `queue` and its counters, which is enough on one core. */
#define BARRIER() __asm volatile("" ::: "memory")

static void on_rdy(void)
{
    static uint32_t edges;
    static uint32_t overrun;
    zerorate_sample sample;
    const zerorate_status status = zerorate_gyro_sample(&gyro, board_now_ns(), ++edges, &sample);

    if (status == ZERORATE_OK && written - taken < QUEUE) {
        sample.lost += overrun;
        overrun = 0;
        queue[written % QUEUE] = sample;
        BARRIER();
        written = written + 1;
    } else if (status == ZERORATE_OK) {
        overrun += 1 + sample.lost;
    } else if (status < 0) {
        /* a part that does not answer gives no more edges, so restart_if_silent reports that and tries again */
        const zerorate_status again = zerorate_gyro_initialise(&gyro);

        failure = again == ZERORATE_OK ? status : again;
    }
}

/* If no edges come, the supply has dipped, or RDY is cut. Reports the cause, and initialises the part again. */
static void restart_if_silent(void)
{
    zerorate_status status;

    board_rdy_interrupt(NULL);
    status = zerorate_gyro_silent(&gyro, board_now_ns());
    if (status != ZERORATE_OK) {
        const zerorate_status cause = zerorate_gyro_diagnose(&gyro);

        failure = cause == ZERORATE_OK ? status : cause;
        /* if this fails, RDY stays silent, and the next call reports it */
        (void)zerorate_gyro_initialise(&gyro);
    }
    board_rdy_interrupt(on_rdy);
}

int main(void)
{
    static const zerorate_correction CORRECTION = {.pbc_dps = -0.25, .btc_dps_per_c = -0.04, .t3_c = 31.5};
    const zerorate_bus bus = {NULL, board_spi_transfer, NULL, NULL};
    zerorate_settings settings;
    zerorate_correction_integer correction;
    zerorate_status status;
    uint32_t temp_code = 0;
    int has_temp = 0;

    status = zerorate_settings_default(&settings);
    settings.every_temp = 57;
    if (status == ZERORATE_OK) {
        status = zerorate_correction_to_integer(&CORRECTION, &correction);
    }
    if (status == ZERORATE_OK) {
        status = zerorate_gyro_set_up(&gyro, &bus, &settings);
    }
    if (status == ZERORATE_OK) {
        status = zerorate_gyro_initialise(&gyro);
    }
    if (status != ZERORATE_OK) {
        board_report(zerorate_text(status));
        return 1;
    }
    board_rdy_interrupt(on_rdy);
    for (;;) {
        board_sleep();
        while (taken != written) {
            const zerorate_sample sample = queue[taken % QUEUE];

            BARRIER();
            taken = taken + 1;
            if (sample.has_temp) {
                temp_code = sample.temp_code;
                has_temp = 1;
            }
            if (sample.has_status && (sample.status & 1)) {
                failure = ZERORATE_E_OUT_OF_RANGE; /* the code may have wrapped (F-35) */
            } else if (has_temp) {
                board_use(zerorate_correct_integer(&correction, sample.rate_code, temp_code), sample.lost);
            }
        }
        restart_if_silent();
        if (failure != ZERORATE_OK) {
            board_report(zerorate_text(failure));
            failure = ZERORATE_OK;
        }
    }
}
