// The lit intervals that were handed in: no map, no step, no polygon. Ends of the ray are those that came with them, so
// that they are not cut at this pass's own idea of the surface.
#include "given.glsl"

void visibility(Ray ray, Light light) {
    uvec2 range = given_range();
    for (uint i = range.x; i < range.y; ++i)
        lit(given_intervals[i].x - current_start, given_intervals[i].y, 1.0);
}
