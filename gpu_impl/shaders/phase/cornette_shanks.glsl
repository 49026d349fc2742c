// Cornette and Shanks 1992, Eq. 8: hg.glsl times 3 (1 + cos^2) / (4 + 2 g^2); g > 0 is forward.
uniform float g;

float phase(vec2 half_angle) {
    float cos_theta = half_angle.x - half_angle.y;
    // 1 + g^2 - 2 g cos(theta), without its cancellation at the peak
    float s = (1.0 - abs(g)) * (1.0 - abs(g)) + 4.0 * abs(g) * (g > 0.0 ? half_angle.y : half_angle.x);
    float hg = 0.0795774715459477 * (1.0 - g) * (1.0 + g) / (s * sqrt(s));
    return 1.5 / (2.0 + g * g) * (1.0 + cos_theta * cos_theta) * hg;
}

// (p(-1) / p(1))^(1/4), the scale of its lobe
float phase_scale() {
    float lobe = (1.0 - g) / (1.0 + g);
    return sqrt(lobe * sqrt(lobe));
}

int phase_kinks() { return 0; }
float phase_kink(int i) { return 0.0; }
