// What insertion begins with: the sites that were taken out, each with its heir, then the missing points, each with the site
// that owns its pixel, or that one's heir.
#version 460
#extension GL_GOOGLE_include_directive : require
layout(local_size_x_id = 0, local_size_x = 256) in;
#include "buffers.glsl"
#include "groups.glsl"

layout(push_constant, std430) uniform Args {
    ReadU32 taken;
    ReadU32 taken_count;
    ReadU32 heirs;
    ReadU32 sites; // how many
    ReadU32 pixels;
    ReadU32 colors;
    WriteU32 points;
    WriteU32 starts;
    WriteU32 count;
    uint width;
    uint limit; // of points
};

const uint NONE = 0xffffffffu;

void main() {
    uint i = group_index() * WORKGROUP + gl_LocalInvocationIndex;
    uint site_count = min(sites.at[0], limit);
    uint first = min(taken_count.at[0], site_count);
    uint end = first + (limit - site_count);
    if (i == 0u) {
        count.at[0] = end;
    }
    if (i < first) {
        uint site = taken.at[i];
        points.at[i] = site;
        starts.at[i] = heirs.at[site];
    } else if (i < end) {
        uint point = site_count + (i - first);
        uint pixel = pixels.at[point];
        uint owner = colors.at[(pixel >> 16) * width + (pixel & 0xffffu)];
        points.at[i] = point;
        starts.at[i] = owner < site_count ? heirs.at[owner] : NONE;
    }
}
