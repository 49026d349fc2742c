// Lit intervals of each cell's ray that were found by other means than OpenGL's (given.py), in place of the shadow map.
#include "current_ray.glsl"
#include "light.glsl"

// other passes ask the shadow map
#ifndef SHADOW_GIVEN
#define SHADOW_GIVEN 0
#endif

#if SHADOW_GIVEN == 1
layout(std430, binding = 6) readonly buffer GivenOffsets { uint given_offsets[]; };
layout(std430, binding = 7) readonly buffer GivenIntervals { vec2 given_intervals[]; };   // begin and length
uniform int cells_in_row;

// Where in `given_intervals` those of this ray begin and end. Their t is counted from where the camera's ray begins.
uvec2 given_range() {
    int cell = int(gl_FragCoord.y) * cells_in_row + int(gl_FragCoord.x);
    return uvec2(given_offsets[cell], given_offsets[cell + 1]);
}

// Whether a point of this ray lies in none of them. Outside a spot's cone nothing hides the light, as in a shadow map, and
// whoever asks has to know that there is none.
bool in_given_shadow(Light light, vec3 point) {
    if (falloff(light, point) == 0.0) return false;
    float t = dot(point - current_ray.o, current_ray.d) + current_start;
    uvec2 range = given_range();
    for (uint i = range.x; i < range.y; ++i) {
        float past = t - given_intervals[i].x;
        if (past >= 0.0 && past <= given_intervals[i].y) return false;
    }
    return true;
}
#endif
