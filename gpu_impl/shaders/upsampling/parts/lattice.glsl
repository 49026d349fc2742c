// What an upsampling knows of the lattice. It defines
//     vec4 upsampled(ivec2 pixel)
// the value at any pixel of the image.
#include "camera_ray.glsl"
#include "lattice.glsl"

uniform sampler2D scattering;            // evaluated on every N-th pixel; interpolates, and ends in its border's values
uniform sampler2D normal_and_distance;   // at full resolution; distance 0 where there is no surface

// A cell is the square between four evaluated pixels; the first column and row lie half outside the lattice.
struct Place { ivec2 cell; vec2 fraction; };

Place place_of(ivec2 pixel) {
    vec2 at = vec2(pixel - first_pixel) / float(downsample), corner = floor(at);
    return Place(ivec2(corner) + 1, at - corner);
}

// Bilinear interpolation between the cell's corners. The fractions are multiples of 1 / N, which the eight bits that
// hardware gives them hold exactly for N up to 8.
vec4 interpolated(ivec2 cell, vec2 fraction) {
    return textureLod(scattering, (vec2(cell) - 0.5 + fraction) / vec2(textureSize(scattering, 0)), 0.0);
}

// Which evaluated pixel is the cell's i-th corner, 0 to 3.
ivec2 corner_of(ivec2 cell, int i) {
    return clamp(cell - 1 + ivec2(i & 1, i >> 1), ivec2(0), textureSize(scattering, 0) - 1);
}
