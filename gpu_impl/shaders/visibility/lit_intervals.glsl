// Weng 2010, Algorithm 4.1, repaired. A lit interval begins and ends halfway between the two samples that bracket the
// change; one still open where the shadow region ends is reported too. As printed, the first is shifted by half a step
// and the second is lost.
//
// The shadow region (Algorithm 4.2) is the part of the ray in which samples are taken; before and behind it the ray is
// lit. Here it is the part inside the light's cone, or the whole ray under a point light.
#include "light.glsl"
#include "shadow_lookup.glsl"

// Two loops that run to the next change, rather than one that asks at each sample whether there was a change: the
// airlight is then evaluated once an interval also where neighbouring pixels share one instruction stream.
void visibility(Ray ray, Light light) {
    vec2 region = cone_interval(ray, light);
    if (region.x >= region.y) return;
    float dt = (region.y - region.x) / float(STEPS);
    vec3 first = ray.o + (region.x + 0.5 * dt) * ray.d, stride = dt * ray.d;
    for (int i = 0; i < STEPS; ++i) {
        while (i < STEPS && in_shadow(light, first + float(i) * stride)) ++i;
        if (i == STEPS) break;
        int begin = i++;
        while (i < STEPS && !in_shadow(light, first + float(i) * stride)) ++i;
        lit(region.x + float(begin) * dt, float(i - begin) * dt, 1.0);
    }
}
