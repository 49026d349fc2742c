// The thesis's antiderivatives with Ei and the exponentials apart, as it writes them: nothing is merged or rescaled, so
// that what float32 loses shows. The same in numpy: analytic/models/weng2010/antiderivatives.py.
#include "airlight/exponential_integral.glsl"

// Ei(z) = -e^z F(-z) + i pi for z.y > 0 (Abramowitz and Stegun 5.1.7), `scaled` being the conjugate of F(-z). The
// exponential as a square does not overflow before Ei does.
vec2 principal_ei(vec2 z, vec2 scaled) {
    float root = exp(0.5 * z.x), cosine = cos(z.y), sine = sin(z.y);
    return vec2(-root * (root * (scaled.x * cosine + scaled.y * sine)),
                -root * (root * (scaled.x * sine - scaled.y * cosine)) + 3.14159265);
}

vec2 antiderivatives(float H, vec2 ei) {
    float cosine = cos(H), sine = sin(H);
    return vec2(cosine * ei.y - sine * ei.x, cosine * ei.x + sine * ei.y);
}

// i_0 and i_1 of Weng 2010, Eqs. 20 and 23, at (-H, v) with `exponent` = -H v; the principal Ei gives each i_0 behind
// the light a constant of pi cos(H). They are also j_0 and j_1 + Ei(H / w) of Eq. 26 at (H, w) with `exponent` = H / w,
// for w = -1 / v and Ei(conj z) = conj Ei(z) (Eq. 32). exponent <= 0
vec2 pair(float H, float exponent) {
    return antiderivatives(H, principal_ei(vec2(exponent, H), scaled_e1(vec2(-exponent, H))));
}

// Ei of a negative number
float real_ei(float x) {
    return -exp(x) * scaled_e1(vec2(-x, 0.0)).x;
}
