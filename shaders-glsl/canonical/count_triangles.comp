// Each finite triangle goes to the list of its smallest vertex, by name: which corner that is (the lower two bits), and the
// place in the list (the rest), in the order of arrival. NONE for every other slot. Ghost triangles are counted.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "items.glsl"

#extension GL_KHR_shader_subgroup_ballot : require

layout(push_constant, std430) uniform Args {
    ReadRows triangles;
    ReadU32 names;
    U32 counts;
    WriteU32 places;
    U32 ghosts;
    MaybeReadU32 counter; // of slots
    uint limit;
    uint count; // of vertices
};

void main() {
    uint t = item_index();
    bool ghost = false;
    if (t < length_of(counter, limit)) {
        uvec3 v = corners(triangles, t);
        uint place = NONE;
        if (all(lessThan(v, uvec3(count)))) {
            uvec3 name = uvec3(names.at[v.x], names.at[v.y], names.at[v.z]);
            uint k = name.x < name.y && name.x < name.z ? 0u : name.y < name.z ? 1u : 2u;
            place = atomicAdd(counts.at[v[k]], 1u) << 2 | k;
        } else {
            ghost = v.x != DELETED;
        }
        places.at[t] = place;
    }
    uvec4 ballot = subgroupBallot(ghost);
    uint found = subgroupBallotBitCount(ballot);
    if (found != 0u && subgroupElect()) {
        atomicAdd(ghosts.at[0], found);
    }
}
