// Tallies in words that many invocations count in: those that include this say before what WORDS are.
#ifndef TALLIES_GLSL
#define TALLIES_GLSL

// Adds to a number of two words, the low one first.
void add_wide(WORDS words, uint at, uint value) {
    uint old = atomicAdd(words.at[at], value);
    if (old + value < old) {
        atomicAdd(words.at[at + 1u], 1u);
    }
}

#endif
