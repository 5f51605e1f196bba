/*
 * Makes the same computations with the C interface as lab/src/c/expected.rs does with the Rust crates, and prints the
 * results. Both programs must print the same, on a host and on a microcontroller. "unit.h" is the header that
 * `zerorate export --format c` writes for CORRECTION. */
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "twin.h"
#include "unit.h"
#include "zerorate.h"

#define SAMPLES 500
#define ROWS 201

static const zerorate_correction CURVED = {
    .pbc_dps = -0.25, .btc_dps_per_c = -0.04, .t3_c = 26.0, .btc2_dps_per_c2 = 0.0005, .btc3_dps_per_c3 = -2e-6};
static const zerorate_correction CORRECTION = {.pbc_dps = -0.25, .btc_dps_per_c = -0.04, .t3_c = 26.0};

static void print_f64(const char *name, double value)
{
    uint64_t bits;

    memcpy(&bits, &value, sizeof bits);
    printf("%s %08" PRIx32 "%08" PRIx32 "\n", name, (uint32_t)(bits >> 32), (uint32_t)bits);
}

static void print_f32(const char *name, float value)
{
    uint32_t bits;

    memcpy(&bits, &value, sizeof bits);
    printf("%s %08" PRIx32 "\n", name, bits);
}

static void print_status(const char *what, zerorate_status status)
{
    printf("%s %ld\n", what, (long)status);
}

static void print_row(const char *what, const zerorate_table *table, uint32_t temp_code)
{
    int32_t row_udps = 77;
    const zerorate_status status = zerorate_table_look_up(table, temp_code, &row_udps);

    printf("%s %ld %ld\n", what, (long)status, (long)row_udps);
}

static zerorate_bus bus_of(void *rig)
{
    const zerorate_bus bus = {rig, zerorate_twin_transfer, zerorate_twin_rdy, zerorate_twin_delay_us};

    return bus;
}

/* A bus whose transfer number `fails_in` fails, counted from 1. The transfers after it work again. */
typedef struct {
    void *rig;
    int32_t fails_in;
} broken_transfer;

static int32_t transfer_or_not(void *context, uint8_t *bytes, size_t length)
{
    broken_transfer *bus = context;

    if (bus->fails_in > 0 && --bus->fails_in == 0) {
        return -1;
    }
    return zerorate_twin_transfer(bus->rig, bytes, length);
}

/* Sets up and initialises a gyroscope on a new twin with these keys. Returns the twin, or null. */
static void *started(const char *keys, uint32_t mclk_hz, zerorate_gyro *gyro)
{
    void *rig = zerorate_twin_new(keys);
    const zerorate_bus bus = bus_of(rig);
    zerorate_settings settings;

    zerorate_settings_default(&settings);
    settings.mclk_hz = mclk_hz;
    if (rig == NULL || zerorate_gyro_set_up(gyro, &bus, &settings) != ZERORATE_OK) {
        printf("no twin of %s\n", keys);
        return NULL;
    }
    print_status("initialise", zerorate_gyro_initialise(gyro));
    return rig;
}

/* Reads the next sample. Returns ZERORATE_E_TIMEOUT if no edge comes. */
static zerorate_status next_sample(void *rig, zerorate_gyro *gyro, zerorate_sample *sample)
{
    zerorate_status status = ZERORATE_NOTHING;
    uint64_t t_ns;
    uint32_t seq;

    while (status == ZERORATE_NOTHING) {
        if (!zerorate_twin_next_edge(rig, &t_ns, &seq)) {
            return ZERORATE_E_TIMEOUT;
        }
        status = zerorate_gyro_sample(gyro, t_ns, seq, sample);
    }
    return status;
}

