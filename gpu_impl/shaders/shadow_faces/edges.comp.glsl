// The edges at which shadow volumes have faces. Each triangle that casts has a volume of its own, with a face behind each
// of its edges; where the triangles at an edge cancel, the face is inside a volume and is left out.
#include "shadow_faces/buffers.glsl"
layout(local_size_x = 128) in;

uniform uint edge_count;
uniform uint part_count;

const uint FULL_SCREEN = 3u, QUAD = 6u;   // corners

// Which side of a closed part's triangles casts: that on which the light enters the body or, from a light within, leaves
// it. So what lies behind the body is in one volume, and what the light shares with it in none.
int casting_side(uint part) { return parts[part].around_light > 0 ? -1 : 1; }

void main() {
    // the groups of one axis may be too few
    uint number = gl_GlobalInvocationID.x + gl_GlobalInvocationID.y * gl_NumWorkGroups.x * gl_WorkGroupSize.x;
    if (number < part_count) {
        Part part = parts[number];
        if (number == 0u) atomicAdd(inside, part.towards + part.away);
        else atomicAdd(inside, casting_side(number) > 0 ? part.towards : part.away);
    }
    if (number >= edge_count) return;
    uvec4 edge = edges[number];
    int volumes = 0;
    for (uint i = edge.z; i < edge.z + edge.w; ++i) {
        uint triangle = sides[i] >> 1, part = triangles[triangle].w;
        int looks = facing[triangle];
        if (part == 0u || looks == casting_side(part)) volumes += (sides[i] & 1u) == 0u ? looks : -looks;
    }
    if (volumes == 0) return;
    faces[(atomicAdd(corners, QUAD) - FULL_SCREEN) / QUAD] =
        Face(vec4(vertices[edge.x].xyz, float(volumes)), vec4(vertices[edge.y].xyz, 0.0));
}
