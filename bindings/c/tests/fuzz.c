/*
 * Calls every function of the header in random order, with null pointers, objects that were not set up, numbers of any
 * size, and a bus that fails or returns wrong bytes, as far as the contract allows. Sanitizers detect errors. Each
 * object has its own memory block, so that the sanitizers detect accesses outside it.
 *
 *     fuzz SEED CALLS
 */
#include "twin.h"
#include "zerorate.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static uint64_t state;

/* The random number generator xorshift64*. */
static uint64_t next(void)
{
    state ^= state >> 12;
    state ^= state << 25;
    state ^= state >> 27;
    return state * UINT64_C(2685821657736338717);
}

static uint32_t below(uint32_t bound)
{
    return (uint32_t)((next() >> 32) % bound);
}

/* Returns random bits, a limit of an integer type or of the codes, or a small number. */
static uint64_t integer(void)
{
    static const uint64_t ends[] = {0, 1, 2, 0x7FFF, 0x8000, 0xFFFF, 0x7FFFFF, 0x800000, 0xFFFFFF, 0x7FFFFFFF,
                                    0x80000000, 0xFFFFFFFF, INT64_MAX, UINT64_C(1) << 63, UINT64_MAX};

    switch (below(3)) {
    case 0: return next();
    case 1: return ends[below(sizeof ends / sizeof *ends)];
    default: return below(100);
    }
}

static double number(void)
{
    static const double ends[] = {0.0,   -0.0,   1.0,    -1.0,     1e-300,    5e-324,
                                  1e300, -1e300, 1.8e19, INFINITY, -INFINITY, NAN};
    uint64_t bits = next();
    double any;

    switch (below(4)) {
    case 0:
        memcpy(&any, &bits, sizeof any);
        return any;
    case 1: return ends[below(sizeof ends / sizeof *ends)];
    default: return ((double)below(2000001) - 1e6) * 1e-6 * (below(2) ? 0.1 : 30.0);
    }
}

static float single(void)
{
    return (float)number();
}

/* Returns one of three blocks of this size, so that calls share objects. Returns null in one call of twelve. */
static void *block(void **blocks, size_t size)
{
    void **chosen = &blocks[below(3)];

    if (below(12) == 0) {
        return NULL;
    }
    if (*chosen != NULL && below(64) == 0) {
        free(*chosen);
        *chosen = NULL;
    }
    if (*chosen == NULL) {
        *chosen = calloc(1, size);
        if (*chosen == NULL) {
            exit(3);
        }
    }
    return *chosen;
}

#define BLOCK(type) static void *type##s[3];
#define A(type) ((struct type *)block(type##s, sizeof(struct type)))

BLOCK(zerorate_gyro)
BLOCK(zerorate_corrector)
BLOCK(zerorate_procedure)
BLOCK(zerorate_tracker)
BLOCK(zerorate_correction)
BLOCK(zerorate_correction_f32)
BLOCK(zerorate_correction_integer)
BLOCK(zerorate_correction_curve)
BLOCK(zerorate_validity)
BLOCK(zerorate_corrected)
BLOCK(zerorate_settings)
BLOCK(zerorate_codes)
BLOCK(zerorate_sample)
BLOCK(zerorate_plan)
BLOCK(zerorate_outcome)
BLOCK(zerorate_self_test_plan)
BLOCK(zerorate_self_test)
BLOCK(zerorate_tracker_prior)
BLOCK(zerorate_tracker_state)
BLOCK(zerorate_tracked)

/* ---- the bus of the twin, which sometimes fails or returns wrong bytes ---- */

static void *rig;

static int32_t transfer(void *context, uint8_t *bytes, size_t length)
{
    size_t i;

    if (below(400) == 0) {
        return -1;
    }
    if (below(400) == 0) {
        for (i = 0; i < length; i++) {
            bytes[i] = (uint8_t)next();
        }
        return 0;
    }
    return zerorate_twin_transfer(context, bytes, length);
}

static int32_t rdy(void *context)
{
    return below(400) == 0 ? -1 : zerorate_twin_rdy(context);
}

static int32_t set(void *context, int32_t level)
{
    return below(40) == 0 ? -1 : zerorate_twin_self_test(context, level);
}

