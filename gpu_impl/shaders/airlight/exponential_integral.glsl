// The scaled complex exponential integral F(z) = e^z E1(z) of the first quadrant (z.x >= 0, z.y >= 0, 1e-18 < |z| <
// 1e18). The closed forms need its imaginary part, -G(H, v) with z = H (v + i), far beyond where it is much smaller
// than the real one; so the parts are carried apart, and every sum that makes the imaginary one in the fraction below
// adds terms of one sign. The same operations in numpy: analytic/exponential_integral, scaled_e1 of complex64.
//
// Measured over |z| = 1e-6 .. 1e6, z.y / z.x = 1e-8 .. 1e8, 2.3 million points on llvmpipe (worst relative error of
// the complex value / of the imaginary part): |z| <= 0.6: 3.0e-7 / 8.4e-7; 0.6 to 1: 5.5e-7 / 1.4e-6; above 1:
// 3.9e-7 / 4.2e-7.

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

// |z| > 1: F = 1/(z+1 - 1/(z+3 - 4/(z+5 - 9/(z+7 - ...)))) from the inside out (Abramowitz and Stegun 5.1.22, even
// part). The tails f_k = 1/(z + 2k + 1 - (k+1)^2 f_{k+1}) behave as (1 - sqrt(z/k)) / k, so the innermost is taken as
// the fixed point of 1 = f (z + 2k + 1 - k (k+1) f); at |z| = 1 that needs a depth of 24 where a dropped tail needs 39.
vec2 scaled_e1_fraction(vec2 z, float modulus) {
    int depth = 4;                                      // enough without a tail from |z| = 20 on
    vec2 f = vec2(0.0);
    if (modulus < 20.0) {
        depth = int(ceil(2.0 + 22.0 / modulus));        // at most 24
        float p = 2.0 * float(depth) + 1.0;
        // b + sqrt(b^2 - 4k(k+1)), b = z + p; the discriminant is z^2 + 2 z p + 1
        vec2 root = upper_square_root(vec2(z.x * z.x - z.y * z.y + 2.0 * z.x * p + 1.0, 2.0 * z.y * (z.x + p)));
        vec2 d = vec2(z.x + p, z.y) + root;
        f = vec2(d.x, -d.y) * (2.0 / dot(d, d));
    }
    for (int i = 0; i < 24; ++i) {
        if (i == depth)
            break;
        float n = float(depth - i);
        vec2 d = vec2(z.x + (2.0 * n - 1.0), z.y) - n * n * f;
        f = vec2(d.x, -d.y) / dot(d, d);
    }
    return f;
}

vec2 scaled_e1(vec2 z) {
    float modulus = length(z);
    return modulus <= 1.0 ? scaled_e1_series(z, modulus) : scaled_e1_fraction(z, modulus);
}
