// The march of Wyman and Ramsey 2008: steps are taken between the first and the last shadow polygon and nowhere else, and
// each of them whose middle is lit is a piece of its own. What is lit before and behind the shadow region is one piece
// each; without a shadow there is one, and no step.
#include "light.glsl"
#include "shadow_region.glsl"

void visibility(Ray ray, Light light) {
    vec2 range = cone_interval(ray, light);
    if (range.x >= range.y) return;
    vec2 region = shadow_region(ray, light, range, true);
    int steps = region.x < region.y ? STEPS : 0;
    float dt = (region.y - region.x) / float(STEPS);
    // the part before the region is step -1 and the part behind it the last: all pieces are handed over at one place
    for (int i = -1; i <= steps; ++i) {
        bool is_step = 0 <= i && i < steps;
        float t0 = i < 0 ? range.x : i < steps ? region.x + float(i) * dt : region.y;
        float length = i < 0 ? region.x - range.x : i < steps ? dt : range.y - region.y;
        if (length > 0.0 && !(is_step && in_shadow(light, ray.o + (t0 + 0.5 * length) * ray.d))) lit(t0, length, 1.0);
    }
}
