// What the eye sees first: normal and distance along the pixel's own ray, the material, and the triangle's own normal.
#include "camera_ray.glsl"
uniform vec4 material;   // reflectance, 1 if two-sided
in vec3 position;
in vec3 normal;
layout(location = 0) out vec4 normal_and_distance;
layout(location = 1) out vec4 surface_material;
layout(location = 2) out vec4 triangle_normal;
void main() {
    Ray ray = camera_ray(ivec2(gl_FragCoord.xy));
    // a file may hold a normal of length zero: its surface is black, as in Mitsuba
    float length2 = dot(normal, normal);
    normal_and_distance = vec4(length2 > 0.0 ? normal * inversesqrt(length2) : vec3(0.0), dot(position - ray.o, ray.d));
    surface_material = material;
    triangle_normal = vec4(cross(dFdx(position), dFdy(position)), 0.0);
    // The logarithm of the depth along the axis: resolved alike near and far, where z / w has most of its steps in front
    // of the near plane, and Mitsuba's default near plane is a hundredth.
    gl_FragDepth = log2(1.0 / (gl_FragCoord.w * clip_planes.x)) / log2(clip_planes.y / clip_planes.x);
}
