// Fog whose source term is constant along the ray, so that only depth counts: what a game engine's fog takes it for, and
// what James 2003 adds and takes away behind shadow-volume faces. The twin of analytic/models/depth_fog.py.
//
// The source is that of the light at the eye's place, where the ray begins in fog; its distance and its angle to the ray
// are taken as the same from there on. What a spot sends in each direction is left out: the eye is seldom in its cone.
//     L = S int_{t0}^{t0 + dt} e^{-sigma_t t} dt = S e^{-sigma_t t0} (1 - e^{-sigma_t dt}) / sigma_t
#include "contract.glsl"
#include "light_leg.glsl"
#include "<phase>"

const bool CLIP_TO_CONE = true;

// (1 - e^-x) / x, by its series where the difference would lose digits: what the series leaves out at 0.3 is 5e-9
vec3 mean_over_piece(vec3 x) {
    vec3 series = 1.0 - x / 2.0 * (1.0 - x / 3.0 * (1.0 - x / 4.0 * (1.0 - x / 5.0 * (1.0 - x / 6.0 * (1.0 - x / 7.0)))));
    return mix((1.0 - exp(-x)) / max(x, 1e-30), series, lessThan(x, vec3(0.3)));
}

vec3 airlight(Ray ray, Light light, float t0, float dt) {
    vec3 to_light = light.position - ray.o;
    float d2 = max(dot(to_light, to_light), 1e-20);
    // cos(theta) = l . d with l the direction to the light, so that |l + d|^2 = 4 cos^2(theta/2)
    vec3 l = DIRECTIONAL == 1 ? -light.direction : to_light * inversesqrt(d2);
    vec2 half_angle = 0.25 * vec2(dot(l + ray.d, l + ray.d), dot(l - ray.d, l - ray.d));
    float leg = WHOLE_LEG == 1 ? sqrt(d2) : light_leg(light, ray.o);
    vec3 source = light.intensity * sigma_s * phase(half_angle) / (DIRECTIONAL == 1 ? 1.0 : d2);
    return source * exp(-sigma_t * (leg + t0)) * dt * mean_over_piece(sigma_t * dt);
}
