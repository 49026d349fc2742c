// Point samples at equal steps over the piece, as dense as those of a march of STEPS steps over the whole ray: what is
// left of such a march where its pieces are the exact ones, and longer than a step.
#include "contract.glsl"
#include "light.glsl"
#include "light_leg.glsl"
#include "<phase>"
// one sample, under another name
#define airlight point_sample
#include "airlight/riemann.glsl"
#undef airlight

vec3 airlight(Ray ray, Light light, float t0, float dt) {
    // a piece of one step is one sample, whatever its rounding
    int samples = max(int(ceil(dt * float(STEPS) / ray.t_max - 0.01)), 1);
    float step_length = dt / float(samples);
    vec3 sum = vec3(0.0);
    for (int i = 0; i < samples; ++i) sum += point_sample(ray, light, t0 + float(i) * step_length, step_length);
    return sum;
}
