// Joint bilateral upsampling (Kopf et al. 2007; Weng 2010, section 1.2: "Bilateral filter"), guided by depth and normal:
// the four nearest evaluated pixels, bilinear where they see one surface (cells.frag.glsl: a plane by its normal, or one
// depth), and elsewhere weighted by how well their distance agrees with this pixel's too.
#include "upsampling/parts/guides.glsl"

const float DISTANCE_SIGMA = 0.02;   // relative difference of distance at which a neighbour counts a quarter
const float LEAST_NEAR = 1e-4;       // of a neighbour's weight, for pixels on a line of the lattice whose two do not fit

vec4 upsampled(ivec2 pixel) {
    Place place = place_of(pixel);
    vec4 there = corner_distances(place.cell);
    if (agree(there)) return interpolated(place.cell, place.fraction);
    vec2 x = vec2(1.0 - place.fraction.x, place.fraction.x), y = vec2(1.0 - place.fraction.y, place.fraction.y);
    vec4 apart = distances_apart(there, distance_seen(pixel)) / DISTANCE_SIGMA, fit = 1.0 + apart * apart;
    vec4 weight = (vec4(x * y.x, x * y.y) + LEAST_NEAR) / (fit * fit);
    vec4 sum = vec4(0.0);
    for (int i = 0; i < 4; ++i) sum += weight[i] * texelFetch(scattering, corner_of(place.cell, i), 0);
    return sum / dot(weight, vec4(1.0));
}
