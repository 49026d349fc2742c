// The driver: evaluates one technique for one light on every N-th pixel. Its result is added to that of other lights.
// rgb: airlight L_m, the radiance that fog scatters to the eye; a: lit intervals that the strategy reported.
#include "camera_ray.glsl"
#include "light.glsl"
#include "fog.glsl"
#include "<airlight>"
#include "<visibility>"

uniform Light light;
uniform sampler2D normal_and_distance;   // distance 0: no surface, the ray ends on the far plane
uniform int downsample;
out vec4 result;

Ray the_ray;
vec2 the_cone;

void lit(float t0, float dt, float w) {
    result.a += 1.0;
    if (CLIP_TO_CONE) {
        float begin = max(t0, the_cone.x), end = min(t0 + dt, the_cone.y);
        if (begin >= end) return;
        if (begin > t0 || end < t0 + dt) dt = end - begin;
        t0 = begin;
    }
    result.rgb += w * airlight(the_ray, light, t0, dt);
}

void main() {
    ivec2 pixel = min(ivec2(gl_FragCoord.xy) * downsample + downsample / 2, image_size - 1);
    the_ray = camera_ray(pixel);
    float surface = texelFetch(normal_and_distance, pixel, 0).w;
    if (surface > 0.0) the_ray.t_max = surface;
    // a ray begins in the fog and ends in it; what is before does not weaken it
    vec2 fog = fog_interval(the_ray.o, the_ray.d, vec2(0.0, the_ray.t_max));
    the_ray.o += fog.x * the_ray.d;
    the_ray.t_max = fog.y - fog.x;
    result = vec4(0.0);
    if (the_ray.t_max <= 0.0) return;
#if WHOLE_LEG == 1
    // Past the light both legs grow: 16 mean free paths behind its projection float32 has nothing left to add.
    float thinnest = min(sigma_t.x, min(sigma_t.y, sigma_t.z));
    float t_h = dot(light.position - the_ray.o, the_ray.d);
    the_ray.t_max = min(the_ray.t_max, max(t_h, 0.0) + 16.0 / max(thinnest, 1e-30));
#endif
    the_cone = cone_interval(the_ray, light);
    visibility(the_ray, light);
}
