// Chen, Baran, Durand and Jarosz 2011: the ray's row of the rectified shadow map has a threshold in each column, and
// the ray is lit where its own cotangent is not below it. A node of the row's tree whose least and largest threshold
// lie on one side of the ray settles all of its columns at once (visibilities/min_max.py).
#include "visibility/parts/rectified.glsl"

#if SHADOW_GIVEN == 0
layout(std430, binding = 4) readonly buffer MinMaxTrees { vec2 bounds[]; };
#endif

// A ray in its row, whose columns share out `ends`. Its t begins `start` behind the eye, and all that counts of it is
// from t = range.x to range.y.
struct RowOfColumns { int number; vec2 ends; Slope slope; float start; vec2 range; };

float border(RowOfColumns row, int i) { return mix(row.ends.x, row.ends.y, float(i) / float(columns)); }

int column_at(RowOfColumns row, float t) {
    float place = (crossed_at(row.slope, row.start + t) - row.ends.x) / (row.ends.y - row.ends.x);
    return clamp(int(floor(place * float(columns))), 0, columns - 1);
}

// The t at which the ray enters column i.
float entry(RowOfColumns row, int i) { return crossing(row.slope, border(row, i)) - row.start; }

// The first column from i to `last` that is not as `is_lit` says, or the one behind `last`.
int end_of_run(Ray ray, Light light, RowOfColumns row, int i, int last, bool is_lit) {
#if SHADOW_GIVEN == 1
    for (; i <= last; ++i) {
        float begin = max(entry(row, i), row.range.x), end = i < last ? entry(row, i + 1) : row.range.y;
        if (in_shadow(light, ray.o + 0.5 * (begin + end) * ray.d) == is_lit) break;
    }
    return i;
#else
    float cotangent = row.slope.cosine / row.slope.sine;
    int base = 2 * columns * row.number, level = 0;
    while (i <= last) {
        COUNT_READ;
        vec2 node = bounds[base + ((columns + i) >> level)];
        if (is_lit ? cotangent >= node.y : cotangent < node.x) {
            i += 1 << level;
            // a node that begins here and is twice as long
            if (((i >> level) & 1) == 0) ++level;
        } else if (level == 0) return i;
        else --level;
    }
    return last + 1;
#endif
}

void visibility(Ray ray, Light light) {
    vec2 range = cone_interval(ray, light);
    if (range.x >= range.y) return;
    int number = existing_plane(int(round(plane_of(ray.d))));
    float start = dot(ray.o - camera_to_world[3].xyz, ray.d);
    RowOfColumns row = RowOfColumns(number, column_range(light, side_of(number)), slope_of(light, ray.d), start, range);
    int first = column_at(row, range.x), last = column_at(row, range.y), i = first;
    // the model is called at one place, as it stands in the program once for each
    for (bool is_lit = false; i <= last; is_lit = !is_lit) {
        int begin = i;
        i = end_of_run(ray, light, row, i, last, is_lit);
        if (!is_lit || i == begin) continue;
        float t0 = begin == first ? range.x : entry(row, begin);
        float dt = begin > first && i <= last ? between_crossings(row.slope, border(row, begin), border(row, i))
                                              : (i > last ? range.y : entry(row, i)) - t0;
        if (dt > 0.0) lit(t0, dt, 1.0);
    }
}
