// A march of STEPS equal steps over the ray, one piece for each step whose sample is lit.
#include "shadow_lookup.glsl"

// The samples stand `offset` of a step behind the beginnings of their steps, 0 to 1: the regular march has 1/2. With an
// offset that is drawn evenly, every point of the ray is as likely to be sampled as any other, so that the mean over
// offsets is the integral. For that to hold, each sample has to count for a whole step, in the middle of its piece,
// which is where a model that samples its pieces looks. Of the first or the last piece a part would lie outside the
// ray. To cut it off there alone would move its middle, and brighten or darken the mean; so as much is cut off at the
// other end too, and what is left stands for the whole by its weight.
void march(Ray ray, Light light, float offset) {
    // a sample at the very end of the ray would be left with a piece of no length
    const float nearest = 1.0 / 8192.0;
    offset = clamp(offset, nearest, 1.0 - nearest);
    float dt = ray.t_max / float(STEPS), inside = min(2.0 * offset, 2.0 - 2.0 * offset);
    int cut = offset < 0.5 ? 0 : STEPS - 1;
    for (int i = 0; i < STEPS; ++i) {
        float part = i == cut ? inside : 1.0, t0 = (float(i) + offset - 0.5 * part) * dt, length = part * dt;
        if (!in_shadow(light, ray.o + (t0 + 0.5 * length) * ray.d)) lit(t0, length, 1.0 / part);
    }
}
