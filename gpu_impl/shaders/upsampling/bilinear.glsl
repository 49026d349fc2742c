// Plain interpolation between the four nearest evaluated pixels, whatever they see.
#include "upsampling/parts/lattice.glsl"

vec4 upsampled(ivec2 pixel) {
    Place place = place_of(pixel);
    return interpolated(place.cell, place.fraction);
}
