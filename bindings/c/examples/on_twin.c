/*
 * A first reading without a board: the driver reads the twin, a simulated part. README.md has the build commands.
 */
#include "twin.h"
#include "zerorate.h"

#include <stdio.h>

/* Number of readings in about a second (F-31). */
#define READINGS 5700

/* The correction of the twin with seed 1, from `zerorate calibrate --device twin:seed=1`. */
static const zerorate_correction CORRECTION = {.pbc_dps = 0.2578, .btc_dps_per_c = -0.0359, .t3_c = 32.51};

static zerorate_gyro gyro;

/* Takes the means over READINGS readings of the rate, the corrected rate and the temperature. */
static zerorate_status measure(double *rate_dps, double *corrected_dps, double *temp_c)
{
    zerorate_codes reading;
    zerorate_status status = ZERORATE_OK;
    int n;

    *rate_dps = *corrected_dps = *temp_c = 0.0;
    for (n = 0; n < READINGS; n++) {
        status = zerorate_gyro_wait_ready(&gyro, 2000);
        if (status == ZERORATE_OK) {
            status = zerorate_gyro_read(&gyro, &reading);
        }
        if (status != ZERORATE_OK) {
            return status;
        }
        const double rate = (double)zerorate_rate_dps(reading.rate_code);
        const double temp = (double)zerorate_temp_c(reading.temp_code);

        *rate_dps += rate / READINGS;
        *corrected_dps += zerorate_correct(&CORRECTION, rate, temp) / READINGS;
        *temp_c += temp / READINGS;
    }
    return ZERORATE_OK;
}

int main(void)
{
    void *twin = zerorate_twin_new("seed=1");
    const zerorate_bus bus = {twin, zerorate_twin_transfer, zerorate_twin_rdy, zerorate_twin_delay_us};
    zerorate_settings settings;
    zerorate_status status;
    double rate_dps, corrected_dps, temp_c;

    if (twin == NULL) {
        fprintf(stderr, "no twin of these keys\n");
        return 1;
    }
    status = zerorate_settings_default(&settings);
    if (status == ZERORATE_OK) {
        status = zerorate_gyro_set_up(&gyro, &bus, &settings);
    }
    if (status == ZERORATE_OK) {
        status = zerorate_gyro_initialise(&gyro);
    }
    if (status == ZERORATE_OK) {
        status = measure(&rate_dps, &corrected_dps, &temp_c);
    }
    zerorate_twin_free(twin);
    if (status != ZERORATE_OK) {
        fprintf(stderr, "%s\n", zerorate_text(status));
        return 1;
    }
    printf("rate %+.3f deg/s at %.2f degC, corrected %+.3f deg/s\n", rate_dps, temp_c, corrected_dps);
    return 0;
}