static void misuse(void)
{
    zerorate_gyro gyro;
    zerorate_settings settings;
    zerorate_bus bus = bus_of(NULL);
    zerorate_codes reading;
    zerorate_plan plan;
    zerorate_procedure procedure;
    zerorate_correction steep = {.pbc_dps = 0.0, .btc_dps_per_c = 2.0, .t3_c = 25.0};
    zerorate_correction_integer integer;
    zerorate_correction_curve curve;
    zerorate_table table;
    int32_t rows[13];

    memset(&gyro, 0, sizeof gyro);
    memset(&procedure, 0, sizeof procedure);
    memset(&table, 0, sizeof table);
    zerorate_settings_default(&settings);
    zerorate_plan_default(&plan);
    print_status("no settings", zerorate_settings_default(NULL));
    print_status("no gyro", zerorate_gyro_set_up(NULL, &bus, &settings));
    print_status("not set up", zerorate_gyro_read(&gyro, &reading));
    print_status("not begun", zerorate_procedure_next(&procedure));
    settings.bits = 7;
    print_status("seven bits", zerorate_gyro_set_up(&gyro, &bus, &settings));
    settings.bits = 24;
    bus.transfer = NULL;
    print_status("no transfer", zerorate_gyro_set_up(&gyro, &bus, &settings));
    plan.average_s = 0.0;
    print_status("no average", zerorate_procedure_begin(&procedure, &plan));
    print_status("steep", zerorate_correction_to_integer(&steep, &integer));
    print_status("curved", zerorate_correction_to_integer(&CURVED, &integer));
    steep.btc2_dps_per_c2 = 20.0;
    print_status("steep curve", zerorate_correction_to_curve(&steep, &curve));
    print_status("ragged", zerorate_table_lay_out(&table, &CORRECTION, 0.02, 0.03, rows, 3));
    print_status("no room", zerorate_table_lay_out(&table, &CORRECTION, 0.02, 0.12, rows, 3));
    print_status("no table", zerorate_table_look_up(&table, 1, rows));
    print_status("laid out", zerorate_table_lay_out(&table, &CORRECTION, 0.02, 0.12, rows, 13));
    print_row("above", &table, UINT32_C(0xFFFFFF));
    print_row("below", &table, 0);
    print_status("no row", zerorate_table_look_up(&table, 1, NULL));
    printf("no correction %lu\n", (unsigned long)zerorate_correct_integer(NULL, 77, 1));
    printf("%s. %s.\n", zerorate_text(ZERORATE_E_TIMEOUT), zerorate_text(12345));
}

static void take(zerorate_corrector *corrector, double rate_dps, double temp_c)
{
    zerorate_corrected corrected = {7.0, 7.0, 7};

    print_status("taken", zerorate_corrector_take(corrector, rate_dps, temp_c, &corrected));
    print_f64("rate_dps", corrected.rate_dps);
    print_f64("temp_c", corrected.temp_c);
    printf("extrapolated %u\n", (unsigned)corrected.extrapolated);
}

/* Corrects a stream: no temperature yet, a temperature, no new one, an invalid rate, a temperature beyond the span. */
static void stream(void)
{
    const zerorate_validity valid = {25.0, 33.0, 0.5};
    zerorate_corrector corrector;

    memset(&corrector, 0, sizeof corrector);
    take(&corrector, 0.5, 30.0);
    print_status("no correction", zerorate_corrector_begin(&corrector, NULL, &valid));
    print_status("begin", zerorate_corrector_begin(&corrector, &CORRECTION, &valid));
    take(&corrector, 0.5, (double)NAN);
    take(&corrector, 0.5, 30.0);
    take(&corrector, -0.25, (double)NAN);
    take(&corrector, (double)NAN, 33.25);
    take(&corrector, 0.125, 34.0);
    print_status("begin", zerorate_corrector_begin(&corrector, &CORRECTION, NULL));
    take(&corrector, 0.125, 34.0);
    print_status("nowhere", zerorate_corrector_take(&corrector, 0.5, 30.0, NULL));
}

static void bias(zerorate_tracker *tracker)
{
    zerorate_tracked tracked = {7.0, 7.0, 7};

    print_status("bias", zerorate_tracker_bias(tracker, 27.0, &tracked));
    print_f64("change_dps", tracked.change_dps);
    print_f64("u_dps", tracked.u_dps);
    printf("phase %u\n", (unsigned)tracked.phase);
}

