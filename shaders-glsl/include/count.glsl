// A length that the host knows, or one that a kernel wrote, which the host bounds.
#ifndef COUNT_GLSL
#define COUNT_GLSL

#include "buffers.glsl"

uint length_of(MaybeReadU32 counter, uint limit) {
    return present(counter) ? min(counter.at[0], limit) : limit;
}

#endif
