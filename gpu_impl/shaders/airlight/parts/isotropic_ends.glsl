// The isotropic closed form of Weng 2010, repaired: the prefactor is e^{kappa_t (x_a - x_h)}, and the second
// formulation takes J(H, ...). Eq. 32 makes the antiderivatives of the two formulations one function.
#include "airlight/parts/closed_form.glsl"
#include "airlight/parts/antiderivatives.glsl"

// L / (I sigma_s) from the integral of e^{-Hv} / (1 + v^2)
float from_integral(Passage p, float extinction, float integral) {
    return exp(-extinction * p.t_h) * integral / (6.28318531 * p.h);
}
