// What the upsamplings that keep edges know of the evaluated pixels (cells.frag.glsl) and of the pixel itself.
#include "upsampling/parts/lattice.glsl"

uniform sampler2D cells;   // distances of the four corners, negative where they see one surface

const float BACKGROUND = 1e30;   // where there is no surface the background is one, infinitely far

float distance_seen(ivec2 pixel) {
    float found = texelFetch(normal_and_distance, pixel, 0).w;
    return found > 0.0 ? found : BACKGROUND;
}

vec4 corner_distances(ivec2 cell) { return texelFetch(cells, cell, 0); }

bool agree(vec4 corner_distances) { return corner_distances.x < 0.0; }

// Relative differences of distance, 0 to 1.
vec4 distances_apart(vec4 there, float here) { return abs(there - here) / max(there, vec4(here)); }
