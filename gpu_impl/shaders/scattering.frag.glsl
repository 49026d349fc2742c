// The driver: evaluates one technique for one light on every N-th pixel. Its result is added to that of other lights.
// rgb: airlight L_m, the radiance that fog scatters to the eye; a: lit intervals that the strategy reported.
#include "ray_in_fog.glsl"
#include "light.glsl"
#include "<airlight>"
#include "<visibility>"

uniform Light light;
layout(location = 0) out vec4 result;

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
    COUNT_PIECE;
    result.rgb += w * airlight(the_ray, light, t0, dt);
}

void main() {
    float start;
    the_ray = ray_in_fog(pixel_of(ivec2(gl_FragCoord.xy)), light, start);
    result = vec4(0.0);
    START_COUNTING;
    if (the_ray.t_max <= 0.0) return;
    // without the ray's end: pieces end there by themselves, but for those that are taken away behind it (printed.glsl)
    the_cone = cone_interval(Ray(the_ray.o, the_ray.d, 3e38), light);
    visibility(the_ray, light);
}
