// Which way each triangle looks, and in how many shadow volumes the eye is.
//
// The eye is in a triangle's volume where the way to the light meets the triangle. The coordinates are float32 and all is
// computed in double, so that neighbours agree on whose side of their edge the way passes.
#include "shadow_faces/buffers.glsl"
layout(local_size_x = GROUP) in;

uniform vec3 eye;
uniform uint triangle_count;

// A way that meets an edge or a corner, as it does in scenes drawn with a ruler, is on nobody's side; turned by so much,
// in directions that are nobody's, it is.
const dvec3 NUDGE = dvec3(0.61803398875, -0.41421356237, 0.30277563773) * 1e-9;

void main() {
    // the groups of one axis may be too few
    uint number = gl_GlobalInvocationID.x + gl_GlobalInvocationID.y * gl_NumWorkGroups.x * gl_WorkGroupSize.x;
    if (number >= triangle_count) return;
    uvec4 triangle = triangles[number];
    // as the eye sees them
    dvec3 a = dvec3(vertices[triangle.x].xyz) - dvec3(eye), b = dvec3(vertices[triangle.y].xyz) - dvec3(eye),
          c = dvec3(vertices[triangle.z].xyz) - dvec3(eye);
    dvec3 to_light = DIRECTIONAL == 1 ? -dvec3(light.direction) : dvec3(light.position) - dvec3(eye);
    dvec3 normal = cross(b - a, c - a);
    facing[number] = int(sign(dot(normal, DIRECTIONAL == 1 ? to_light : to_light - a)));
    dvec3 way = to_light + NUDGE * length(to_light);
    dvec3 side = dvec3(dot(way, cross(a, b)), dot(way, cross(b, c)), dot(way, cross(c, a)));
    if (min(min(side.x, side.y), side.z) <= 0.0 && max(max(side.x, side.y), side.z) >= 0.0) return;
    // the way passes the triangle's plane at the share height / slope of it
    double slope = dot(normal, way), height = dot(normal, a);
    if (height * slope <= 0.0) return;
    bool faces_light = slope > 0.0;
    if (DIRECTIONAL == 0 && abs(height) > abs(slope)) atomicAdd(parts[triangle.w].around_light, faces_light ? 1 : -1);
    else if (faces_light) atomicAdd(parts[triangle.w].towards, 1);
    else atomicAdd(parts[triangle.w].away, 1);
}
