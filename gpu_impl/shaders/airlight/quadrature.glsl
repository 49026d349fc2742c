// Quadrature of the airlight integral under a rational map, accurate to float32 for any phase function: the twin of
// analytic/models/quadrature_float32.py.
//
// With u = (x - x_h) / h, H = sigma_t h and v = u + sqrt(1 + u^2) = tan(theta / 2), theta the scattering angle
// (Weng 2010, Eqs. 17 and 18 with the prefactor repaired),
//     L = I sigma_s / h  e^{-sigma_t (t0 + d_a)}  int_{v_a}^{v_b} e^{-H (v - v_a)} Phi(cos theta) 2 / (1 + v^2) dv.
// v = q (X^2 - 1), Y = 1 / X takes [0, inf) to (0, 1] and is smooth at both ends; the nodes lie in Y. Beyond
// v_a + CLIP / H nothing is left. Nodes, weights, CLIP and Q are tuned together: 24 nodes are off by at most 1e-6.
#include "light.glsl"
#include "<phase>"
#include "<rational-rule>"
#include "<gauss-legendre>"
#include "airlight/part_of_the_leg.glsl"

const bool CLIP_TO_CONE = true;

vec3 channel(Ray ray, Light light, float t0, float dt, float extinction) {
    Passage p = passage(ray, light);
    float H = extinction * p.h;
    float u_a = (t0 - p.t_h) / p.h, du = dt / p.h, u_b = u_a + du;
    float r_a = sqrt(1.0 + u_a * u_a), r_b = sqrt(1.0 + u_b * u_b);
    float v_a = u_a < 0.0 ? 1.0 / (r_a - u_a) : r_a + u_a;
    float v_b = u_b < 0.0 ? 1.0 / (r_b - u_b) : r_b + u_b;
    // differences of nearby values, each written as a product so that short pieces keep their digits
    float dv = min(du * (v_a + v_b) / (r_a + r_b), CLIP / max(H, 1e-30));
    v_b = v_a + dv;
    float q = Q * phase_scale();
    float X_a = sqrt(1.0 + v_a / q), X_b = sqrt(1.0 + v_b / q), Y_a = 1.0 / X_a;
    float dY = dv / (q * (X_a + X_b)) / (X_a * X_b);
    vec3 sum = vec3(0.0);
    for (int i = 0; i < RULE_NODES; ++i) {
        float X = 1.0 / (Y_a - dY * RULE_NODE[i]);
        float beyond = q * dY * RULE_NODE[i] * X * X_a * (X + X_a);  // v - v_a
        float v = v_a + beyond, cos2 = 1.0 / (1.0 + v * v);
        float term = phase(vec2(cos2, v * v * cos2)) * exp(-H * beyond) * X * X * X * cos2;
        // a hard spot is cut at its cone, and is even inside it
        bool even = SPOT != 2 && SPOT_TEXTURE == 0;
        vec3 share = even ? vec3(1.0) : angular(light, ray.o + ray.d * (p.t_h + 0.5 * p.h * (v - 1.0 / v)));
        sum += RULE_WEIGHT[i] * term * share;
    }
    return 4.0 * q * dY * sum / p.h * exp(-extinction * (t0 + p.h * r_a));
}

// For unit intensity and unit scattering coefficient.
vec3 unit_airlight(Ray ray, Light light, float t0, float dt) {
    return WHOLE_LEG == 1 ? PER_CHANNEL(channel, ray, light, t0, dt) : through_boundary(ray, light, t0, dt);
}

vec3 airlight(Ray ray, Light light, float t0, float dt) {
    vec3 scale = light.intensity * sigma_s;
    // parallel light is scattered by one angle all along the ray
    int kinks = DIRECTIONAL == 1 ? 0 : phase_kinks();
    if (kinks == 0) return scale * unit_airlight(ray, light, t0, dt);
    // a table is smooth between two of its values
    Passage p = passage(ray, light);
    vec3 sum = vec3(0.0);
    float begin = t0, end = t0 + dt;
    for (int i = 0; i <= kinks && begin < end; ++i) {
        float v = i < kinks ? phase_kink(i) : 0.0;
        float next = i < kinks ? min(p.t_h + 0.5 * p.h * (v - 1.0 / v), end) : end;
        if (next <= begin) continue;
        sum += unit_airlight(ray, light, begin, next - begin);
        begin = next;
    }
    return scale * sum;
}
