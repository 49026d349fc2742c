// A march whose samples are the middles of STEPS equal steps over the ray (Nishita 1987). The ray ends at the surface or,
// sooner, where the driver's fog leaves float32 nothing to add (scattering.frag.glsl).
#include "visibility/parts/march.glsl"

void visibility(Ray ray, Light light) { march(ray, light, 0.5); }
