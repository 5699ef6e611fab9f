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

// The least word is that of the owner, unless the owner is DONE. The word before, FREE in place of one that is.
uint claim_word(U32 state, U32 lost, uint t, uint word) {
    uint old = atomicMin(state.at[OWNED(t)], word);
    if (!is_done(lost, old)) {
        return old;
    }
    if (word < old || atomicCompSwap(state.at[OWNED(t)], old, word) == old) {
        return FREE;
    }
    // Another one has taken it.
    return atomicMin(state.at[OWNED(t)], word);
}

// Claims triangle t for a sub-constraint. Who finds a lower word loses, and whose word is replaced. Whether the
// triangle remains with another.
bool own(
    U32 state, U32 lost, U32 words, uint s, uint word, uint t, uint stamp, bool lost_before, bool by_flips
) {
    if (lost_before) {
        uint now = state.at[OWNED(t)];
        if (now < word && !is_done(lost, now)) {
            // Whatever is there was there before, or is less yet.
            return true;
        }
    }
    uint old = claim_word(state, lost, t, word);
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
