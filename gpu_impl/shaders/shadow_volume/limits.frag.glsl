// Between which distances of each lattice pixel's ray a shadow polygon of one light counts: inside the fog, inside the
// light's cone, and before the surface. With it what turns a depth along the viewing axis into a distance along the ray.
#include "ray_in_fog.glsl"
#include "light.glsl"
#include "shadow_lookup.glsl"
#include "shadow_volume/edges.glsl"

uniform Light light;
out vec4 limits;   // first and last distance; distance = depth * z - w

void main() {
    ivec2 pixel = pixel_of(ivec2(gl_FragCoord.xy));
    float start;
    Ray ray = ray_in_fog(ivec2(gl_FragCoord.xy), light, start);
    float stretch = axis_stretch(vec2(pixel) + 0.5);
    vec2 counts = vec2(0.0, 3e38);
#if CULL == 1
    counts = ray.t_max > 0.0 ? cone_interval(ray, light) : vec2(0.0);
    if (counts.x < counts.y) {
        // of a piece of a ray, one of the ends is the furthest from the light
        vec2 ends = vec2(distance_from(light, ray.o + counts.x * ray.d), distance_from(light, ray.o + counts.y * ray.d));
        uint furthest = floatBitsToUint(max(max(ends.x, ends.y), 0.0));
        if (furthest > reach) atomicMax(reach, furthest);
    }
#endif
    limits = vec4(counts, stretch, clip_planes.x * stretch + start);
}