static void push(zerorate_tracker *tracker, int blocks, double rate_dps)
{
    while (blocks-- > 0) {
        (void)zerorate_tracker_push(tracker, rate_dps, 26.0);
    }
    bias(tracker);
}

/* Tracks a minute at rest, 0.004 deg/s above the calibration, a rotation and a rest. Then resumes after a day, and
 * from an invalid state. */
static void track(void)
{
    const zerorate_tracker_prior prior = {0.003, 0.003, 0.0, 0.0125};
    static zerorate_tracker tracker;
    zerorate_tracker_state state;

    bias(&tracker);
    print_status("begin", zerorate_tracker_begin(&tracker, &CORRECTION, &prior, 0.0));
    push(&tracker, 600, 0.254);
    push(&tracker, 20, 5.254);
    push(&tracker, 400, 0.254);
    print_status("push", zerorate_tracker_push(&tracker, (double)NAN, 26.0));
    print_status("save", zerorate_tracker_save(&tracker, &state));
    printf("learned %u\n", (unsigned)state.counts[0]);
    print_status("resume", zerorate_tracker_resume(&tracker, &CORRECTION, &prior, &state, 86400.0));
    bias(&tracker);
    state.covariance[0] = -1.0;
    print_status("unsound", zerorate_tracker_resume(&tracker, &CORRECTION, &prior, &state, 0.0));
}

/* Codes that must not count as readings: codes before the first conversion, wrapped codes, and bytes after a failed
 * transfer. */
static void no_numbers(void)
{
    zerorate_gyro gyro;
    zerorate_codes reading = {7, 7};
    zerorate_settings settings;
    void *rig = zerorate_twin_new("seed=1");
    zerorate_bus bus = bus_of(rig);
    broken_transfer broken = {rig, 0};

    bus.context = &broken;
    bus.transfer = transfer_or_not;
    bus.rdy = NULL;
    zerorate_settings_default(&settings);
    print_status("framing", settings.per_byte_framing);
    print_status("set up", zerorate_gyro_set_up(&gyro, &bus, &settings));
    print_status("without initialisation", zerorate_gyro_read(&gyro, &reading));
    print_status("initialise", zerorate_gyro_initialise(&gyro));
    print_status("before the first conversion", zerorate_gyro_read(&gyro, &reading));
    zerorate_twin_delay_us(rig, 400);
    print_status("converted", zerorate_gyro_read(&gyro, &reading));
    zerorate_twin_set_fault(rig, 3);
    reading.rate_code = reading.temp_code = 7;
    print_status("dip", zerorate_gyro_read(&gyro, &reading));
    print_status("initialise", zerorate_gyro_initialise(&gyro));
    zerorate_twin_delay_us(rig, 400);
    broken.fails_in = 2;
    print_status("broken", zerorate_gyro_read(&gyro, &reading));
    print_status("after it", zerorate_gyro_read(&gyro, &reading));
    print_status("initialise", zerorate_gyro_initialise(&gyro));
    zerorate_twin_delay_us(rig, 400);
    printf("untouched %" PRIu32 " %" PRIu32 "\n", reading.rate_code, reading.temp_code);
    print_status("whole", zerorate_gyro_read(&gyro, &reading));
    print_status("heard", zerorate_gyro_silent(&gyro, 5));
    print_status("quiet", zerorate_gyro_silent(&gyro, 11000000));
    print_status("silent", zerorate_gyro_silent(&gyro, 12000000));
    zerorate_twin_free(rig);
    rig = started("seed=1,rotation_dps=360", 6000000, &gyro);
    zerorate_twin_delay_us(rig, 400);
    print_status("beyond the scale", zerorate_gyro_read(&gyro, &reading));
    zerorate_twin_free(rig);
}

