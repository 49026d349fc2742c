// Henyey and Greenstein 1941; g > 0 is forward.
uniform float g;
float phase(float cos_theta) {
    float s = 1.0 + g * g - 2.0 * g * cos_theta;
    return 0.0795774715459477 * (1.0 - g * g) / (s * sqrt(s));
}
// its poles in v lie at +-i (1 - g) / (1 + g)
float phase_scale() { return sqrt((1.0 - g) / (1.0 + g)); }
