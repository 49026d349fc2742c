// Dobashi, Yamamoto and Nishita 2002: a pixel of a slice, which stands for the slab around it, counts wholly where the
// light reaches it and not at all where it is in shadow or behind the pixel's surface.
//
// Their planes between planes, where shadows are dense, and the light's picture as a texture are the more slices and the
// angular intensity here.
#include "camera_ray.glsl"
#include "shadow_lookup.glsl"

flat in vec2 slice;

void visibility(Ray ray, Light light) {
    float stretch = 1.0 / dot(ray.d, camera_to_world[2].xyz);
    float t = slice.x * stretch - dot(ray.o - camera_to_world[3].xyz, ray.d), dt = slice.y * stretch;
    if (t >= 0.0 && t < ray.t_max && !in_shadow(light, ray.o + t * ray.d)) lit(t - 0.5 * dt, dt, 1.0);
}
