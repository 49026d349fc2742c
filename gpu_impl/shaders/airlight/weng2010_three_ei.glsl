// Weng 2010, isotropic, repaired, not merged: Figure 4.11, three complex Ei where the piece contains the light's
// projection (Eq. 30), two elsewhere (Eqs. 21 and 27). j(H, -1) is taken from i(-H, 1).
#include "airlight/parts/isotropic_ends.glsl"

float closed_form(Passage p, float t0, float dt, float extinction) {
    float H = extinction * p.h;
    vec2 u = both_u(p, t0, dt), v = both_v(u);
    float at_a = pair(H, -H * v.x).x, at_b = pair(H, -H * v.y).x;
    float integral = at_b - at_a;
    if (u.x < 0.0 && u.y > 0.0) {
        float at_h = pair(H, -H).x;
        integral = (at_h - at_a) + (at_b - at_h);
    }
    return from_integral(p, extinction, integral);
}

CLOSED_FORM_MODEL(closed_form)
