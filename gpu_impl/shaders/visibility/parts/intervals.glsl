// Weng 2010, Algorithm 4.1, repaired. A lit interval begins and ends halfway between the two samples that bracket the
// change; one still open where the shadow region ends is reported too. As printed, the first is shifted by half a step
// and the second is lost.
#include "shadow_lookup.glsl"

// Loops that run to the next change, rather than one that asks at each sample whether there was a change: the airlight is
// then evaluated once an interval also where neighbouring pixels share one instruction stream.
//
// STEPS samples are taken in `region`; what of `range` lies before or behind it is lit.
void report_intervals(Ray ray, Light light, vec2 range, vec2 region) {
    int steps = region.x < region.y ? STEPS : 0;
    float dt = (region.y - region.x) / float(STEPS), before = region.x - range.x, behind = range.y - region.y;
    vec3 first = ray.o + (region.x + 0.5 * dt) * ray.d, stride = dt * ray.d;
    bool is_lit = before > 0.0;
    int i = 0;
    while (true) {
        // each sample is looked up once: the one that ends a run is known when the next begins
        while (!is_lit && i < steps && in_shadow(light, first + float(i) * stride)) ++i;
        int begin = i;
        if (!is_lit && i < steps) ++i;
        while (i < steps && !in_shadow(light, first + float(i) * stride)) ++i;
        // the length is added up, as float32 would lose it in a difference of the ends
        float dt_lit = (is_lit ? before : 0.0) + float(i - begin) * dt + (i == steps ? behind : 0.0);
        if (dt_lit > 0.0) lit(is_lit ? range.x : region.x + float(begin) * dt, dt_lit, 1.0);
        is_lit = false;
        if (i == steps) break;
        ++i;
    }
}