/* ---- calls ---- */

static struct zerorate_correction *correction(void)
{
    struct zerorate_correction *one = A(zerorate_correction);

    if (one != NULL && below(4) == 0) {
        one->pbc_dps = number();
        one->btc_dps_per_c = number();
        one->t3_c = number();
        one->btc2_dps_per_c2 = below(2) ? 0.0 : number();
        one->btc3_dps_per_c3 = below(2) ? 0.0 : number();
    }
    return one;
}

static struct zerorate_validity *validity(void)
{
    struct zerorate_validity *one = A(zerorate_validity);

    if (one != NULL) {
        one->temp_min_c = number();
        one->temp_max_c = number();
        one->margin_c = number();
    }
    return one;
}

static struct zerorate_tracker_prior *prior(void)
{
    struct zerorate_tracker_prior *one = A(zerorate_tracker_prior);

    if (one != NULL) {
        one->u_pbc_dps = below(2) ? 0.001 : number();
        one->u_btc_dps_per_c = below(2) ? 0.001 : number();
        one->cov_pbc_btc = below(2) ? 0.0 : number();
        one->white_dps_per_rt_hz = below(2) ? 0.0125 : number();
    }
    return one;
}

static struct zerorate_tracker_state *saved(void)
{
    struct zerorate_tracker_state *one = A(zerorate_tracker_state);

    if (one != NULL && below(4) == 0) {
        one->state[below(6)] = single();
        one->covariance[below(21)] = single();
        one->at_c = single();
        one->counts[below(3)] = (uint32_t)integer();
    }
    return one;
}

/* Returns a short plan. In one plan of four, one of the numbers and assume_linear are random. */
static struct zerorate_plan *plan(void)
{
    struct zerorate_plan *one = A(zerorate_plan);

    if (one == NULL || zerorate_plan_default(one) != ZERORATE_OK) {
        return one;
    }
    one->average_s = one->offset_s = 1.0;
    one->warmup_s = one->settle_s = 0.01;
    one->final_temp_s = 0.1;
    one->max_lost = one->max_u_btc_dps_per_c = 1.0;
    if (below(4) == 0) {
        double *const any[] = {&one->average_s,    &one->warmup_s, &one->settle_s,
                               &one->offset_s,     &one->max_lost, &one->max_u_btc_dps_per_c,
                               &one->final_temp_s, &one->earth_dps};

        *any[below(8)] = number();
        one->assume_linear = (uint8_t)next();
    }
    return one;
}

static struct zerorate_settings *settings(void)
{
    struct zerorate_settings *one = A(zerorate_settings);

    if (zerorate_settings_default(one) == ZERORATE_OK && below(2) == 0) {
        one->mclk_hz = (uint32_t)integer();
        one->every_temp = (uint16_t)integer();
        one->divider = (uint16_t)integer();
        one->divided = (uint16_t)integer();
        one->bits = below(2) ? 16 : (uint8_t)integer();
        one->per_byte_framing = (uint8_t)integer();
        one->rdy_rises = (uint8_t)integer();
        one->read_status = (uint8_t)integer();
    }
    return one;
}

static zerorate_status set_up(void)
{
    struct zerorate_bus bus = {rig, transfer, rdy, zerorate_twin_delay_us};

    bus.transfer = below(20) ? bus.transfer : NULL;
    bus.rdy = below(20) ? bus.rdy : NULL;
    bus.delay_us = below(20) ? bus.delay_us : NULL;
    return zerorate_gyro_set_up(A(zerorate_gyro), below(20) ? &bus : NULL, settings());
}

static zerorate_status sample(void)
{
    uint64_t t_ns = integer();
    uint32_t seq = (uint32_t)integer();

    if (below(4) != 0) {
        zerorate_twin_next_edge(rig, &t_ns, &seq);
    }
    return zerorate_gyro_sample(A(zerorate_gyro), t_ns, seq, A(zerorate_sample));
}

static zerorate_status self_test(void)
{
    struct zerorate_self_test_plan *one = A(zerorate_self_test_plan);
    struct zerorate_self_test_pin pin = {rig, below(20) ? set : NULL};

    if (one != NULL) {
        one->settle_us = below(2000);
        one->timeout_us = below(2000);
        one->samples = (uint16_t)below(64);
    }
    return zerorate_gyro_self_test(A(zerorate_gyro), below(20) ? &pin : NULL, one, A(zerorate_self_test));
}

