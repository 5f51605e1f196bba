/*
 * A main loop without interrupts: waits for RDY, reads, corrects.
 * This example was not run on a board. The tests run it on the twin.
 */
#include "board.h"
#include "zerorate.h"

static zerorate_gyro gyro;

/* The coefficients of your calibration. `zerorate export --format c` writes them as a header. */
static const zerorate_correction CORRECTION = {.pbc_dps = -0.25, .btc_dps_per_c = -0.04, .t3_c = 31.5};

int main(void)
{
    const zerorate_bus bus = {NULL, board_spi_transfer, board_rdy, board_delay_us};
    zerorate_settings settings;
    zerorate_correction_integer correction;
    zerorate_codes reading;
    zerorate_status status;

    status = zerorate_settings_default(&settings);
    if (status == ZERORATE_OK) {
        status = zerorate_correction_to_integer(&CORRECTION, &correction);
    }
    if (status == ZERORATE_OK) {
        status = zerorate_gyro_set_up(&gyro, &bus, &settings);
    }
    if (status == ZERORATE_OK) {
        status = zerorate_gyro_initialise(&gyro);
    }
    for (;;) {
        if (status == ZERORATE_OK) {
            status = zerorate_gyro_wait_ready(&gyro, 2000);
        }
        if (status == ZERORATE_OK) {
            status = zerorate_gyro_read(&gyro, &reading);
        }
        if (status == ZERORATE_OK) {
            board_use(zerorate_correct_integer(&correction, reading.rate_code, reading.temp_code), 0);
        } else {
            /* there was no edge in time, the rate is out of range, or the supply or a line has failed */
            board_report(zerorate_text(status));
            board_delay_us(NULL, 100000);
            if (status == ZERORATE_E_NO_READING || status == ZERORATE_E_OUT_OF_RANGE) {
                status = ZERORATE_OK; /* the part is well: try again */
            } else {
                status = zerorate_gyro_initialise(&gyro);
            }
        }
    }
}
