// Slices, each the part of the image that one epipolar plane holds, with samples evenly spread along it.
#include "camera_ray.glsl"
#include "epipolar_planes.glsl"

uniform ivec2 lattice_size;   // samples on a slice, slices

// Of a pixel, cut off the image's borders: less than what epipolar_planes.py cuts off, so that the outermost planes do
// more than touch what is left.
const float SLICE_INSET = 0.25;
const float AXIS_ITSELF = 1e30;

// Where a slice has its first and its last sample, the one nearest to the light [pixel].
struct Slice { vec2 from; vec2 to; };

vec2 position_seen(vec3 local) { return 0.5 * (1.0 - local.xy / (local.z * tan_half)) * vec2(image_size); }

// A plane holds the directions kappa a + e, a the axis, e the side, kappa the cotangent of the angle to the axis. The
// image's four borders are planes through the eye too: with the inward normal n a direction is in the image where
// kappa (n . a) + n . e >= 0, which is linear wherever the light may be.
Slice slice_of(int plane) {
    mat3 to_camera = transpose(mat3(camera_to_world));
    vec3 a = to_camera * epipolar_axis, e = to_camera * side_of(plane);
    vec2 edges = tan_half * (1.0 - 2.0 * SLICE_INSET / vec2(image_size));
    vec4 slope = vec4(a.z * edges - a.xy, a.z * edges + a.xy), inside = vec4(e.z * edges - e.xy, e.z * edges + e.xy);
    vec2 kappa = vec2(-AXIS_ITSELF, AXIS_ITSELF);
    for (int i = 0; i < 4; ++i) {
        if (slope[i] > 0.0) kappa.x = max(kappa.x, -inside[i] / slope[i]);
        if (slope[i] < 0.0) kappa.y = min(kappa.y, -inside[i] / slope[i]);
    }
    Slice slice = Slice(position_seen(kappa.x * a + e), position_seen(kappa.y * a + e));
    if (a.z > 0.0) {
        // In the light airlight grows without bounds. No sample comes nearer than half a spacing, so that those of
        // opposite slices are one apart.
        vec2 along = slice.to - slice.from;
        float spacing = length(along) / float(lattice_size.x - 1), space = distance(slice.to, position_seen(a));
        if (space < 0.5 * spacing) slice.to -= (0.5 * spacing - space) * normalize(along);
    }
    return slice;
}

vec2 position_on(Slice slice, int number) {
    return mix(slice.from, slice.to, float(number) / float(lattice_size.x - 1));
}

vec2 position_of(ivec2 cell) { return position_on(slice_of(cell.y), cell.x); }
