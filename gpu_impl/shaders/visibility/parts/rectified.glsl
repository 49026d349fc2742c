// The rectified shadow map's geometry (visibilities/min_max.py). In an epipolar plane, x towards the light along the
// axis and y along its side, the eye at 0 and the light at (D, 0):
//     a ray of the eye      t (cos gamma, sin gamma)
//     a ray of the light    (D, 0) + r (-cos beta, sin beta), or y = b for parallel light
// They cross at t = D sin beta / sin(gamma + beta), or b / sin gamma. A row's columns are even in beta, or in b: in c.
#include "light.glsl"
#include "camera_ray.glsl"
#include "epipolar_planes.glsl"
#include "shadow_lookup.glsl"

uniform int columns;   // of a row, a power of two

const float PI = 3.14159265;
const float NOWHERE = 3e38;
const float ON_AXIS = 1e-20;   // sine of a ray along the axis, so that its cotangent is a number

float distance_to_light(Light light) { return distance(light.position, camera_to_world[3].xyz); }

// The c that a row's columns share out, (least, most).
vec2 column_range(Light light, vec3 side) {
#if DIRECTIONAL == 1
    // the part of y that is over the map, and a column on either side, so that what lies beyond is lit as these are
    vec4 eye = tile_matrix * vec4(camera_to_world[3].xyz, 1.0), way = tile_matrix * vec4(side, 0.0);
    vec2 over = vec2(0.0, NOWHERE);
    for (int i = 0; i < 2; ++i) {
        if (way[i] == 0.0) continue;
        vec2 ends = (vec2(-1.0, 1.0) - eye[i]) / way[i];
        over = vec2(max(over.x, min(ends.x, ends.y)), min(over.y, max(ends.x, ends.y)));
    }
    if (over.x >= over.y) return vec2(0.0, 1.0);
    float column = (over.y - over.x) / float(columns - 2);
    return vec2(max(over.x - column, 0.0), over.y + column);
#elif SPOT > 0
    // A light ray is at the angle w to the spot's axis where A (-cos beta) + B sin beta = cos w, so that the cone holds
    // the beta within acos(cos cutoff / R) of phi, R and phi being the polar form of (-A, B).
    vec2 polar = vec2(-dot(light.direction, epipolar_axis), dot(light.direction, side));
    float phi = atan(polar.y, polar.x), within = acos(clamp(cos(light.cutoff_angle) / length(polar), -1.0, 1.0));
    vec2 once = vec2(phi - within, phi + within), again = once + 2.0 * PI;
    vec2 first = clamp(once, 0.0, PI), second = clamp(again, 0.0, PI);
    if (first.x >= first.y) return second;
    return second.x >= second.y ? first : vec2(min(first.x, second.x), max(first.y, second.y));
#else
    return vec2(0.0, PI);
#endif
}

// Cotangent of the gamma at which the light ray at c meets its first occluder: rays of the eye whose gamma is larger,
// and whose cotangent is smaller, cross it in the dark. Cotangents are compared without an arc tangent.
float threshold(Light light, vec3 side, float c) {
    vec3 eye = camera_to_world[3].xyz;
#if DIRECTIONAL == 1
    vec3 point = eye + c * side;
    float met = nearest_surface(light, point);
    return met >= NOWHERE ? -NOWHERE : (distance_from(light, point) - met) / max(c, ON_AXIS);
#else
    float D = distance_to_light(light);
    // a light in the eye leaves no shadow that is seen
    if (D == 0.0) return -NOWHERE;
    float met = nearest_surface(light, light.position + D * (sin(c) * side - cos(c) * epipolar_axis));
    return met >= NOWHERE ? -NOWHERE : (D / met - cos(c)) / max(sin(c), ON_AXIS);
#endif
}

// A ray of the eye, by the angle gamma to the axis.
struct Slope { float cosine; float sine; float D; };

Slope slope_of(Light light, vec3 direction) {
    float sine = max(length(cross(direction, epipolar_axis)), ON_AXIS);
    return Slope(dot(direction, epipolar_axis), sine, distance_to_light(light));
}

// The c of the light ray that crosses it at t, counted from the eye.
float crossed_at(Slope slope, float t) {
    return DIRECTIONAL == 1 ? t * slope.sine : atan(t * slope.sine, slope.D - t * slope.cosine);
}

// sin(gamma + beta), 0 where the crossing is infinitely far.
float convergence(Slope slope, float c) { return slope.sine * cos(c) + slope.cosine * sin(c); }

// The t at which it is crossed by the light ray at c.
float crossing(Slope slope, float c) {
    return DIRECTIONAL == 1 ? c / slope.sine : slope.D * sin(c) / max(convergence(slope, c), 1e-30);
}

// The difference of two crossings, which in float32 would lose its digits.
float between_crossings(Slope slope, float from, float to) {
    if (DIRECTIONAL == 1) return (to - from) / slope.sine;
    return slope.D * slope.sine * sin(to - from) / (convergence(slope, from) * convergence(slope, to));
}
