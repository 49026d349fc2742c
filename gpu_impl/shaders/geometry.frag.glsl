// What the eye sees first: normal and distance along the pixel's own ray, and the material.
#include "camera_ray.glsl"
uniform vec4 material;   // reflectance, 1 if two-sided
in vec3 position;
in vec3 normal;
layout(location = 0) out vec4 normal_and_distance;
layout(location = 1) out vec4 surface_material;
void main() {
    Ray ray = camera_ray(ivec2(gl_FragCoord.xy));
    normal_and_distance = vec4(normalize(normal), dot(position - ray.o, ray.d));
    surface_material = material;
}
