// One point sample at the middle of the piece: what a ray march sums (Nishita 1987; Weng 2010, Eq. 16 as a Riemann sum).
#include "light.glsl"
#include "light_leg.glsl"
#include "<phase>"

// a sample asks the light for its intensity in its own direction, and so shows the edge of a cone as it falls
const bool CLIP_TO_CONE = false;

vec3 airlight(Ray ray, Light light, float t0, float dt) {
    float t = t0 + 0.5 * dt;
    vec3 point = ray.o + t * ray.d, to_light = light.position - point;
    float d2 = max(dot(to_light, to_light), 1e-20);
    // cos(theta) = l . d with l the direction to the light, so that |l + d|^2 = 4 cos^2(theta/2)
    vec3 l = DIRECTIONAL == 1 ? -light.direction : to_light * inversesqrt(d2);
    vec2 half_angle = 0.25 * vec2(dot(l + ray.d, l + ray.d), dot(l - ray.d, l - ray.d));
    float leg = WHOLE_LEG == 1 ? sqrt(d2) : light_leg(light, point);
    return light.intensity * angular(light, point) * sigma_s * phase(half_angle) * dt / (DIRECTIONAL == 1 ? 1.0 : d2)
         * exp(-sigma_t * (t + leg));
}
