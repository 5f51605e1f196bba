/* The functions of the twin, a simulated part, for the tests. */
#ifndef ZERORATE_TWIN_H
#define ZERORATE_TWIN_H

#include <stddef.h>
#include <stdint.h>

/* Makes a twin from keys such as "seed=7,warmup_s=30". Returns null if they are invalid. `rig` below is the twin. */
void *zerorate_twin_new(const char *keys);
void zerorate_twin_free(void *rig);
int32_t zerorate_twin_transfer(void *rig, uint8_t *bytes, size_t length);
int32_t zerorate_twin_rdy(void *rig);
void zerorate_twin_delay_us(void *rig, uint32_t us);
int32_t zerorate_twin_self_test(void *rig, int32_t level);
uint64_t zerorate_twin_now_ns(void *rig);
/* Waits for the next falling edge of RDY. Returns 1, and writes its time and number, or 0 if none comes in 0.1 s. */
int32_t zerorate_twin_next_edge(void *rig, uint64_t *t_ns, uint32_t *seq);
/* Sets a fault: 0 or any other number none, 1 SDO at zeros, 2 SDO at ones, 3 a dip of the supply, 4 RDY cut. */
void zerorate_twin_set_fault(void *rig, int32_t fault);

#endif