static void samples(const char *keys)
{
    zerorate_gyro gyro;
    zerorate_sample sample;
    zerorate_codes reading;
    zerorate_correction_integer integer;
    zerorate_correction_curve curve;
    zerorate_correction_f32 single, curved;
    zerorate_table table;
    static int32_t rows[ROWS];
    void *rig = started(keys, 6000000, &gyro);
    int i;

    print_status("integer", zerorate_correction_to_integer(&CORRECTION, &integer));
    print_status("curve", zerorate_correction_to_curve(&CURVED, &curve));
    print_status("curved", zerorate_correction_to_f32(&CURVED, &curved));
    print_status("single", zerorate_correction_to_f32(&CORRECTION, &single));
    print_status("table", zerorate_table_lay_out(&table, &CORRECTION, 0.02, 2.0, rows, ROWS));
    for (i = 0; i < SAMPLES; i++) {
        const zerorate_status status = next_sample(rig, &gyro, &sample);
        float corrected_dps;
        uint32_t bits;
        int32_t by_library, by_header;
        bool inside;

        if (status != ZERORATE_OK || !sample.has_temp) {
            print_status("sample", status);
            break;
        }
        corrected_dps =
            zerorate_correct_f32(&single, zerorate_rate_dps(sample.rate_code), zerorate_temp_c(sample.temp_code));
        memcpy(&bits, &corrected_dps, sizeof bits);
        inside = zerorate_table_look_up(&table, sample.temp_code, &by_library) == ZERORATE_OK;
        inside &= zerorate_table_lookup_udps(sample.temp_code, &by_header);
        if (!inside)
            printf("outside ");
        printf("%" PRIu32 " %" PRIu32 " %" PRIu32 " %" PRIu32 " %" PRIu32 " %" PRIu32 " %" PRIx32 " %ld %" PRIu32
               " %ld\n",
               (uint32_t)sample.t_ns, sample.seq, sample.rate_code, sample.temp_code, sample.lost,
               zerorate_correct_integer(&integer, sample.rate_code, sample.temp_code), bits,
               (long)by_library,
               zerorate_correct_code(sample.rate_code, sample.temp_code),
               (long)by_header);
        corrected_dps =
            zerorate_correct_f32(&curved, zerorate_rate_dps(sample.rate_code), zerorate_temp_c(sample.temp_code));
        memcpy(&bits, &corrected_dps, sizeof bits);
        printf("curve %" PRIu32 " %" PRIx32 "\n",
               zerorate_correct_curve(&curve, sample.rate_code, sample.temp_code), bits);
    }
    print_f64("f64", zerorate_correct(&CORRECTION, 0.33, 33.5));
    print_f64("curved f64", zerorate_correct(&CURVED, 0.33, 33.5));
    printf("no curve %lu\n", (unsigned long)zerorate_correct_curve(NULL, 77, 1));
    print_status("curved table", zerorate_table_lay_out(&table, &CURVED, 0.02, 2.0, rows, ROWS));
    print_row("curved row", &table, UINT32_C(8416794));
    print_status("wait", zerorate_gyro_wait_ready(&gyro, 1000));
    print_status("read", zerorate_gyro_read(&gyro, &reading));
    printf("%" PRIu32 " %" PRIu32 "\n", reading.rate_code, reading.temp_code);
    print_status("diagnose", zerorate_gyro_diagnose(&gyro));
    zerorate_twin_set_fault(rig, 1);
    print_status("zeros", zerorate_gyro_diagnose(&gyro));
    zerorate_twin_set_fault(rig, 2);
    print_status("ones", zerorate_gyro_initialise(&gyro));
    zerorate_twin_set_fault(rig, 3);
    print_status("dip", zerorate_gyro_diagnose(&gyro));
    print_status("again", zerorate_gyro_initialise(&gyro));
    zerorate_twin_set_fault(rig, 4);
    print_status("cut", zerorate_gyro_wait_ready(&gyro, 1000));
    zerorate_twin_free(rig);
}

/* The self-test pin of a twin. It fails at call number `refused_call`, and sets `fault` when it goes high. */
typedef struct {
    void *rig;
    int32_t refused_call;
    int32_t fault;
    int32_t calls;
    int32_t level;
} test_pin;

