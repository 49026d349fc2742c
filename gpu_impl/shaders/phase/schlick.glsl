// Blasi, Le Saec and Schlick 1993; k > 0 is forward.
uniform float k;

float phase(vec2 half_angle) {
    // 1 - k cos(theta), without its cancellation at the peak
    float s = 1.0 - abs(k) + 2.0 * abs(k) * (k > 0.0 ? half_angle.y : half_angle.x);
    return 0.0795774715459477 * (1.0 - k) * (1.0 + k) / (s * s);
}

// (p(-1) / p(1))^(1/4), the scale of its lobe
float phase_scale() { return sqrt((1.0 - k) / (1.0 + k)); }

int phase_kinks() { return 0; }
float phase_kink(int i) { return 0.0; }
