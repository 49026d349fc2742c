// Exact closed forms for the isotropic, Rayleigh's and Schlick's phase functions, from one complex Ei at each end of
// the piece: no series, no split at the light. The derivation, and the twin: analytic/models/one_ei/closed_form.py.
//
// The phase function times dtheta/dv = 2 / (1 + v^2) is Im sum_n g_n / (v - iq)^n, v = tan(theta / 2), and
//     int_v^inf e^{-Ht} / (t - iq)^n dt = e^{-Hv} F_n(z) / (v - iq)^{n-1},  z = H (v - iq),  F_n(z) = e^z E_n(z).
// With T(v) = Im sum_n g_n F_n / (v - iq)^{n-1} and the exponents merged (Weng 2010, Eq. 18, repaired),
//     L = I sigma_s / h (e^{-sigma_t (t0 + d_a)} T(v_a) - e^{-sigma_t (t0 + dt + d_b)} T(v_b)).
// The difference loses the digits that both terms share, as with every antiderivative: short pieces, pieces before the
// light.
#include "airlight/parts/closed_form.glsl"
#include "airlight/exponential_integral.glsl"
// ORDERS, the POLE q, and RESIDUE[n - 1] = conj(g_n)
#include "<partial-fractions>"

vec2 product(vec2 a, vec2 b) { return vec2(a.x * b.x - a.y * b.y, a.x * b.y + a.y * b.x); }

float tail(float H, float v) {
    // the conjugate of z lies in the first quadrant
    vec2 z = H * vec2(v, POLE);
    if (ORDERS == 1) return -RESIDUE[0].x * scaled_e1(z).y;
    Orders f = scaled_orders(z);
    vec2 inverse = vec2(v, -POLE) / (v * v + POLE * POLE);
    vec2 sum = product(RESIDUE[1], f.second);
    if (ORDERS == 3) sum += product(inverse, product(RESIDUE[2], f.third));
    return -(RESIDUE[0].x * f.first.y + product(inverse, sum).y);
}

float closed_form(Passage p, float t0, float dt, float extinction) {
    float H = extinction * p.h;
    vec2 u = both_u(p, t0, dt), v = both_v(u), d = p.h * sqrt(1.0 + u * u);
    return (exp(-extinction * (t0 + d.x)) * tail(H, v.x) - exp(-extinction * (t0 + dt + d.y)) * tail(H, v.y)) / p.h;
}

CLOSED_FORM_MODEL(closed_form)
