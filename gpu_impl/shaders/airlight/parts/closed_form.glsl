// What all closed forms share: they take the light's intensity as constant over the piece, which for a hard cone it is,
// and work on one extinction coefficient at a time.
#include "light.glsl"

const bool CLIP_TO_CONE = true;

// Makes a model of a function float f(Passage p, float t0, float dt, float extinction), which is L / (I sigma_s) with
// the eye leg's transmittance included. The forms divide by the extinction; fog that weakens nothing scatters nothing.
#define CLOSED_FORM_MODEL(f) \
    vec3 channel(Ray ray, Light light, float t0, float dt, float extinction) { \
        return vec3(extinction > 0.0 ? f(passage(ray, light), t0, dt, extinction) : 0.0); \
    } \
    vec3 airlight(Ray ray, Light light, float t0, float dt) { \
        vec3 share = angular(light, ray.o + (t0 + 0.5 * dt) * ray.d); \
        return light.intensity * share * sigma_s * PER_CHANNEL(channel, ray, light, t0, dt); \
    }

// u = (t - t_h) / h at both ends of a piece (Weng 2010, section 4.3): -, + where the light's projection lies inside
vec2 both_u(Passage p, float t0, float dt) {
    float u_a = (t0 - p.t_h) / p.h;
    return vec2(u_a, u_a + dt / p.h);
}

// v = u + sqrt(1 + u^2) = tan(theta / 2) without its cancellation before the light, theta the scattering angle
vec2 both_v(vec2 u) {
    vec2 r = sqrt(1.0 + u * u), far = r + abs(u);
    return vec2(u.x < 0.0 ? 1.0 / far.x : far.x, u.y < 0.0 ? 1.0 / far.y : far.y);
}