static int32_t set_test_pin(void *context, int32_t level)
{
    test_pin *pin = context;

    if (++pin->calls == pin->refused_call) {
        return -1;
    }
    pin->level = level;
    if (level == 1) {
        zerorate_twin_set_fault(pin->rig, pin->fault);
    }
    return zerorate_twin_self_test(pin->rig, level);
}

static int32_t broken_rdy(void *context)
{
    (void)context;
    return -1;
}

/* Runs a self-test that must fail. Prints the calls and the level of the pin, and `n`, which must still be 7. */
static void failing_test(const char *what, zerorate_gyro *gyro, test_pin pin)
{
    const zerorate_self_test_pin set = {&pin, set_test_pin};
    const zerorate_self_test_plan plan = {1000, 1000, 16};
    zerorate_self_test seen = {0.0F, 0.0F, 7};

    print_status(what, zerorate_gyro_self_test(gyro, &set, &plan, &seen));
    printf("calls %ld level %ld n %lu\n", (long)pin.calls, (long)pin.level, (unsigned long)seen.n);
    zerorate_twin_set_fault(pin.rig, 0);
}

/* Runs a self-test on a bus in which a function is missing or fails. */
static void lacking_test(const char *what, zerorate_bus bus)
{
    const test_pin pin = {bus.context, 0, 0, 0, 0};
    zerorate_gyro gyro;
    zerorate_settings settings;

    zerorate_settings_default(&settings);
    zerorate_gyro_set_up(&gyro, &bus, &settings);
    failing_test(what, &gyro, pin);
}

static void failing_tests(void *rig, zerorate_gyro *gyro)
{
    const test_pin pins[] = {{rig, 1, 0, 0, 0}, {rig, 2, 0, 0, 0}, {rig, 3, 0, 0, 0},
                             {rig, 0, 4, 0, 0}, {rig, 0, 1, 0, 0}};
    const char *const names[] = {"low refused", "high refused", "release refused", "cut", "zeros"};
    zerorate_gyro blank;
    zerorate_bus bus = bus_of(rig);
    size_t i;

    for (i = 0; i < sizeof pins / sizeof pins[0]; i++) {
        failing_test(names[i], gyro, pins[i]);
    }
    memset(&blank, 0, sizeof blank);
    failing_test("not set up", &blank, pins[3]);
    bus.rdy = broken_rdy;
    lacking_test("broken rdy", bus);
    bus.rdy = NULL;
    lacking_test("no rdy", bus);
    bus = bus_of(rig);
    bus.delay_us = NULL;
    lacking_test("no delay", bus);
}

static void self_test(const char *keys)
{
    zerorate_gyro gyro;
    zerorate_self_test_plan plan;
    zerorate_self_test seen;
    void *rig = started(keys, 6000000, &gyro);
    test_pin pin = {rig, 0, 0, 0, 0};
    zerorate_self_test_pin set = {&pin, set_test_pin};

    print_status("plan", zerorate_self_test_plan_default(&plan));
    printf("%lu %lu %u\n", (unsigned long)plan.settle_us, (unsigned long)plan.timeout_us, (unsigned)plan.samples);
    plan.samples = 500;
    print_status("self-test", zerorate_gyro_self_test(&gyro, &set, &plan, &seen));
    print_f32("shift_dps", seen.shift_dps);
    print_f32("u_dps", seen.u_dps);
    printf("n %lu calls %ld level %ld\n", (unsigned long)seen.n, (long)pin.calls, (long)pin.level);
    printf("until %" PRIu32 "\n", (uint32_t)zerorate_twin_now_ns(rig));
    print_status("no pin", zerorate_gyro_self_test(&gyro, NULL, &plan, &seen));
    print_status("no plan", zerorate_gyro_self_test(&gyro, &set, NULL, &seen));
    print_status("no result", zerorate_gyro_self_test(&gyro, &set, &plan, NULL));
    set.set = NULL;
    print_status("no function", zerorate_gyro_self_test(&gyro, &set, &plan, &seen));
    failing_tests(rig, &gyro);
    zerorate_twin_free(rig);
}

