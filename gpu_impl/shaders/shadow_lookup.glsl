// The shadow map: distance from the light to the nearest surface, one texel per direction. A narrow spot and
// parallel light have one tile; any other light has the six faces of a cube side by side.
#include "contract.glsl"
#include "given.glsl"

#ifdef SHADOW_BUFFER
layout(std430, binding = SHADOW_BUFFER) readonly buffer ShadowTexels { float shadow_texels[]; };
#else
uniform sampler2D shadow_map;
#endif
uniform int tile_size;      // texels on a side
uniform float texel_slope;  // width of a texel at distance 1, or anywhere in parallel light
uniform mat4 tile_matrix;   // world to clip space of the one tile
uniform mat3 map_frame;     // axes of the cube

vec3 in_map_frame(vec3 direction) { return direction * map_frame; }

// Where in a cube a direction in its frame is looked up: position in its tile, -1 to 1, and the number of the tile
// (shadow_map.py).
vec3 position_in_cube(vec3 d) {
    vec3 a = abs(d);
    if (a.x >= a.y && a.x >= a.z) return d.x > 0.0 ? vec3(d.zy / a.x, 0.0) : vec3(-d.z / a.x, d.y / a.x, 1.0);
    if (a.y >= a.z) return d.y > 0.0 ? vec3(d.xz / a.y, 2.0) : vec3(-d.x / a.y, d.z / a.y, 3.0);
    return d.z > 0.0 ? vec3(-d.x / a.z, d.y / a.z, 4.0) : vec3(d.xy / a.z, 5.0);
}

vec3 tile_position(vec3 from_light) { return position_in_cube(in_map_frame(from_light)); }

// One of the rows of tile_matrix without its translation: a tile's x, y and viewing axis.
vec3 tile_row(int i) { return vec3(tile_matrix[0][i], tile_matrix[1][i], tile_matrix[2][i]); }

// Position in a tile, -1 to 1, and the tile's number; the number is negative outside a flat map.
vec3 map_position(Light light, vec3 point) {
#if TILES == 1
    vec4 clip = tile_matrix * vec4(point, 1.0);
    if (clip.w <= 0.0 || max(abs(clip.x), abs(clip.y)) >= clip.w) return vec3(0.0, 0.0, -1.0);
    return vec3(clip.xy / clip.w, 0.0);
#else
    return tile_position(point - light.position);
#endif
}

ivec2 texel_of(vec3 position) {
    return min(ivec2((0.5 + 0.5 * position.xy) * float(tile_size)), ivec2(tile_size - 1));
}

float stored_distance(ivec2 texel, vec3 position) {
    COUNT_READ;
    texel.x += int(position.z) * tile_size;
#ifdef SHADOW_BUFFER
    return shadow_texels[texel.y * TILES * tile_size + texel.x];
#else
    return texelFetch(shadow_map, texel, 0).r;
#endif
}

// Distance to the nearest surface in the direction of `point`; without end outside a flat map: there a spot sheds no
// light, and parallel light meets nothing.
float nearest_surface(Light light, vec3 point) {
    vec3 position = map_position(light, point);
    return position.z < 0.0 ? 3e38 : stored_distance(texel_of(position), position);
}

// What the map holds distances of.
float distance_from(Light light, vec3 point) {
    return DIRECTIONAL == 1 ? dot(point - light.position, light.direction) : distance(point, light.position);
}

#if SHADOW_GIVEN == 1
// The map is left aside: `point` is one of this invocation's ray.
bool in_shadow(Light light, vec3 point) { return in_given_shadow(light, point); }
#else
bool in_shadow(Light light, vec3 point) { return distance_from(light, point) > nearest_surface(light, point); }
#endif
