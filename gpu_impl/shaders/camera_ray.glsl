// The ray of a pixel, the same arithmetic as scenes.model.Camera.rays; row 0 is the top of the image.
#include "contract.glsl"

uniform mat4 camera_to_world;
uniform vec2 tan_half;      // of the horizontal and vertical field of view
uniform vec2 clip_planes;   // near, far
uniform ivec2 image_size;

// Where the pixel's centre lies on the plane at distance 1 before the eye.
vec2 on_view_plane(ivec2 pixel) { return (1.0 - (2.0 * vec2(pixel) + 1.0) / vec2(image_size)) * tan_half; }

// How much longer the ray is than its part along the viewing axis.
float axis_stretch(ivec2 pixel) {
    vec2 local = on_view_plane(pixel);
    return sqrt(1.0 + dot(local, local));
}

Ray camera_ray(ivec2 pixel) {
    float stretch = axis_stretch(pixel);
    vec3 d = mat3(camera_to_world) * (vec3(on_view_plane(pixel), 1.0) / stretch);
    return Ray(camera_to_world[3].xyz + d * (clip_planes.x * stretch), d, (clip_planes.y - clip_planes.x) * stretch);
}
