// Weng 2010, Algorithm 4.1, repaired, without shadow polygons: samples are taken on all of the ray that the light's cone
// leaves.
#include "light.glsl"
#include "visibility/parts/intervals.glsl"

void visibility(Ray ray, Light light) {
    vec2 range = cone_interval(ray, light);
    if (range.x < range.y) report_intervals(ray, light, range, range);
}
