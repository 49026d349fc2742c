// Weng 2010, isotropic closed form (Eqs. 21 and 27 in the combined formulation of section 4.3.3), repaired.
//
// The printed prefactor e^{k_t (x_a - x_b)} should be e^{k_t (x_a - x_h)}, and i_0 carries a constant i pi on the
// principal sheet whose difference float32 loses. Merging e^{-H v} into the exponential integral removes both: with
// G(H, v) = -Im[e^z E1(z)], z = H (v + i), where no cut is crossed because Im z is constant,
//     L = I k_s / (2 pi h) [ e^{-k_t (t0 + d_a)} G(H, v_a) - e^{-k_t (t0 + dt + d_b)} G(H, v_b) ].
// The v_h terms of Fig. 4.11 cancel identically here: two evaluations of Ei serve where the thesis counts three.
// The difference of two antiderivatives loses digits where the piece is short: that is the form's own error.
#include "light.glsl"
#include "airlight/exponential_integral.glsl"

const bool CLIP_TO_CONE = true;

float antiderivative(float H, float u, float r) {
    float v = u < 0.0 ? 1.0 / (r - u) : r + u;
    return -scaled_e1(max(H, 1e-7) * vec2(v, 1.0)).y;
}

vec3 channel(Ray ray, Light light, float t0, float dt, float extinction) {
    Passage p = passage(ray, light);
    float H = extinction * p.h;
    float u_a = (t0 - p.t_h) / p.h, u_b = u_a + dt / p.h;
    float r_a = sqrt(1.0 + u_a * u_a), r_b = sqrt(1.0 + u_b * u_b);
    float at_a = exp(-extinction * (t0 + p.h * r_a)) * antiderivative(H, u_a, r_a);
    float at_b = exp(-extinction * (t0 + dt + p.h * r_b)) * antiderivative(H, u_b, r_b);
    return vec3(0.159154943091895 / p.h * (at_a - at_b));
}

vec3 airlight(Ray ray, Light light, float t0, float dt) {
    // the closed form takes the intensity as constant over the piece: exact for a hard cone
    vec3 share = angular(light, ray.o + (t0 + 0.5 * dt) * ray.d);
    return light.intensity * share * sigma_s * PER_CHANNEL(channel, ray, light, t0, dt);
}
