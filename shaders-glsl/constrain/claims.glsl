// Sub-constraints claim triangles: the least word says who owns one.
#ifndef CLAIMS_GLSL
#define CLAIMS_GLSL

#include "insert.glsl"

void lose(U32 lost, U32 words, uint s) {
    if ((atomicOr(lost.at[s], LOSES) & LOSES) == 0u) {
        atomicAdd(words.at[LOSERS], 1u);
    }
}

bool is_done(U32 lost, uint word) {
    return word != FREE && lost.at[owner_of(word)] == DONE;
}

// A sub-constraint has claimed triangle t by the least of its word and the one there, which was `old`. Whoever is DONE owns nothing.
// Who finds a lower word loses, and whose word is replaced. Whether the sub-constraint has lost, here or before.
bool settle_claim(
    U32 state, U32 lost, U32 words, uint s, uint word, uint old, uint t, uint stamp, bool lost_before, bool by_flips
) {
    if (is_done(lost, old)) {
        if (word < old || atomicCompSwap(state.at[OWNED(t)], old, word) == old) {
            old = FREE;
        } else {
            // Another one has taken it.
            old = atomicMin(state.at[OWNED(t)], word);
        }
    }
    if (old == FREE || (same_owner(old, word) && !by_flips)) {
        // Should the chain be too long by now, all its triangles are new to those that are flipped.
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
