// Weng 2010, isotropic, repaired, not merged: what is left of Figure 4.11 when the terms at v_h = 1, which cancel for
// this phase function, are not evaluated. J_0(H, w_h, w_b) - I_0(-H, v_h, v_a) = i_0(-H, v_b) - i_0(-H, v_a) by Eq. 32:
// Eq. 21 serves on either side. The twin: analytic/models/weng2010/isotropic.py.
#include "airlight/parts/isotropic_ends.glsl"

float closed_form(Passage p, float t0, float dt, float extinction) {
    float H = extinction * p.h;
    vec2 v = both_v(both_u(p, t0, dt));
    return from_integral(p, extinction, pair(H, -H * v.y).x - pair(H, -H * v.x).x);
}

CLOSED_FORM_MODEL(closed_form)
