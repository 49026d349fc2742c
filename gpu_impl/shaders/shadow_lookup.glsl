// The shadow map: distance from the light to the nearest surface, one texel per direction. A spot has one tile; a point
// light has the six faces of a cube side by side.
#include "contract.glsl"

uniform sampler2D shadow_map;
uniform mat4 tile_matrix[TILES];   // world to clip space of each tile
uniform int tile_size;             // texels on a side

int tile_of(vec3 from_light) {
    if (TILES == 1) return 0;
    vec3 a = abs(from_light);
    if (a.x >= a.y && a.x >= a.z) return from_light.x > 0.0 ? 0 : 1;
    if (a.y >= a.z) return from_light.y > 0.0 ? 2 : 3;
    return from_light.z > 0.0 ? 4 : 5;
}

// Distance to the nearest surface in the direction of `point`; without end outside the map, where a spot sheds no light.
float nearest_surface(Light light, vec3 point) {
    int tile = tile_of(point - light.position);
    vec4 clip = tile_matrix[tile] * vec4(point, 1.0);
    if (clip.w <= 0.0 || any(greaterThanEqual(abs(clip.xy), vec2(clip.w)))) {
        if (TILES == 1) return 3e38;
        clip.xy = clamp(clip.xy, -clip.w, clip.w);
    }
    ivec2 texel = min(ivec2((0.5 + 0.5 * clip.xy / clip.w) * float(tile_size)), ivec2(tile_size - 1));
    return texelFetch(shadow_map, texel + ivec2(tile * tile_size, 0), 0).r;
}

bool in_shadow(Light light, vec3 point) { return distance(point, light.position) > nearest_surface(light, point); }
