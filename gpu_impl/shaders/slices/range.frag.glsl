// The depths between which the slices of Dobashi 2002 lie, from the viewpoint to where fog or the scene ends: the least
// that hold what any ray of the picture has of the fog. A slice is one for all pixels, and so is this. IN_BEAM is 1 where
// what lies outside a spot's cone is left out.
#include "ray_in_fog.glsl"
#include "light.glsl"
#include "slices/range.glsl"

uniform Light light;
out float last;

// Fog ends where this is left of what the light would be on the straight way to the eye: one step of the 8 bits that a
// colour had on the paper's hardware. Everything is brought in by two legs, so that beyond lies still less.
const float LAST_STEP = log(256.0);

// Where a ray leaves the ellipsoid around eye and light beyond which fog on both legs leaves no more than that.
float end_of_fog(Ray ray, Light light) {
#if WHOLE_LEG == 1
    vec3 to_light = light.position - ray.o;
    float thinnest = min(sigma_t.x, min(sigma_t.y, sigma_t.z));
    // t + d(t) = |to_light| + detour; in fog that is hardly there, about as far as floats go
    float straight = length(to_light), detour = min(LAST_STEP / max(thinnest, 1e-30), 1e15);
    return detour * (detour + 2.0 * straight) / (2.0 * (detour + straight - dot(to_light, ray.d)));
#else
    return 3e38;
#endif
}

void main() {
    last = 0.0;
    float start;
    Ray ray = ray_in_fog(ivec2(gl_FragCoord.xy), light, start);
    if (ray.t_max <= 0.0) return;
    vec2 range = IN_BEAM == 1 ? cone_interval(ray, light) : vec2(0.0, ray.t_max);
    range.y = min(range.y, end_of_fog(ray, light));
    if (range.x >= range.y) return;
    float before = dot(ray.o - camera_to_world[3].xyz, ray.d);
    vec2 depth = max(range + before, 0.0) * dot(ray.d, camera_to_world[2].xyz);
    atomicMin(first_depth, floatBitsToUint(depth.x));
    atomicMax(last_depth, floatBitsToUint(depth.y));
    last = depth.y;
}
