// Resamples the shadow map into rows of thresholds, and builds a tree of least and largest thresholds over each row
// (visibilities/min_max.py). One work group makes one row.
#include "visibility/parts/rectified.glsl"
layout(local_size_x = 128) in;

// Row after row; in a row node n has the children 2 n and 2 n + 1, the root is 1, and the columns begin at `columns`.
layout(std430, binding = 4) coherent buffer MinMaxTrees { vec2 bounds[]; };

uniform Light light;

void main() {
    int row = int(gl_WorkGroupID.x), base = 2 * columns * row;
    vec3 side = side_of(row);
    vec2 range = column_range(light, side);
    for (int i = int(gl_LocalInvocationID.x); i < columns; i += int(gl_WorkGroupSize.x)) {
        // Light rays are taken in the middles of columns, but for a column that begins in the axis: what stands there
        // hides the light from the eye, and the rays next to the axis are dark.
        float place = float(i) + (i == 0 && range.x == 0.0 ? 0.0 : 0.5);
        bounds[base + columns + i] = vec2(threshold(light, side, mix(range.x, range.y, place / float(columns))));
    }
    for (int level = columns / 2; level > 0; level /= 2) {
        memoryBarrierBuffer();
        barrier();
        for (int n = level + int(gl_LocalInvocationID.x); n < 2 * level; n += int(gl_WorkGroupSize.x)) {
            vec2 first = bounds[base + 2 * n], second = bounds[base + 2 * n + 1];
            bounds[base + n] = vec2(min(first.x, second.x), max(first.y, second.y));
        }
    }
}
