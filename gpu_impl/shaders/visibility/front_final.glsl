// What methods draw that know the first and the last shadow polygon and nothing between: lit before the one and behind the
// other, dark between, so that a gap between two shadows is dark too (Weng 2010, Figure 1.1: "the region between d2 and
// d3 is too dark"). A ray that begins or ends in the dark has one polygon or none, and is dark on that side of it.
#include "light.glsl"
#include "shadow_region.glsl"

void visibility(Ray ray, Light light) {
    vec2 range = cone_interval(ray, light);
    if (range.x >= range.y) return;
    vec2 region = shadow_region(ray, light, range, false);
    // without a shadow the region is empty and the first piece is all of the range
    for (int side = 0; side < 2; ++side) {
        float begin = side == 0 ? range.x : region.y, dt = side == 0 ? region.x - range.x : range.y - region.y;
        if (dt > 0.0) lit(begin, dt, 1.0);
    }
}
