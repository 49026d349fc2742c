// Weng 2010, isotropic closed form (Eqs. 21 and 27 in the combined formulation of section 4.3.3), repaired.
//
// The printed prefactor e^{k_t (x_a - x_b)} should be e^{k_t (x_a - x_h)}, and i_0 carries a constant i pi on the
// principal sheet whose difference float32 loses. Merging e^{-H v} into the exponential integral removes both: with
// G(H, v) = -Im[e^z E1(z)], z = H (v + i), where no cut is crossed because Im z is constant,
//     L = I k_s / (2 pi h) [ e^{-k_t (t0 + d_a)} G(H, v_a) - e^{-k_t (t0 + dt + d_b)} G(H, v_b) ].
// The v_h terms of Fig. 4.11 cancel identically here: two evaluations of Ei serve where the thesis counts three.
// The difference of two antiderivatives loses digits where the piece is short: that is the form's own error.
#include "airlight/parts/closed_form.glsl"
#include "airlight/exponential_integral.glsl"

float closed_form(Passage p, float t0, float dt, float extinction) {
    float H = extinction * p.h;
    vec2 u = both_u(p, t0, dt), v = both_v(u), d = p.h * sqrt(1.0 + u * u);
    float at_a = exp(-extinction * (t0 + d.x)) * scaled_e1(H * vec2(v.x, 1.0)).y;
    float at_b = exp(-extinction * (t0 + dt + d.y)) * scaled_e1(H * vec2(v.y, 1.0)).y;
    return 0.159154943 / p.h * (at_b - at_a);
}

CLOSED_FORM_MODEL(closed_form)
