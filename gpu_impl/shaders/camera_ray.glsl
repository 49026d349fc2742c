// The ray of a pixel, or of any place in the image, the same arithmetic as scenes.model.Camera.rays; row 0 is the top of the image.
#include "contract.glsl"

uniform mat4 camera_to_world;
uniform vec2 tan_half;      // of the horizontal and vertical field of view
uniform vec2 clip_planes;   // near, far
uniform ivec2 image_size;

// Where a position in the image lies on the plane at distance 1 before the eye; the first pixel's centre is (0.5, 0.5).
vec2 on_view_plane(vec2 position) { return (1.0 - 2.0 * position / vec2(image_size)) * tan_half; }

vec2 on_view_plane(ivec2 pixel) { return on_view_plane(vec2(pixel) + 0.5); }

// How much longer the ray is than its part along the viewing axis.
float axis_stretch(vec2 position) {
    vec2 local = on_view_plane(position);
    return sqrt(1.0 + dot(local, local));
}

Ray camera_ray(vec2 position) {
    float stretch = axis_stretch(position);
    vec3 d = mat3(camera_to_world) * (vec3(on_view_plane(position), 1.0) / stretch);
    return Ray(camera_to_world[3].xyz + d * (clip_planes.x * stretch), d, (clip_planes.y - clip_planes.x) * stretch);
}

Ray camera_ray(ivec2 pixel) { return camera_ray(vec2(pixel) + 0.5); }
