// Weng 2010, Algorithms 4.1 and 4.2 as printed, in the reading `algorithm_4_1_printed_loop_mended` of
// analytic/thesis/sampling.py: "While (current sample pass out the shadow region)" would never be entered, no sample
// would be taken, and nothing between the shadow polygons would be lit; the sentence before the algorithm has the steps
// repeated "until the ray passes out the shadow region", and so has this. All else stands as printed:
// - startPos has no value before a sample is lit behind a dark one: a lit beginning cannot be stored;
// - an interval ends with its first dark sample and begins with its first lit one: each is shifted by half a step;
// - one that is open where the region ends is not stored;
// - the final polygon may lie behind the surface. Samples are then taken there too, and the part from it to the surface
//   runs backwards: Eq. 16 takes it away;
// - a ray that begins in the dark is lit up to its first polygon, and one without a polygon is lit all over.
// Polygons are those of all silhouettes, whatever the light's cone; the driver cuts pieces at the cone.
#include "shadow_region.glsl"

void visibility(Ray ray, Light light) {
    vec2 polygons = front_and_final();
    float front = polygons.x, final = polygons.y, surface = ray.t_max;
    bool enters = front < surface, was_lit = false;
    float dt = (final - front) / float(STEPS);
    vec3 first = ray.o + (front + 0.5 * dt) * ray.d, stride = dt * ray.d;
    if (enters) was_lit = !in_shadow(light, first);
    // One piece after the other, all handed over at one place: the model stands in the program once, however long it is.
    float t0 = 0.0, length = enters ? front : surface, w = 1.0;
    int start = -1, i = 1;
    bool is_last = !enters;
    while (true) {
        if (length > 0.0) lit(t0, length, w);
        if (is_last) break;
        bool is_stored = false;
        while (i < STEPS && !is_stored) {
            bool is_lit = !in_shadow(light, first + float(i) * stride);
            is_stored = was_lit && !is_lit && start >= 0;
            if (is_stored) {
                t0 = front + (float(start) + 0.5) * dt;
                length = float(i - start) * dt;
            }
            if (!was_lit && is_lit) start = i;
            was_lit = is_lit;
            ++i;
        }
        if (!is_stored) {
            t0 = min(final, surface);
            length = abs(surface - final);
            w = final < surface ? 1.0 : -1.0;
            is_last = true;
        }
    }
}
