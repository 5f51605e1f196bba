/* Tries a packed library: numbers come out, and a bus that fails is an error. */
#include <stdio.h>
#include "zerorate.h"

static zerorate_gyro gyro;

static int32_t no_answer(void *context, uint8_t *bytes, size_t length)
{
    (void)context;
    (void)bytes;
    (void)length;
    return 1;
}

int main(void)
{
    const zerorate_correction correction = {-0.25, -0.04, 31.5};
    const zerorate_bus bus = {NULL, no_answer, NULL, NULL};
    zerorate_correction_integer integer;
    zerorate_settings settings;

    if (zerorate_correction_to_integer(&correction, &integer) != ZERORATE_OK) {
        return 1;
    }
    printf("%lu\n", (unsigned long)zerorate_correct_integer(&integer, 8500000, 8400000));
    zerorate_settings_default(&settings);
    if (zerorate_gyro_set_up(&gyro, &bus, &settings) != ZERORATE_OK) {
        return 1;
    }
    printf("%s\n", zerorate_text(zerorate_gyro_initialise(&gyro)));
    return 0;
}
