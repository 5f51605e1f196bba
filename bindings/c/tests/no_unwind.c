/* The twin, like Rust's own precompiled libraries for a host, refers to a function for unwinding. Nothing unwinds. */
#include <stdlib.h>

void rust_eh_personality(void);

void rust_eh_personality(void)
{
    abort();
}
