// Rayleigh 1871, normalised: 3 / (16 pi) (1 + cos^2). The thesis's 3/4 (chapter 5) integrates to 4 pi.
float phase(vec2 half_angle) {
    float cos_theta = half_angle.x - half_angle.y;
    return 0.0596831036594608 * (1.0 + cos_theta * cos_theta);
}

float phase_scale() { return 1.0; }

int phase_kinks() { return 0; }
float phase_kink(int i) { return 0.0; }