/* Returns the time of a clock that goes forward, mostly by 10 ms, but sometimes so far that it wraps. */
static uint64_t later_ns(void)
{
    static uint64_t now_ns;

    now_ns += below(2000) ? 10000000 : integer() >> below(64);
    return now_ns;
}

/* Passes up to 400 samples with a rising temperature to the procedure. Each may be the last of a step. */
static zerorate_status feed(void)
{
    struct zerorate_procedure *procedure = A(zerorate_procedure);
    struct zerorate_sample *one = A(zerorate_sample);
    zerorate_status status = ZERORATE_E_NULL;
    uint32_t i, count = below(400);

    for (i = 0; i <= count; i++) {
        if (one != NULL) {
            one->t_ns = later_ns();
            one->seq = (uint32_t)(one->t_ns / 10000000);
            one->rate_code = below(5000) ? 0x800000 + below(4000) : (uint32_t)integer();
            one->temp_code = below(5000) ? 0x800000 + 1000 * i + below(4000) : (uint32_t)integer();
            one->lost = below(5000) ? 0 : (uint32_t)integer();
            one->bits = below(5000) ? 24 : (uint8_t)integer();
            one->has_temp = below(5000) ? 1 : (uint8_t)integer();
            one->has_status = (uint8_t)below(3);
            one->status = below(5000) ? 8 : (uint8_t)integer();
        }
        status = zerorate_procedure_sample(procedure, one);
    }
    return status;
}

static zerorate_status progress(void)
{
    double elapsed_s, total_s;

    return zerorate_procedure_progress(A(zerorate_procedure), below(9) ? &elapsed_s : NULL,
                                       below(9) ? &total_s : NULL);
}

static zerorate_status table(void)
{
    size_t room = below(300);
    int32_t *rows = malloc(room * sizeof *rows + 1); /* room may be 0 */
    struct zerorate_table laid_out = {NULL, 0, 0, 0, 0};
    int32_t row;
    zerorate_status status;
    int i;

    status = zerorate_table_lay_out(below(9) ? &laid_out : NULL, correction(), below(4) ? 0.02 * below(20) : number(),
                                    below(4) ? 0.12 * below(20) : number(), below(9) ? rows : NULL, room);
    for (i = 0; i < 8; i++) {
        zerorate_table_look_up(below(9) ? &laid_out : NULL, (uint32_t)integer(), below(9) ? &row : NULL);
    }
    free(rows);
    return status;
}

static zerorate_status push(void)
{
    struct zerorate_tracker *tracker = A(zerorate_tracker);
    zerorate_status status = ZERORATE_E_NULL;
    uint32_t i, count = below(60);

    for (i = 0; i <= count; i++) {
        status = zerorate_tracker_push(tracker, below(20) ? 0.001 * below(9) : number(), below(20) ? 25.0 : number());
    }
    return status;
}

static struct zerorate_correction_integer *line(void)
{
    struct zerorate_correction_integer *one = A(zerorate_correction_integer);

    if (one != NULL && below(4) == 0) {
        one->offset_q30 = (int64_t)integer();
        one->slope_q30 = (int32_t)integer();
        one->t3_code = (int32_t)integer();
    }
    return one;
}

static struct zerorate_correction_curve *curve(void)
{
    struct zerorate_correction_curve *one = A(zerorate_correction_curve);

    if (one != NULL && below(4) == 0) {
        one->terms[below(4)] = (int32_t)integer();
        one->t3_code = (int32_t)integer();
        one->fraction = below(2) ? 1 + below(16) : (uint32_t)integer();
    }
    return one;
}

static zerorate_status fault(void)
{
    zerorate_twin_set_fault(rig, below(4) ? 0 : (int32_t)below(5));
    zerorate_twin_delay_us(rig, below(2000));
    return ZERORATE_OK;
}

/* Makes a status for a function that returns none: ZERORATE_OK if its result can be used. */
static zerorate_status well(int is_used)
{
    return is_used ? ZERORATE_OK : ZERORATE_E_STATE;
}

