// Sun, Ramamoorthi, Narasimhan and Nayar 2005: the isotropic airlight from a table of one function of two variables. The
// twin: analytic/models/sun2005.py. With H = sigma_t h and theta the scattering angle at an end of the piece
//     L = I sigma_s / (2 pi h) e^{-sigma_t t_h} (F(H, theta_b / 2) - F(H, theta_a / 2)),
//     F(u, v) = int_0^v e^{-u tan(xi)} d xi,
// exact but for the table. The difference of two reads loses digits where the piece is short: that is the form's own error.
#include "airlight/parts/closed_form.glsl"

uniform sampler2D airlight_table;   // F at equal steps, from F(0, 0) in the first texel to F(LARGEST_U, pi / 2) in the last
const float LARGEST_U = 10.0, HALF_PI = 1.57079633;

// F by bilinear interpolation; beyond the table it is as at its border. Not by the texture unit: hardware may find its
// place between two texels to 8 bits, which pieces shorter than that step would show.
float table_read(float u, float v) {
    vec2 last = vec2(textureSize(airlight_table, 0) - 1);
    vec2 place = clamp(vec2(v / HALF_PI, u / LARGEST_U), 0.0, 1.0) * last;
    ivec2 texel = ivec2(min(place, last - 1.0));
    vec2 share = place - vec2(texel);
    vec4 corners = vec4(texelFetch(airlight_table, texel, 0).r, texelFetch(airlight_table, texel + ivec2(1, 0), 0).r,
                        texelFetch(airlight_table, texel + ivec2(0, 1), 0).r,
                        texelFetch(airlight_table, texel + ivec2(1, 1), 0).r);
    vec2 across = corners.xz * (1.0 - share.x) + corners.yw * share.x;
    return across.x * (1.0 - share.y) + across.y * share.y;
}

// Arc tangents of positive numbers to 2e-8 (Abramowitz and Stegun 4.4.49). A driver's own may be off by 4096 ulp, and
// llvmpipe's is off by 3e-6, which short pieces would show too.
vec2 arc_tangent(vec2 x) {
    vec2 y = min(x, 1.0 / x), y2 = y * y;
    vec2 angle = y + y * y2 * (-0.3333314528 + y2 * (0.1999355085 + y2 * (-0.1420889944 + y2 * (0.1065626393
               + y2 * (-0.0752896400 + y2 * (0.0429096138 + y2 * (-0.0161657367 + y2 * 0.0028662257)))))));
    return mix(angle, HALF_PI - angle, greaterThan(x, vec2(1.0)));
}

float closed_form(Passage p, float t0, float dt, float extinction) {
    float H = extinction * p.h, depth = -extinction * p.t_h;
    // of a light so far behind the eye that the exponential overflows nothing arrives
    if (depth > 87.0) return 0.0;
    vec2 half_angle = arc_tangent(both_v(both_u(p, t0, dt)));
    return exp(depth) * (table_read(H, half_angle.y) - table_read(H, half_angle.x)) / (6.28318531 * p.h);
}

CLOSED_FORM_MODEL(closed_form)
