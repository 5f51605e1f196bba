/* The twin and Rust's precompiled libraries for a host refer to this function for unwinding. Nothing calls it. */
#include <stdlib.h>

void rust_eh_personality(void);

void rust_eh_personality(void)
{
    abort();
}