#define KINDS 38

static zerorate_status call(uint32_t kind)
{
    switch (kind) {
    case 0: return zerorate_settings_default(A(zerorate_settings));
    case 1: return set_up();
    case 2: return zerorate_gyro_initialise(A(zerorate_gyro));
    case 3: return zerorate_gyro_read(A(zerorate_gyro), A(zerorate_codes));
    case 4: return zerorate_gyro_wait_ready(A(zerorate_gyro), below(3000));
    case 5: return sample();
    case 6: return zerorate_gyro_silent(A(zerorate_gyro), below(2) ? integer() : zerorate_twin_now_ns(rig));
    case 7: return zerorate_gyro_diagnose(A(zerorate_gyro));
    case 8: return zerorate_self_test_plan_default(A(zerorate_self_test_plan));
    case 9: return self_test();
    case 10: return fault();
    case 11: return zerorate_plan_default(A(zerorate_plan));
    case 12: return zerorate_procedure_begin(A(zerorate_procedure), plan());
    case 13: return well(zerorate_procedure_next(A(zerorate_procedure)) > 0);
    case 14: return well(zerorate_procedure_remedy(A(zerorate_procedure), (size_t)integer()) > 0);
    case 15: return zerorate_procedure_initialised(A(zerorate_procedure), later_ns());
    case 16: return feed();
    case 17: return zerorate_procedure_time(A(zerorate_procedure), later_ns());
    case 18: return well(zerorate_procedure_step(A(zerorate_procedure)) > 0);
    case 19: return progress();
    case 20: return zerorate_procedure_outcome(A(zerorate_procedure), A(zerorate_outcome));
    case 21: return zerorate_correction_to_f32(correction(), A(zerorate_correction_f32));
    case 22: return zerorate_correction_to_integer(correction(), A(zerorate_correction_integer));
    case 23: return zerorate_correction_to_curve(correction(), A(zerorate_correction_curve));
    case 24: return well(!isnan(zerorate_correct(correction(), number(), number())));
    case 25: return well(!isnan(zerorate_correct_f32(A(zerorate_correction_f32), single(), single())));
    case 26: return well(zerorate_correct_integer(line(), below(1u << 24), (uint32_t)integer()) >> 24 == 0);
    case 27: return well(zerorate_correct_curve(curve(), below(1u << 24), (uint32_t)integer()) >> 24 == 0);
    case 28: return zerorate_corrector_begin(A(zerorate_corrector), correction(), validity());
    case 29: return zerorate_corrector_take(A(zerorate_corrector), number(), number(), A(zerorate_corrected));
    case 30: return table();
    case 31: return zerorate_tracker_begin(A(zerorate_tracker), correction(), prior(), number());
    case 32: return zerorate_tracker_resume(A(zerorate_tracker), correction(), prior(), saved(), number());
    case 33: return push();
    case 34: return zerorate_tracker_bias(A(zerorate_tracker), number(), A(zerorate_tracked));
    case 35: return zerorate_tracker_save(A(zerorate_tracker), A(zerorate_tracker_state));
    case 36: return well(strlen(zerorate_text((zerorate_status)integer())) > 0);
    default: return well(zerorate_rate_dps((uint32_t)integer()) < zerorate_temp_c((uint32_t)integer()));
    }
}

int main(int argc, char **argv)
{
    unsigned long ok[KINDS] = {0}, i, calls;
    int missing = 0;

    if (argc != 3) {
        return 2;
    }
    state = 0x9E3779B97F4A7C15 ^ strtoull(argv[1], NULL, 10);
    calls = strtoul(argv[2], NULL, 10);
    rig = zerorate_twin_new("seed=3");
    for (i = 0; i < calls; i++) {
        uint32_t kind = below(KINDS);

        ok[kind] += call(kind) == ZERORATE_OK;
    }
    zerorate_twin_free(rig);
    for (i = 0; i < KINDS; i++) {
        if (ok[i] == 0) {
            printf("calls of kind %lu never succeeded\n", i);
            missing = 1;
        }
    }
    printf("%lu calls of %d kinds, seed %s\n", calls, KINDS, argv[1]);
    return missing;
}
