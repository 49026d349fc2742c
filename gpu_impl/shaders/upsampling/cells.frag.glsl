// Decides once for each cell of the lattice whether its four corners see one surface, so that the many pixels in it need
// not: the depths are alike, or lie on the plane that the first corner's normal spans.
#include "upsampling/parts/guides.glsl"

const float ALIKE = 0.02;      // relative difference of distance
const float ON_PLANE = 0.01;   // of the distance along a corner's own ray

out vec4 distances;

bool lies_on(vec3 point, vec3 normal, Ray ray, float distance) {
    // false where the ray runs along the plane, or has none
    return abs(dot(point - ray.o, normal) / dot(ray.d, normal) - distance) < ON_PLANE * distance;
}

void main() {
    ivec2 cell = ivec2(gl_FragCoord.xy);
    bool coplanar = true;
    vec3 point, normal;
    for (int i = 0; i < 4; ++i) {
        ivec2 pixel = pixel_of(corner_of(cell, i));
        Ray ray = camera_ray(pixel);
        distances[i] = distance_seen(pixel);
        if (i == 0) {
            point = ray.o + distances[0] * ray.d;
            normal = texelFetch(normal_and_distance, pixel, 0).xyz;
        } else coplanar = coplanar && lies_on(point, normal, ray, distances[i]);
    }
    float least = min(min(distances.x, distances.y), min(distances.z, distances.w));
    float most = max(max(distances.x, distances.y), max(distances.z, distances.w));
    if (coplanar || most < (1.0 + ALIKE) * least) distances = vec4(-1.0);
}
