// Weng 2010, Algorithms 4.1 and 4.2, repaired: samples are taken between the first and the last shadow polygon and
// nowhere else, and neighbouring ones that are lit make one interval. Before and behind the shadow region the ray is lit:
// an interval goes on there, with as much of the region as it takes up. Without a shadow there is one, and no sample.
#include "light.glsl"
#include "shadow_region.glsl"
#include "visibility/parts/intervals.glsl"

void visibility(Ray ray, Light light) {
    vec2 range = cone_interval(ray, light);
    if (range.x < range.y) report_intervals(ray, light, range, shadow_region(ray, light, range, true));
}
