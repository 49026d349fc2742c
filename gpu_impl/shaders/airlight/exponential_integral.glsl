// The scaled complex exponential integral F(z) = e^z E1(z) of the upper half plane (z.y >= 0, 1e-18 < |z| < 1e18):
// scaled_e1 of the first quadrant, scaled_e1_left of the second one, and scaled_orders, E1, E2 and E3 of the first from
// one evaluation. The closed forms need its imaginary part, -G(H, v) with z = H (v + i), far beyond where it is much
// smaller than the real one; so the parts are carried apart, and every sum that makes the imaginary one in the fraction
// below adds terms of one sign. The same operations in numpy: analytic/exponential_integral, scaled_e1 of complex64.
//
// Measured over |z| = 1e-6 .. 1e6, z.y / z.x = 1e-8 .. 1e8, 2.3 million points on llvmpipe (worst relative error of
// the complex value / of the imaginary part): |z| <= 0.6: 3.1e-7 / 7.7e-7; 0.6 to 1: 5.6e-7 / 1.6e-6; above 1:
// 3.6e-7 / 4.2e-7. scaled_e1_left, 1e5 points up to 1e6: 2.3e-6 at worst, below 24. scaled_orders, 1e5 points from
// 1e-4: 3.9e-7 / 8.9e-7, 7.1e-7 / 2.5e-6, 8.4e-7 / 3.1e-6.

// A counting build defines it; it stands once in every function that evaluates an exponential integral.
#ifndef COUNT_EI
#define COUNT_EI
#endif

// Angle of z in the first quadrant. The half-angle formula brings the argument to t <= tan(pi/8), where
// 2 atan(t) = t P(t^2) to 1.9e-8 (Chebyshev nodes). GLSL's own atan may be off by far more than float32's rounding.
float first_quadrant_angle(vec2 z, float modulus) {
    float t = min(z.x, z.y) / (max(z.x, z.y) + modulus);
    float s = t * t;
    float angle = t * ((((0.159525841 * s - 0.27696979) * s + 0.399481654) * s - 0.666655719) * s + 2.0);
    return z.y > z.x ? 1.57079633 - angle : angle;
}

// One step of Horner's rule: f z / n + (H_{n-1} - gamma - ln z), H_n the harmonic numbers
vec2 scaled_e1_term(vec2 f, vec2 z, float inverse_n, float harmonic, vec2 logarithm) {
    vec2 product = vec2(f.x * z.x - f.y * z.y, f.x * z.y + f.y * z.x);
    return product * inverse_n + vec2(harmonic - logarithm.x, -logarithm.y);
}

// |z| <= 1: F = sum_{n=0}^{11} z^n / n! (H_n - gamma - ln z), e^z times the logarithmic series (Abramowitz and Stegun
// 5.1.11, with e^z Ein(z) = sum H_n z^n / n!): no exponential, no sine, no cosine.
vec2 scaled_e1_series(vec2 z, float modulus) {
    vec2 l = vec2(log(modulus) + 0.577215665, first_quadrant_angle(z, modulus));  // gamma + ln z
    vec2 f = vec2(3.01987734 - l.x, -l.y);
    f = scaled_e1_term(f, z, 1.0 / 11.0, 2.92896825, l);
    f = scaled_e1_term(f, z, 1.0 / 10.0, 2.82896825, l);
    f = scaled_e1_term(f, z, 1.0 / 9.0, 2.71785714, l);
    f = scaled_e1_term(f, z, 1.0 / 8.0, 2.59285714, l);
    f = scaled_e1_term(f, z, 1.0 / 7.0, 2.45, l);
    f = scaled_e1_term(f, z, 1.0 / 6.0, 2.28333333, l);
    f = scaled_e1_term(f, z, 1.0 / 5.0, 2.08333333, l);
    f = scaled_e1_term(f, z, 1.0 / 4.0, 1.83333333, l);
    f = scaled_e1_term(f, z, 1.0 / 3.0, 1.5, l);
    f = scaled_e1_term(f, z, 1.0 / 2.0, 1.0, l);
    return scaled_e1_term(f, z, 1.0, 0.0, l);
}

// Principal square root for w.y >= 0: halves of one sign are added, never subtracted
vec2 upper_square_root(vec2 w) {
    float larger = sqrt(0.5 * (length(w) + abs(w.x)));
    float smaller = 0.5 * w.y / larger;
    return w.x >= 0.0 ? vec2(larger, smaller) : vec2(smaller, larger);
}

