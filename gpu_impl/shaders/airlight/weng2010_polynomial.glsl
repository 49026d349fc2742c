// Weng 2010, section 4.3 with Figure 4.11, repaired: the phase function a polynomial in v before the light's projection
// and in w = -1/v behind it, Taylor's or a near-minimax one. The twin: analytic/models/weng2010/combined.py.
//     L = I sigma_s / h e^{-sigma_t t_h} 2 (sum c_n int e^{-Hv} v^n / (1 + v^2) dv
//                                           + sum d_n int e^{H/w} w^n / (1 + w^2) dw)
// Where it departs from the print: the prefactor is e^{kappa_t (x_a - x_h)} throughout, which also gives Eq. 30 the
// transmittance that it lacks; the second formulation takes J(H, ...), not Eq. 27's J(-H, ...); Eq. 29's w^{j+1} stands
// outside the exponent; Figure 4.11 ends in + Ei(-H).
#include "airlight/parts/closed_form.glsl"
#include "airlight/parts/antiderivatives.glsl"
#include "airlight/parts/polynomial_sums.glsl"

float power_at(float exponent, float w, int j) { return exp(exponent) * whole_power(w, j + 1); }

float closed_form(Passage p, float t0, float dt, float extinction) {
    float H = extinction * p.h;
    vec2 u = both_u(p, t0, dt), v = both_v(u);
    bool before = u.y <= 0.0, behind = u.x >= 0.0;
    vec2 at_a = pair(H, -H * v.x), at_b = pair(H, -H * v.y);
    // j(H, -1) is taken from i(-H, 1): three complex Ei
    vec2 at_h = before || behind ? vec2(0.0) : pair(H, -H);
    float integral = 0.0;
    if (!behind) integral += first_sum(H, v.x, before ? v.y : 1.0, (before ? at_b : at_h) - at_a);
    if (!before) {
        float w_a = behind ? -1.0 / v.x : -1.0, w_b = -1.0 / v.y;
        // J_e of Eq. 29, of no account where the phase function is level
        float real = LEVEL ? 0.0 : real_ei(H / w_b) - real_ei(H / w_a);
        vec2 both = at_b - (behind ? at_a : at_h) - vec2(0.0, real);
        integral += second_sum(H, w_a, w_b, both, real);
    }
    return 2.0 * exp(-extinction * p.t_h) * integral / p.h;
}

CLOSED_FORM_MODEL(closed_form)
