// Walks that are begun again, 3 of 3: what walked on a chosen constraint before ends, if enough vertices were found along it, and
// its new pieces begin.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "walk.glsl"

layout(push_constant, std430) uniform Args {
    ReadU32x2 ends;
    ReadU32 spokes;
    U32 met;
    U32 runs;
    U32x4 pieces;
    U32 piece_met;
    U32 stops;
    U32 state;
    U32 words;
    uint constraints;
    uint piece_limit;
    uint stop_limit;
};

bool begins(uint slot) {
    return words.at[CHOSEN_FOUND + slot] >= words.at[CHOSEN_NEED + slot];
}

void main() {
    uint count = words.at[CHOSEN];
    uint buckets = words.at[BUCKETS];
    uint now = list_now(words, constraints + piece_limit);
    uint end = count == 0u ? 0u : words.at[WAITING];
    uint before = end - count * (buckets + 1u);
    for (uint i = item_index(); i < end; i += item_stride()) {
        if (i < before) {
            uint item = state.at[now + i];
            uint c = item < constraints ? item : pieces.at[item - constraints].x;
            for (uint slot = 0u; slot < count; slot++) {
                if (words.at[CHOSEN_LIST + slot] == c && begins(slot)) {
                    state.at[now + i] = NO_ITEM;
                }
            }
            continue;
        }
        uint slot = (i - before) / (buckets + 1u);
        uint number = (i - before) % (buckets + 1u);
        if (!begins(slot)) {
            continue;
        }
        uint c = words.at[CHOSEN_LIST + slot];
        uint run = words.at[CHOSEN_RUN] + slot * buckets;
        if (number == 0u) {
            // What its pieces met before is superfluous.
            if (runs.at[c] != NONE) {
                pieces.at[runs.at[c]].w = 0u;
            }
            pieces.at[run].w = NONE;
            runs.at[c] = run;
            uint known = met.at[c] & REVERSED;
            met.at[c] = known | AGAIN;
            state.at[c] = spokes.at[known != 0u ? ends.at[c].y : ends.at[c].x];
            state.at[now + i] = c;
            continue;
        }
        uint p = run + number - 1u;
        uint beginning = pieces.at[p].z;
        if (beginning != NO_PIECE) {
            uint vertex = beginning & HALF_EDGE;
            piece_met.at[p] = 1u;
            state.at[constraints + p] = spokes.at[vertex];
            state.at[now + i] = constraints + p;
            uint place = words.at[STOPS] < MOST_STOPS ? atomicAdd(words.at[STOPS], 1u) : MOST_STOPS;
            if (place < stop_limit) {
                stops.at[3u * place] = constraints + p;
                stops.at[3u * place + 1u] = 0u;
                stops.at[3u * place + 2u] = vertex;
            }
        }
    }
}
