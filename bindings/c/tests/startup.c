/* Start-up code of the test image for the board mps2-an386: the vectors, the floating-point unit, then newlib. */
#include <stdint.h>

extern uint32_t stack_top[];
extern void _start(void);

void reset_handler(void);
void fault_handler(void);

void reset_handler(void)
{
    volatile uint32_t *const cpacr = (volatile uint32_t *)0xE000ED88u;

    *cpacr |= 0xFu << 20;
    __asm volatile("dsb\n isb");
    _start();
    for (;;) {
    }
}

/* Ends the emulator with an error, by semihosting. */
void fault_handler(void)
{
    register uint32_t number __asm("r0") = 0x18;
    register uint32_t reason __asm("r1") = 0x20023;

    __asm volatile("bkpt 0xAB" : : "r"(number), "r"(reason) : "memory");
    for (;;) {
    }
}

__attribute__((section(".vectors"), used)) static void (*const vectors[15])(void) = {
    reset_handler, fault_handler, fault_handler, fault_handler, fault_handler, fault_handler,
};
