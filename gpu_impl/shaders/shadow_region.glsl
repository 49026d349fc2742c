// The part of a ray between its first and its last shadow polygon, in which alone light and shadow can change.
//
// In free space a ray passes from light to shadow or back only where the line from the light to it passes something's
// silhouette, so on a shadow polygon (silhouettes.py). Between two of them, before the first and behind the last, all of
// the ray is as one of its points is, and the middle of such a part is the one that the shadow map's texels mistake last.
#include "shadow_lookup.glsl"

uniform sampler2D shadow_polygons;   // passes/shadow_volume.py

const float NO_CROSSING = 3e38;

// First and last shadow polygon, NO_CROSSING and its negative where there is none.
vec2 front_and_final() {
    vec2 found = texelFetch(shadow_polygons, ivec2(gl_FragCoord.xy), 0).xy;
    return vec2(found.x, -found.y);
}

// Whether a part of the ray lies in the dark: whether its middle does, or, with care, whether one of the four texels around
// its middle says so, which is for those who take samples there: in vain it costs them samples and nothing else.
bool is_dark(Ray ray, Light light, float begin, float end, bool care) {
    vec3 point = ray.o + 0.5 * (begin + end) * ray.d;
    if (!care || SHADOW_GIVEN == 1) return in_shadow(light, point);
    vec3 position = map_position(light, point);
    if (position.z < 0.0) return false;
    float here = distance_from(light, point);
    ivec2 corner = ivec2(floor((0.5 + 0.5 * position.xy) * float(tile_size) - 0.5));
    for (int i = 0; i < 4; ++i) {
        ivec2 texel = clamp(corner + ivec2(i & 1, i >> 1), ivec2(0), ivec2(tile_size - 1));
        if (here > stored_distance(texel, position)) return true;
    }
    return false;
}

// The shadow region within `range` of the ray, (begin, end): Algorithm 4.2 of Weng 2010, repaired. Before and behind it the
// ray is lit. It begins with the range where the eye is in a shadow volume, and ends with it where the end is dark; empty,
// at the range's end, where the ray meets no shadow.
vec2 shadow_region(Ray ray, Light light, vec2 range, bool care) {
    vec2 polygons = front_and_final();
    if (polygons.x > polygons.y) return is_dark(ray, light, range.x, range.y, care) ? range : range.yy;
    return vec2(is_dark(ray, light, range.x, polygons.x, care) ? range.x : polygons.x,
                is_dark(ray, light, polygons.y, range.y, care) ? range.y : polygons.y);
}
