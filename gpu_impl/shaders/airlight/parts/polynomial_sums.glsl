// Integrals of polynomials against e^{-Hv} / (1 + v^2) and e^{H/w} / (1 + w^2): Weng 2010, Eqs. 23, 24, 28 and 29,
// their brackets, summed as printed. The same in numpy: analytic/models/weng2010/antiderivatives.py.

// TERMS coefficients FRONT (c_n, in powers of v) and BACK (d_n, in powers of w); LEVEL where only the first is not 0
#include "<polynomials>"

// (-1)^{n/2}, the quotient rounded down
float alternating(int n) { return (n / 2) % 2 == 0 ? 1.0 : -1.0; }

float whole_power(float x, int n) {
    float power = 1.0;
    for (int i = 0; i < n; ++i) power *= x;
    return power;
}

// c(a, j, n) of Eq. 23 at a = -H: the sum of +-(i + j)! / j! H^-(i+1) over every other i
float c_sum(float H, int j, int n) {
    float sum = 0.0, term = 1.0 / H;
    for (int i = 0; i < n - 1 - j; ++i) {
        if ((n - i - j) % 2 == 0) sum += alternating(n - i - j) * term;
        term *= float(i + j + 1) / H;
    }
    return sum;
}

// d(a, j, n) of Eq. 28 at a = H: the sum of +-j! / (i + j + 1)! H^i over every other i
float d_sum(float H, int j, int n) {
    float sum = 0.0, term = 1.0 / float(j + 1);
    for (int i = 0; i < n - 1 - j; ++i) {
        if ((n - i - j) % 2 == 0) sum += alternating(n - i - j) * term;
        term *= H / float(i + j + 2);
    }
    return sum;
}

// Sum of c_n times the integral of e^{-Hv} v^n / (1 + v^2) from v_a to v_b; `both` is I_0, I_1 (Eq. 24).
float first_sum(float H, float v_a, float v_b, vec2 both) {
    float sum = FRONT[0] * both.x;
    if (LEVEL) return sum;
    float at_a = exp(-H * v_a), at_b = exp(-H * v_b);
    for (int n = 1; n < TERMS; ++n) {
        if (FRONT[n] == 0.0) continue;      // its sum may overflow
        float inner = alternating(n) * (n % 2 == 0 ? both.x : both.y), power_a = at_a, power_b = at_b;
        for (int j = 0; j < n - 1; ++j) {
            inner += (power_b - power_a) * c_sum(H, j, n);
            power_a *= v_a;
            power_b *= v_b;
        }
        sum += FRONT[n] * inner;
    }
    return sum;
}

// e^{exponent} w^{j+1} of Eq. 28, or what Eq. 29 prints in its place: the model defines it.
float power_at(float exponent, float w, int j);

// Sum of d_n times the integral of e^{H/w} w^n / (1 + w^2) from w_a to w_b (Eq. 29); `both` is J_0, J_1, `real` is J_e.
float second_sum(float H, float w_a, float w_b, vec2 both, float real) {
    float sum = BACK[0] * both.x;
    if (LEVEL) return sum;
    for (int n = 1; n < TERMS; ++n) {
        if (BACK[n] == 0.0) continue;
        float inner = alternating(n) * (n % 2 == 0 ? both.x : both.y);
        for (int j = 0; j < n - 1; ++j)
            inner -= (power_at(H / w_b, w_b, j) - power_at(H / w_a, w_a, j)) * d_sum(H, j, n);
        if (n > 1) inner += real * H * d_sum(H, 0, n);
        sum += BACK[n] * inner;
    }
    return sum;
}
