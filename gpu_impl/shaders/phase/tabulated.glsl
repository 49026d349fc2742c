// A table at equally spaced cos(theta), the last value the forward one; linear in between, normalised [1/sr].
layout(std430, binding = 3) readonly buffer PhaseTable { float phase_table[]; };

float phase(vec2 half_angle) {
    int last = phase_table.length() - 1;
    // (1 + cos(theta)) / 2 = cos^2(theta/2). Counted from the nearer end, so that a steep peak is met without rounding
    bool forward = half_angle.y < half_angle.x;
    float position = (forward ? half_angle.y : half_angle.x) * float(last);
    int i = min(int(position), last - 1);
    float near = phase_table[forward ? last - i : i], far = phase_table[forward ? last - i - 1 : i + 1];
    return mix(near, far, position - float(i));
}

// it is smooth from one value to the next, whatever lobe they show together
float phase_scale() { return 1.0; }

int phase_kinks() { return phase_table.length() - 2; }

// v = tan(theta / 2) of the inner values, from the forward one on
float phase_kink(int i) { return sqrt(float(i + 1) / float(phase_table.length() - 2 - i)); }
