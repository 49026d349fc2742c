// Every texel of the shadow map that the ray crosses: what the map says of the ray, without steps.
//
// The distance in a texel is that of all directions in it, but for the surface that ends the ray (seen_surface.glsl). Along
// the ray the distance to the light grows on both sides of the place nearest to it, so what a texel lets light reach is an
// interval around that place, and a node of the pyramid that reaches further than its part of the ray, or less far, needs
// no closer look.
//
// Progress is counted in whole texels: each step leaves a node by a border, and the border says in which texel the next one
// begins. Only the other coordinate asks where the line is, and stays within the node. No step is nudged.
#include "light.glsl"
#include "visibility/parts/map_line.glsl"
#include "visibility/parts/seen_surface.glsl"
#include "visibility/parts/shadow_pyramid.glsl"

const float FARTHEST = 1e18;   // its square is finite in float32

// A ray through the light has no direction from it there. It is led round it by a hair, which costs no length that float32
// can tell, and what rounding leaves of `nearest`, a share of the light's distance, is such a ray's.
const float BESIDE = 2e-7, HAIR = 1e-12;

// A direction at right angles to d.
vec3 across(vec3 d) {
    return normalize(abs(d.x) < 0.6 ? vec3(0.0, -d.z, d.y) : vec3(d.z, 0.0, -d.x));
}

// How the distance to the light grows on both sides of the nearest place: the distance there, and `aside`, how far it is
// from the light's projection, which is 0 unless that lies outside the range; in parallel light the cosine between the two
// directions.
struct Approach { float nearest; float aside; };

// How far from the nearest place light comes, where the map holds a least and a largest distance; negative where it does
// not come to the nearest place.
vec2 reach(Approach approach, vec2 stored) {
    stored = min(stored, FARTHEST);
    vec2 beyond = stored - approach.nearest;
#if DIRECTIONAL == 1
    return beyond / max(approach.aside, 1e-18);
#else
    // of x^2 + 2 aside x = stored^2 - nearest^2 the root without cancellation
    vec2 square = beyond * (stored + approach.nearest);
    vec2 root = max(sqrt(max(square + approach.aside * approach.aside, 0.0)) + approach.aside, 1e-18);
    return vec2(square.x < 0.0 ? -1.0 : square.x / root.x, square.y < 0.0 ? -1.0 : square.y / root.y);
#endif
}

void visibility(Ray ray, Light light) {
    vec2 range = cone_interval(ray, light);
    if (range.x >= range.y) return;
    vec3 to_light = light.position - ray.o;
#if DIRECTIONAL == 1
    float cosine = dot(ray.d, light.direction), t = cosine < 0.0 ? range.y : range.x;
    vec3 nearest = ray.d * t - to_light;
    Approach approach = Approach(dot(nearest, light.direction), abs(cosine));
#else
    float t_h = dot(to_light, ray.d), t = clamp(t_h, range.x, range.y);
    vec3 nearest = ray.d * t - to_light;
    if (length(nearest) <= BESIDE * length(to_light)) nearest = HAIR * across(ray.d);
    Approach approach = Approach(length(nearest), abs(t - t_h));
#endif
    float along = range.x - t, end = range.y - t;
    SeenSurface seen = seen_surface(ray, light);
    Stretch stretch = first_stretch(nearest, ray.d, light, along, end);
    ivec2 texel = texel_at(stretch.line, along);
    int top = findMSB(tile_size), level = top;
    vec2 held = vec2(along);   // the lit piece that may go on
    bool more = true, is_last = false;
    while (!is_last) {
        vec2 whole = held;
        bool is_whole = false;
        while (more && !is_whole) {
            Node node = node_around(texel, level);
            vec2 crossing = crossing_of(stretch, node);
            float leave = max(min(stretch.end, min(crossing.x, crossing.y)), along);
            float near = along < 0.0 && leave > 0.0 ? 0.0 : min(abs(along), abs(leave)), far = max(abs(along), abs(leave));
            bool closely = is_near(seen, t + leave, approach.nearest + far);
            vec2 stored = stretch.tile == OUTSIDE ? vec2(FARTHEST) : distances_in(node.number, level, stretch.tile);
            if (closely && level == 0 && sees(light, seen, texel, stretch.tile, stored.x))
                stored = vec2(seen.from_lit_side ? FARTHEST : 0.0);
            vec2 reached = reach(approach, stored);
            // some of it may be lit and some dark
            if (level > 0 && (closely || (far > reached.x && near <= reached.y))) {
                --level;
                continue;
            }
            vec2 part = vec2(max(along, -reached.x), min(leave, reached.x));
            if (part.x < part.y) {
                is_whole = part.x > held.y;
                if (is_whole) whole = held;
                held = vec2(is_whole ? part.x : held.x, part.y);
            }
            along = leave;
            if (leave < stretch.end) {
                ivec2 next = clamp(texel_at(stretch.line, along), node.first, node.last);
                if (crossing.x <= leave) next.x = stretch.heading.x > 0 ? node.last.x + 1 : node.first.x - 1;
                if (crossing.y <= leave) next.y = stretch.heading.y > 0 ? node.last.y + 1 : node.first.y - 1;
                if (level < top && any(notEqual(next >> (level + 1), texel >> (level + 1)))) ++level;
                texel = next;
            } else {
                more = along < end;
                if (more) {
                    stretch = next_stretch(stretch, nearest, ray.d, light, along, end);
                    texel = texel_at(stretch.line, along);
                }
            }
        }
        is_last = !is_whole;
        if (is_last) whole = held;
        if (whole.x < whole.y) lit(t + whole.x, whole.y - whole.x, 1.0);
    }
}
