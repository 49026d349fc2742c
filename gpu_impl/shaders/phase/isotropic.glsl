// Isotropic scattering, 1/sr.
//
// Every phase function takes half_angle = (cos^2(theta/2), sin^2(theta/2)), theta the scattering angle: both are known
// without cancellation, which 1 - cos(theta) at a forward peak is not. cos(theta) is their difference.
float phase(vec2 half_angle) { return 0.0795774715459477; }

// (p(-1) / p(1))^(1/4), the scale of v = tan(theta / 2) on which the function changes: sets the map of the quadrature
float phase_scale() { return 1.0; }

// where its slope jumps: how many places there are, and their v in ascending order
int phase_kinks() { return 0; }
float phase_kink(int i) { return 0.0; }
