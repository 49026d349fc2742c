// What the eye sees first: normal and distance along the pixel's own ray, the material, and the triangle's own normal.
#include "camera_ray.glsl"
#include "bitmap.glsl"
#include "gbuffer.glsl"

uniform vec4 diffuse;            // reflectance, 1 if two-sided
uniform vec4 specular;           // reflectance, exponent
#if PICTURE == 1                 // in place of the diffuse reflectance
uniform sampler2D picture;
uniform Bitmap picture_bitmap;
uniform int mapping;             // 0: coordinates are (u, v); 1, 2, 3: the place on a unit sphere, cylinder or disk
in vec3 coordinates;

// (u, v) as Mitsuba's shapes define them, taken from the place itself: no triangle has to bridge a seam or a pole.
vec2 uv() {
    if (mapping == 0) return coordinates.xy;
    float around = atan(coordinates.y, coordinates.x) * 0.159154943091895;
    if (around < 0.0) around += 1.0;
    if (mapping == 1) return vec2(around, atan(length(coordinates.xy), coordinates.z) * 0.318309886183791);
    return mapping == 2 ? vec2(around, coordinates.z) : vec2(length(coordinates.xy), around);
}
#endif
in vec3 position;
in vec3 normal;
layout(location = 0) out vec4 normal_and_distance;
layout(location = 1) out uvec4 surface_material;
#if SPECULAR == 1
layout(location = 2) out vec4 surface_specular;
#endif

void main() {
    Ray ray = camera_ray(ivec2(gl_FragCoord.xy));
    // a file may hold a normal of length zero: its surface is black, as in Mitsuba
    float length2 = dot(normal, normal);
    normal_and_distance = vec4(length2 > 0.0 ? normal * inversesqrt(length2) : vec3(0.0), dot(position - ray.o, ray.d));
    vec3 reflectance = diffuse.rgb;
#if PICTURE == 1
    reflectance = look_up(picture, picture_bitmap, uv());
#endif
    surface_material = packed_material(reflectance, diffuse.a, cross(dFdx(position), dFdy(position)));
#if SPECULAR == 1
    surface_specular = specular;
#endif
    // The logarithm of the depth along the axis: resolved alike near and far, where z / w has most of its steps in front
    // of the near plane, and Mitsuba's default near plane is a hundredth.
    gl_FragDepth = log2(1.0 / (gl_FragCoord.w * clip_planes.x)) / log2(clip_planes.y / clip_planes.x);
}
