// Shift: after a batch of rounds of pinning, unpinning or taking out, counts them and gets the words ready for the next.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shift.glsl"

layout(push_constant, std430) uniform Args {
    U32 words;
    U32 slots;
    uint phase;  // 0 pin, 1 unpin, 2 take out
    uint rounds; // of a batch
};

void main() {
    if (first_item() != 0u) {
        return;
    }
    uint counts = phase == 0u ? PIN_COUNTS : phase == 1u ? UNPIN_COUNTS : OUT_COUNTS;
    uint chain = phase == 2u ? words.at[CHAIN] : 0u;
    uint sum = 0u;
    uint busy = 0u;
    for (uint k = 0u; k < rounds; k++) {
        uint count = words.at[counts + k];
        sum += count;
        busy += uint(count != 0u && (chain == 0u || k < chain));
    }
    if (phase == 2u && words.at[OUT_ROUNDS] == 0u) {
        words.at[STUCK] = words.at[OUT_COUNTS];
    }
    uint left = chain == 0u ? words.at[counts + rounds] : 0u;
    for (uint k = 0u; k < 32u; k++) {
        words.at[counts + k] = k == 0u ? left : 0u;
        if (phase == 2u) {
            words.at[OUT_WINNERS + k] = 0u;
            words.at[OUT_DEFERRED + k] = 0u;
            words.at[OUT_EDGES + k] = 0u;
            words.at[OUT_SECOND + k] = 0u;
        }
    }
    if (phase == 0u) {
        words.at[PIN_ROUNDS] += busy;
        words.at[PIN_BASE] += sum;
        words.at[PIN_LEFT] = left;
        if (left == 0u && words.at[UNPIN_STARTED] == 0u) {
            words.at[UNPIN_STARTED] = 1u;
            words.at[UNPIN_COUNTS] = words.at[PIN_BASE];
            words.at[BAD] = words.at[PIN_BASE];
        }
    } else if (phase == 1u) {
        words.at[UNPIN_ROUNDS] += busy;
        words.at[UNPIN_BASE] += rounds;
        words.at[PIN_LEFT] = max(words.at[PIN_LEFT], left);
        words.at[UNPIN_STARTED] = words.at[UNPIN_STARTED] == 0u ? 0u : 2u;
    } else {
        words.at[OUT_ROUNDS] += busy;
        words.at[OUT_LEFT] = left;
        words.at[CHAIN] = 0u;
        if (chain != 0u) {
            words.at[EMPTY] = 1u;
            slots.at[0] = 0u;
        }
    }
}
