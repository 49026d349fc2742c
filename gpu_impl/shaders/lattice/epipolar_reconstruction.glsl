// A pixel's value from two samples on each of its two neighbouring slices, those beside the foot of the pixel on them,
// weighted by how near they are and how well the surface that ends their ray agrees with the pixel's own.
#include "lattice/epipolar.glsl"

uniform sampler2D scattering;            // a row for each slice
uniform sampler2D normal_and_distance;   // at full resolution; distance 0 where there is no surface

const float SURFACE_SIGMA = 0.02;    // relative difference of distance at which a sample counts a quarter
const float LEAST_NEAR = 1e-4;       // of a sample's weight: where those beside the pixel see other surfaces
const float BACKGROUND = 1e30;       // where there is no surface the background is one, infinitely far

float distance_seen(ivec2 pixel) {
    float found = texelFetch(normal_and_distance, pixel, 0).w;
    return found > 0.0 ? found : BACKGROUND;
}

// How far a pixel's surface is from that of another, relative to the distance of both: they have one distance, or the
// other lies on the plane that the first one's normal spans.
float surface_apart(ivec2 pixel, ivec2 other) {
    float here = distance_seen(pixel), there = distance_seen(other), most = max(here, there);
    Ray ray = camera_ray(pixel), to_other = camera_ray(other);
    vec3 normal = texelFetch(normal_and_distance, pixel, 0).xyz;
    float on_plane = dot(ray.o + here * ray.d - to_other.o, normal) / dot(to_other.d, normal);
    float apart = abs(here - there) / most, off_plane = abs(on_plane - there) / most;
    // not a number where there is no normal, and then the comparison is false
    return off_plane < apart ? off_plane : apart;
}

vec4 upsampled(ivec2 pixel) {
    vec2 here = vec2(pixel) + 0.5;
    float plane = plane_of(camera_ray(pixel).d), weights = 0.0;
    vec4 sum = vec4(0.0);
    for (int side = 0; side < 2; ++side) {
        int number = existing_plane(int(floor(plane)) + side);
        Slice slice = slice_of(number);
        vec2 along = slice.to - slice.from;
        float foot = clamp(dot(here - slice.from, along) / max(dot(along, along), 1e-12), 0.0, 1.0);
        foot *= float(lattice_size.x - 1);
        int before = min(int(foot), lattice_size.x - 2);
        for (int i = before; i <= before + 1; ++i) {
            float near = max(0.0, 1.0 - abs(plane - floor(plane) - float(side))) * (1.0 - abs(foot - float(i)));
            float apart = surface_apart(pixel, ivec2(position_on(slice, i))) / SURFACE_SIGMA, fit = 1.0 + apart * apart;
            float weight = (near + LEAST_NEAR) / (fit * fit);
            sum += weight * texelFetch(scattering, ivec2(i, number), 0);
            weights += weight;
        }
    }
    return sum / weights;
}
