// Henyey and Greenstein 1941; g > 0 is forward.
uniform float g;

float phase(vec2 half_angle) {
    // 1 + g^2 - 2 g cos(theta), without its cancellation at the peak
    float s = (1.0 - abs(g)) * (1.0 - abs(g)) + 4.0 * abs(g) * (g > 0.0 ? half_angle.y : half_angle.x);
    return 0.0795774715459477 * (1.0 - g) * (1.0 + g) / (s * sqrt(s));
}

// (p(-1) / p(1))^(1/4), the scale of its lobe
float phase_scale() {
    float lobe = (1.0 - g) / (1.0 + g);
    return sqrt(lobe * sqrt(lobe));
}

int phase_kinks() { return 0; }
float phase_kink(int i) { return 0.0; }