// |z| > 1, on the left |z| + Re z > 1 or |z| >= 24: F = 1/(z+1 - 1/(z+3 - 4/(z+5 - 9/(z+7 - ...)))) from the inside out
// (Abramowitz and Stegun 5.1.22, even part). The tails f_k = 1/(z + 2k + 1 - (k+1)^2 f_{k+1}) behave as
// (1 - sqrt(z/k)) / k, so the innermost is taken as the fixed point of 1 = f (z + 2k + 1 - k (k+1) f); at |z| = 1 that
// needs a depth of 24 where a dropped tail needs 39.
vec2 scaled_e1_fraction(vec2 z, float modulus) {
    float depth = 4.0;                                  // enough without a tail from |z| = 20 (left: 24) on
    vec2 f = vec2(0.0);
    if (modulus < (z.x < 0.0 ? 24.0 : 20.0)) {
        depth = ceil(2.0 + 22.0 / (modulus + min(z.x, 0.0)));   // at most 24
        float p = 2.0 * depth + 1.0, b = z.x + p;
        // z + p + sqrt((z + p)^2 - 4k(k+1)), in the quadrant of z + p; the discriminant is z^2 + 2 z p + 1
        vec2 root = upper_square_root(vec2(z.x * z.x - z.y * z.y + 2.0 * z.x * p + 1.0, 2.0 * z.y * abs(b)));
        vec2 d = vec2(b + (b < 0.0 ? -root.x : root.x), z.y + root.y);
        f = vec2(d.x, -d.y) * (2.0 / dot(d, d));
    }
    for (float n = depth; n > 0.0; n -= 1.0) {
        vec2 d = vec2(z.x + (2.0 * n - 1.0), z.y) - n * n * f;
        f = vec2(d.x, -d.y) * (1.0 / dot(d, d));
    }
    return f;
}

vec2 scaled_e1(vec2 z) {
    COUNT_EI;
    float modulus = length(z);
    return modulus <= 1.0 ? scaled_e1_series(z, modulus) : scaled_e1_fraction(z, modulus);
}

// z.x < 0, |z| + Re z <= 1, |z| < 24: F = e^z (-gamma - ln z - sum_{n > 0} (-z)^n / (n n!)), 5.1.11. The terms are at
// most e times as large as their sum there.
vec2 scaled_e1_left_series(vec2 z, float modulus) {
    vec2 s = vec2(0.0);
    // with w = -z the sum is w s_1, s_n = 1/n + w / (n+1) s_{n+1}
    for (int n = int(ceil(11.0 + 2.0 * modulus)); n > 0; --n)
        s = vec2(1.0 / float(n), 0.0) - vec2(s.x * z.x - s.y * z.y, s.x * z.y + s.y * z.x) / float(n + 1);
    s = vec2(s.x * z.x - s.y * z.y, s.x * z.y + s.y * z.x)
      - vec2(log(modulus) + 0.577215665, 3.14159265 - first_quadrant_angle(vec2(-z.x, z.y), modulus));
    float cosine = cos(z.y), sine = sin(z.y);
    return exp(z.x) * vec2(s.x * cosine - s.y * sine, s.x * sine + s.y * cosine);
}

vec2 scaled_e1_left(vec2 z) {
    COUNT_EI;
    float modulus = length(z);
    return modulus < 24.0 && modulus + z.x <= 1.0 ? scaled_e1_left_series(z, modulus) : scaled_e1_fraction(z, modulus);
}

// z.x >= 0, |z| > 2: e^z E3(z) = 1/(z+3 - 3/(z+5 - 8/(z+7 - 15/(z+9 - ...)))) from the inside out (5.1.22).
vec2 scaled_e3_fraction(vec2 z, float modulus) {
    COUNT_EI;
    vec2 f = vec2(0.0);
    for (float n = ceil(7.0 + 44.0 / (modulus + z.x)); n > 0.0; n -= 1.0) {   // at most 29
        vec2 d = vec2(z.x + (2.0 * n + 1.0), z.y) - n * (n + 2.0) * f;
        f = vec2(d.x, -d.y) * (1.0 / dot(d, d));
    }
    return f;
}

struct Orders { vec2 first; vec2 second; vec2 third; };

// e^z E_n(z) for n = 1, 2, 3 from one of them: n F_{n+1} = 1 - z F_n (5.1.14). Upwards it multiplies errors by
// |z|^2 / 2 where |z| is large, downwards by 2 / |z|^2 where it is small. The twin: analytic/models/one_ei/orders.py.
Orders scaled_orders(vec2 z) {
    float modulus = length(z);
    if (modulus <= 2.0) {
        vec2 first = scaled_e1(z);
        vec2 second = vec2(1.0 - (z.x * first.x - z.y * first.y), -(z.x * first.y + z.y * first.x));
        vec2 third = 0.5 * vec2(1.0 - (z.x * second.x - z.y * second.y), -(z.x * second.y + z.y * second.x));
        return Orders(first, second, third);
    }
    // 1/z, one factor at a time: |z|^2 overflows first
    vec2 inverse = vec2(z.x, -z.y) / modulus / modulus;
    vec2 third = scaled_e3_fraction(z, modulus);
    vec2 rest = vec2(1.0 - 2.0 * third.x, -2.0 * third.y);
    vec2 second = vec2(rest.x * inverse.x - rest.y * inverse.y, rest.x * inverse.y + rest.y * inverse.x);
    rest = vec2(1.0 - second.x, -second.y);
    vec2 first = vec2(rest.x * inverse.x - rest.y * inverse.y, rest.x * inverse.y + rest.y * inverse.x);
    return Orders(first, second, third);
}
