// Every N-th pixel of the image, in x and in y.
#include "lattice.glsl"

vec2 position_of(ivec2 cell) { return vec2(pixel_of(cell)) + 0.5; }
