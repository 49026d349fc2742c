// Joint bilateral upsampling (Weng 2010, section 1.2: "Bilateral filter"): the four nearest evaluated pixels, weighted
// by their closeness in the image and by how well their surface distance and normal agree with this pixel's.
#include "upsampling/lattice.glsl"

const float DISTANCE_SIGMA = 0.05;   // relative difference of distance at which a neighbour counts 1/e

vec4 upsampled(ivec2 pixel) {
    vec4 here = seen(pixel);
    Corners corners = corners_of(pixel);
    vec4 sum = vec4(0.0);
    float total = 0.0;
    for (int i = 0; i < 4; ++i) {
        vec4 there = seen(evaluated_pixel(corners.at[i]));
        float apart = abs(there.w - here.w) / (DISTANCE_SIGMA * min(there.w, here.w));
        // a background has no normal: there the distance alone decides
        float agree = dot(here.xyz, here.xyz) * dot(there.xyz, there.xyz) > 0.0 ? max(dot(there.xyz, here.xyz), 0.0) : 1.0;
        // never quite zero: where no neighbour fits, the nearest still fill the pixel
        float weight = (corners.near[i] + 1e-4) * (exp(-apart) * agree + 1e-6);
        sum += weight * texelFetch(scattering, corners.at[i], 0);
        total += weight;
    }
    return sum / total;
}
