// Weng 2010, sections 4.3 and 4.4 as they are printed, errors and all: a reader who follows the thesis gets this. How
// it is read where it says two things stands in the twin, analytic/models/weng2010/printed.py:
//   - Figure 4.8 chooses: the second formulation where the light's projection lies before the piece, the first where it
//     lies behind it, the combined one (Eq. 30) inside, with Figure 4.11's three Ei and its - Ei(-H);
//   - the prefactor is e^{kappa_t (x_a - x_b)} in Eqs. 21, 24 and 27, e^{kappa_t (x_a - x_h)} in Eq. 29; in Eq. 30 each
//     part has its own ends for x_a and x_b, and nothing attenuates from x_h to the eye;
//   - Eq. 27 takes J_0(-H, ...), Figure 4.11 J_0(H, ...);
//   - Eq. 29's w^{j+1} is inside the exponent;
//   - v and w cancel as they are defined.
// Three things the twin does not have. The eye stands where the piece begins in each of these equations: what lies
// between the eye and a later piece is attenuated by the contract, e^{-kappa_t t0}. Rayleigh's function is chapter 5's
// 3/4 (1 + cos^2), which is 4 pi times the normalised one that every other model uses. What overflows stays so.
#include "airlight/parts/closed_form.glsl"
#include "airlight/parts/antiderivatives.glsl"
#include "airlight/parts/polynomial_sums.glsl"

float power_at(float exponent, float w, int j) { return exp(exponent * whole_power(w, j + 1)); }

// j_0(-H, w) of Eq. 27, `exponent` = -H / w: Ei on the side where it grows. Far behind the light w cancels to 0, which
// makes it -inf, and there Ei is i pi.
float opposite(float H, float exponent) {
    if (exponent < 0.0) return -antiderivatives(H, vec2(0.0, 3.14159265)).x;
    return -antiderivatives(H, principal_ei(vec2(exponent, H), scaled_e1_left(vec2(-exponent, H)))).x;
}

float before_light(float H, vec2 v, float depth) {
    return exp(-depth) * first_sum(H, v.x, v.y, pair(H, -H * v.y) - pair(H, -H * v.x));
}

float behind_light(float H, vec2 w, float depth, float growth) {
    // Eq. 27 for the isotropic function, Eq. 29 for others
    if (LEVEL) return exp(-depth) * BACK[0] * (opposite(H, -H / w.y) - opposite(H, -H / w.x));
    float real = real_ei(H / w.y) - real_ei(H / w.x);
    vec2 both = pair(H, H / w.y) - pair(H, H / w.x) - vec2(0.0, real);
    return growth * second_sum(H, w.x, w.y, both, real);
}

float around_light(float H, float v_a, float w_b, vec2 x, float extinction) {
    vec2 at_h = pair(H, -H);
    float real_h = LEVEL ? 0.0 : real_ei(-H), real_b = LEVEL ? 0.0 : real_ei(H / w_b);
    // Figure 4.11: j_1(H, -1) = i_1(-H, 1) + Ei(-H)
    vec2 both = pair(H, H / w_b) - vec2(0.0, real_b) - (at_h + vec2(0.0, real_h));
    float first = second_sum(H, -1.0, w_b, both, real_b - real_h);
    if (LEVEL) first *= exp(-extinction * x.y);
    return first - exp(-extinction * x.x) * first_sum(H, 1.0, v_a, pair(H, -H * v_a) - at_h);
}

float closed_form(Passage p, float t0, float dt, float extinction) {
    float H = extinction * p.h, x_a = t0 - p.t_h;
    vec2 u = both_u(p, t0, dt), r = sqrt(1.0 + u * u), v = u + r, w = u - r;
    float sum = u.y <= 0.0 ? before_light(H, v, extinction * dt)
              : u.x >= 0.0 ? behind_light(H, w, extinction * dt, exp(extinction * x_a))
                           : around_light(H, v.x, w.y, vec2(x_a, x_a + dt), extinction);
    return exp(-extinction * t0) * 2.0 * sum / p.h;
}

CLOSED_FORM_MODEL(closed_form)
