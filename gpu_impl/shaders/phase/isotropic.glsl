// Isotropic scattering, 1/sr.
float phase(float cos_theta) { return 0.0795774715459477; }
// the scale of v = tan(theta / 2) on which the function changes: sets the map of the quadrature
float phase_scale() { return 1.0; }
