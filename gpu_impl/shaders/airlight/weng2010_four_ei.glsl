// Weng 2010, isotropic, repaired, not merged: Figure 4.9, four complex Ei where the piece contains the light's
// projection (Eq. 30), two elsewhere (Eqs. 21 and 27). i(-H, 1) and j(H, -1) are evaluated each for itself.
#include "airlight/parts/isotropic_ends.glsl"

// tan(theta / 2) and -cot(theta / 2) at the light's projection. As constants they would make -H v_h and H / w_h one number,
// and a compiler would share what the fourth Ei costs with the third; what a uniform holds it cannot know.
uniform float v_h = 1.0, w_h = -1.0;

float closed_form(Passage p, float t0, float dt, float extinction) {
    float H = extinction * p.h;
    vec2 u = both_u(p, t0, dt), v = both_v(u);
    float at_a = pair(H, -H * v.x).x, at_b = pair(H, -H * v.y).x;
    float integral = at_b - at_a;
    if (u.x < 0.0 && u.y > 0.0) {
        integral = (pair(H, -H * v_h).x - at_a) + (at_b - pair(H, H / w_h).x);
    }
    return from_integral(p, extinction, integral);
}

CLOSED_FORM_MODEL(closed_form)
