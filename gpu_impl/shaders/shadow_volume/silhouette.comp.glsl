// Gathers the edges of one light's silhouette; why these are all, silhouettes.py says. CULL is 1 where polygons that
// change nothing are left out: those outside a spot's cone, and those behind something that hides their edge.
#include "shadow_lookup.glsl"
#include "shadow_volume/edges.glsl"
layout(local_size_x = 128) in;

// a scene's edges (silhouettes.py): two vertices, where the edge's opposite vertices begin, how many there are
layout(std430, binding = 4) readonly restrict buffer Edges { uvec4 edges[]; };
layout(std430, binding = 5) readonly restrict buffer Opposite { uint opposite[]; };

uniform Light light;
uniform uint edge_count;

// Whether triangles lie strictly on both sides of the plane through light and edge.
bool is_split(uvec4 edge, vec3 a, vec3 b) {
    vec3 along = b - a, normal = shadow_plane(light, a, b);
    // The sign of a vertex's height over the plane is beyond doubt above some roundings of the three factors' lengths.
    vec3 away = away_from(light, a);
    float rounding = 1e-12 * dot(away, away) * dot(along, along);
    bool above = false, below = false;
    for (uint i = edge.z; i < edge.z + edge.w; ++i) {
        vec3 across = vertices[opposite[i]].xyz - a;
        float height = dot(normal, across);
        bool sure = height * height > rounding * dot(across, across);
        above = above || (sure && height > 0.0);
        below = below || (sure && height < 0.0);
    }
    return above && below;
}

// Whether the polygon behind an edge has no part in a spot's cone.
bool is_outside_cone(vec3 a, vec3 b) {
#if SPOT == 0
    return false;
#endif
    vec3 u = normalize(a - light.position), v = normalize(b - light.position), axis = light.direction;
    float nearest = max(dot(u, axis), dot(v, axis));
    // the direction between u and v that is nearest to the axis, where it is neither of them
    vec3 normal = cross(u, v);
    float sine2 = dot(normal, normal);
    vec3 foot = axis - normal * (dot(normal, axis) / max(sine2, 1e-30));
    if (sine2 > 1e-10 && dot(cross(u, foot), normal) > 0.0 && dot(cross(foot, v), normal) > 0.0)
        nearest = length(foot);
    return nearest < cos(light.cutoff_angle) - 1e-5;
}

const float ROUNDING = 1e-5;   // of a distance in the map, generously
const int MOST_TEXELS = 8;   // on a side, that an edge may cover and still be looked up

// Distance from the light beyond which an edge's polygon changes nothing: that of the furthest surface that the shadow
// map has on the edge and around it. Behind that, the map has no light on either side of the polygon. A gap that the map
// resolves has edges of its own.
float end_of_polygon(vec3 a, vec3 b) {
    float seen = uintBitsToFloat(reach);
    vec3 from = map_position(light, a), to = map_position(light, b);
    if (from.z < 0.0 || from.z != to.z) return seen;
    ivec2 first = min(texel_of(from), texel_of(to)) - 1, last = max(texel_of(from), texel_of(to)) + 1;
    if (any(lessThan(first, ivec2(0))) || any(greaterThanEqual(last, ivec2(tile_size)))) return seen;
    if (any(greaterThanEqual(last - first, ivec2(MOST_TEXELS)))) return seen;
    float furthest = 0.0;
    for (int y = first.y; y <= last.y; ++y)
        for (int x = first.x; x <= last.x; ++x) furthest = max(furthest, stored_distance(ivec2(x, y), from));
    return min(furthest * (1.0 + ROUNDING), seen);
}

float nearest_point(vec3 a, vec3 b) {
    if (DIRECTIONAL == 1) return min(distance_from(light, a), distance_from(light, b));
    vec3 along = b - a;
    float share = clamp(dot(light.position - a, along) / max(dot(along, along), 1e-30), 0.0, 1.0);
    return distance(light.position, a + share * along);
}

void main() {
    // the groups of one axis may be too few
    uint number = gl_GlobalInvocationID.x + gl_GlobalInvocationID.y * gl_NumWorkGroups.x * gl_WorkGroupSize.x;
    if (number >= edge_count) return;
    uvec4 edge = edges[number];
    vec3 a = vertices[edge.x].xyz, b = vertices[edge.y].xyz;
    if (is_split(edge, a, b)) return;
    float end = uintBitsToFloat(reach);
    float nearest = nearest_point(a, b);
#if CULL == 1
    if (is_outside_cone(a, b)) return;
    end = end_of_polygon(a, b);
    if (nearest > end) return;
#endif
    if (DIRECTIONAL == 0) end /= nearest;
    silhouette[atomicAdd(corners, QUAD_CORNERS) / QUAD_CORNERS] = uvec4(edge.xy, floatBitsToUint(end), 0u);
}
