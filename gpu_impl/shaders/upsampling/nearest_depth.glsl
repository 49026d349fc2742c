// Nearest-depth upsampling (Jansen and Bavoil 2011): bilinear where the four nearest evaluated pixels agree, and where
// they do not, the one whose distance is nearest to this pixel's. They publish agreement with the pixel; among the four
// it decides better before thin things, which differ from all of them, and costs nothing here.
#include "upsampling/parts/guides.glsl"

vec4 upsampled(ivec2 pixel) {
    Place place = place_of(pixel);
    vec4 there = corner_distances(place.cell);
    if (agree(there)) return interpolated(place.cell, place.fraction);
    vec4 apart = distances_apart(there, distance_seen(pixel));
    int nearest = 0;
    for (int i = 1; i < 4; ++i)
        if (apart[i] < apart[nearest]) nearest = i;
    return texelFetch(scattering, corner_of(place.cell, nearest), 0);
}
