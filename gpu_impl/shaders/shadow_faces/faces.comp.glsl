// The faces of shadow volumes. Each triangle that casts has a volume of its own, with a face behind each of its edges;
// where the triangles at an edge cancel, the face is inside a volume and is left out. The triangle itself is the volume's
// cap: a ray ends on it, but where the near plane has cut it away; only caps that begin before that plane are faces here.
//
// A sum of floats depends on its order, and faces are to come in one order however invocations run: each work group has a
// stretch of the buffer and a draw call of its own, and in it a face stands behind those with lower numbers.
#include "shadow_faces/buffers.glsl"
layout(local_size_x = GROUP) in;

uniform uint edge_count;
uniform uint triangle_count;
uniform uint part_count;
uniform vec3 eye;
uniform vec3 viewing_axis;
uniform float near;

const uint FULL_SCREEN = 3u, QUAD = 6u;   // corners

shared uint found[GROUP / 32];   // a bit for each invocation that has a face

// Which side of a closed part's triangles casts: that on which the light enters the body or, from a light within, leaves
// it. So what lies behind the body is in one volume, and what the light shares with it in none.
int casting_side(uint part) { return parts[part].around_light > 0 ? -1 : 1; }

// How a triangle looks at the light, where it casts; else 0.
int casts(uint triangle) {
    uint part = triangles[triangle].w;
    int looks = facing[triangle];
    return part == 0u || looks == casting_side(part) ? looks : 0;
}

Face face_behind(uvec4 edge) {
    int volumes = 0;
    for (uint i = edge.z; i < edge.z + edge.w; ++i) {
        int looks = casts(sides[i] >> 1);
        volumes += (sides[i] & 1u) == 0u ? looks : -looks;
    }
    return Face(vec4(vertices[edge.x].xyz, float(volumes)), vec4(vertices[edge.y].xyz, 0.0), vec4(0.0));
}

Face cap(uint triangle) {
    vec3 a = vertices[triangles[triangle].x].xyz, b = vertices[triangles[triangle].y].xyz,
         c = vertices[triangles[triangle].z].xyz;
    vec3 depth = vec3(dot(a - eye, viewing_axis), dot(b - eye, viewing_axis), dot(c - eye, viewing_axis));
    bool cut_away = any(lessThan(depth, vec3(near))) && any(greaterThan(depth, vec3(0.0)));
    // the picture's first row is the rasteriser's last, so that its front is where the normal does not look
    return Face(vec4(a, cut_away ? -float(casts(triangle)) : 0.0), vec4(b, 0.0), vec4(c, 1.0));
}

void main() {
    // the groups of one axis may be too few
    uint group = gl_WorkGroupID.x + gl_WorkGroupID.y * gl_NumWorkGroups.x, place = gl_LocalInvocationIndex;
    uint number = group * GROUP + place;
    if (number < part_count) {
        Part part = parts[number];
        if (number == 0u) atomicAdd(draws[0].inside, part.towards + part.away);
        else atomicAdd(draws[0].inside, casting_side(number) > 0 ? part.towards : part.away);
    }
    Face face = Face(vec4(0.0), vec4(0.0), vec4(0.0));
    if (number < edge_count) face = face_behind(edges[number]);
    else if (number - edge_count < triangle_count) face = cap(number - edge_count);

    if (place < GROUP / 32) found[place] = 0u;
    barrier();
    if (face.a.w != 0.0) atomicOr(found[place / 32], 1u << (place % 32));
    barrier();
    uint before = 0u, all = 0u;
    for (uint word = 0u; word < GROUP / 32; ++word) {
        uint lower = word < place / 32 ? 0xFFFFFFFFu : word == place / 32 ? (1u << (place % 32)) - 1u : 0u;
        before += bitCount(found[word] & lower);
        all += bitCount(found[word]);
    }
    if (face.a.w != 0.0) faces[group * GROUP + before] = face;
    // behind the draw call of all of the picture; the last groups may have no numbers
    if (place == 0u && number < edge_count + triangle_count) {
        draws[group + 1].corners = QUAD * all;
        draws[group + 1].instances = 1u;
        draws[group + 1].first = FULL_SCREEN + QUAD * GROUP * group;
        draws[group + 1].base = 0u;
    }
}
