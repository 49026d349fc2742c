// The part of a lattice cell's ray in which fog scatters a light towards the eye.
#include "camera_ray.glsl"
#include "fog.glsl"
#include "<lattice>"

uniform sampler2D normal_and_distance;   // distance 0: no surface, the ray ends on the far plane

// A ray that begins in the fog and ends in it, since what is before does not weaken it; it begins `start` behind where
// camera_ray() does. It ends at the surface that the pixel sees in which it lies. t_max is not positive where there is
// no fog, or where the lattice has no ray.
Ray ray_in_fog(ivec2 cell, Light light, out float start) {
    vec2 position = position_of(cell);
    Ray ray = camera_ray(position);
    start = 0.0;
    if (any(lessThan(position, vec2(0.0))) || any(greaterThanEqual(position, vec2(image_size)))) {
        ray.t_max = 0.0;
        return ray;
    }
    float surface = texelFetch(normal_and_distance, ivec2(position), 0).w;
    if (surface > 0.0) ray.t_max = surface;
    vec2 fog = fog_interval(ray.o, ray.d, vec2(0.0, ray.t_max));
    start = fog.x;
    ray.o += fog.x * ray.d;
    ray.t_max = fog.y - fog.x;
#if WHOLE_LEG == 1
    // Past the light both legs grow: 16 mean free paths behind its projection float32 has nothing left to add.
    float thinnest = min(sigma_t.x, min(sigma_t.y, sigma_t.z));
    float t_h = dot(light.position - ray.o, ray.d);
    ray.t_max = min(ray.t_max, max(t_h, 0.0) + 16.0 / max(thinnest, 1e-30));
#endif
    return ray;
}
