// A march of STEPS equal steps over the ray, one piece for each step whose midpoint is lit (Nishita 1987). The ray ends at
// the surface or, sooner, where the driver's fog leaves float32 nothing to add (scattering.frag.glsl).
#include "contract.glsl"
#include "shadow_lookup.glsl"

void visibility(Ray ray, Light light) {
    float dt = ray.t_max / float(STEPS);
    for (int i = 0; i < STEPS; ++i) {
        float t0 = float(i) * dt;
        if (!in_shadow(light, ray.o + (t0 + 0.5 * dt) * ray.d)) lit(t0, dt, 1.0);
    }
}
