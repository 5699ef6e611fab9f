// Sub-constraints claim triangles: the least word says who owns one.
#ifndef CLAIMS_GLSL
#define CLAIMS_GLSL

#include "insert.glsl"

void lose(U32 lost, U32 words, uint s) {
    if ((atomicOr(lost.at[s], LOSES) & LOSES) == 0u) {
        atomicAdd(words.at[LOSERS], 1u);
    }
}

// Claims triangle t for a sub-constraint. Who finds a lower word loses, and whose word is replaced. Whether the
// triangle remains with another.
bool own(U32 state, U32 lost, U32 words, uint s, uint word, uint t, uint stamp, bool lost_before) {
    if (lost_before && state.at[OWNED(t)] < word) {
        // Whatever is there was there before, or is less yet.
        return true;
    }
    uint old = atomicMin(state.at[OWNED(t)], word);
    if (old == FREE) {
        state.at[STAMP(t)] = ~stamp;
    } else if (!same_owner(old, word)) {
        if (old < word) {
            if (!lost_before) {
                lose(lost, words, s);
            }
            return true;
        }
        lose(lost, words, owner_of(old));
        if (words.at[HUBS] != 0u) {
            // It may have been owned since an earlier round, by one that did not meet this one then.
            state.at[STAMP(t)] = ~stamp;
            words.at[STOLEN] = 1u;
        }
    }
    return lost_before;
}

#endif