static void calibrate(const char *keys)
{
    zerorate_gyro gyro;
    zerorate_procedure procedure;
    zerorate_plan plan;
    zerorate_outcome outcome;
    zerorate_sample sample;
    void *rig = started(keys, 1000000, &gyro);
    zerorate_status status;
    double elapsed_s;
    double total_s;
    size_t index;
    uint8_t remedy;

    zerorate_plan_default(&plan);
    plan.average_s = 2.0;
    plan.warmup_s = 20.0;
    plan.settle_s = 10.0;
    plan.offset_s = 6.0;
    plan.final_temp_s = 0.5;
    plan.max_u_btc_dps_per_c = 0.05;
    plan.earth_dps = 0.003;
    plan.assume_linear = 1;
    print_status("begin", zerorate_procedure_begin(&procedure, &plan));
    print_status("too early", zerorate_procedure_outcome(&procedure, &outcome));
    status = zerorate_procedure_next(&procedure);
    print_status("first", status == ZERORATE_INITIALISE ? ZERORATE_OK : status);
    zerorate_procedure_initialised(&procedure, zerorate_twin_now_ns(rig));
    while ((status = zerorate_procedure_next(&procedure)) == ZERORATE_SAMPLE) {
        status = next_sample(rig, &gyro, &sample);
        if (status != ZERORATE_OK) {
            print_status("sample", status);
            break;
        }
        zerorate_procedure_sample(&procedure, &sample);
    }
    print_status("ended", status == ZERORATE_DONE ? ZERORATE_OK : status);
    printf("remedies [");
    for (index = 0; (remedy = zerorate_procedure_remedy(&procedure, index)) != 0; index++) {
        printf("%s%u", index > 0 ? "," : "", (unsigned)remedy);
    }
    printf("]\n");
    zerorate_procedure_progress(&procedure, &elapsed_s, &total_s);
    printf("step %ld\n", (long)zerorate_procedure_step(&procedure));
    print_f64("elapsed_s", elapsed_s);
    print_f64("total_s", total_s);
    status = zerorate_procedure_outcome(&procedure, &outcome);
    print_status("outcome", status);
    if (status == ZERORATE_OK) {
        print_f64("pbc_dps", outcome.correction.pbc_dps);
        print_f64("btc_dps_per_c", outcome.correction.btc_dps_per_c);
        print_f64("t3_c", outcome.correction.t3_c);
        print_f64("u_pbc_dps", outcome.u_pbc_dps);
        print_f64("u_btc_dps_per_c", outcome.u_btc_dps_per_c);
        print_f64("u_t3_c", outcome.u_t3_c);
        print_f64("b1_dps", outcome.b1_dps);
        print_f64("b2_dps", outcome.b2_dps);
        print_f64("t1_c", outcome.t1_c);
        print_f64("t2_c", outcome.t2_c);
        print_f64("temp_min_c", outcome.temp_min_c);
        print_f64("temp_max_c", outcome.temp_max_c);
        print_f64("white", outcome.white_dps_per_rt_hz);
        print_f64("rate_hz", outcome.rate_hz);
        printf("samples %lu lost %lu warnings %lu\n", (unsigned long)outcome.samples, (unsigned long)outcome.lost,
               (unsigned long)outcome.warnings);
    }
    zerorate_twin_free(rig);
}

int main(int argc, char **argv)
{
    const char *seed = argc > 1 ? argv[1] : "1";
    const char *quick = "mclk_hz=1000000,warmup_s=10,curvature=0,hysteresis=0";
    char keys[160];

    misuse();
    stream();
    track();
    no_numbers();
    snprintf(keys, sizeof keys, "seed=%s", seed);
    samples(keys);
    self_test(keys);
    snprintf(keys, sizeof keys, "seed=%s,%s", seed, quick);
    calibrate(keys);
    snprintf(keys, sizeof keys, "seed=%s,%s,motion=sway", seed, quick);
    calibrate(keys);
    return 0;
}
