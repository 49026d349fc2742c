// A light as seen from one ray.
#include "contract.glsl"

// Where the ray passes the light: distance h, and t_h, the coordinate of the light's projection (Weng 2010, Fig. 4.6).
struct Passage { float h; float t_h; };

Passage passage(Ray ray, Light light) {
    vec3 to_light = light.position - ray.o;
    float t_h = dot(to_light, ray.d);
    // The cross product keeps h accurate where the ray passes close by. A ray through the light meets a singularity
    // that no pixel can show; h is kept at a millionth of the distance, which float32 resolves.
    float h = length(cross(to_light, ray.d));
    return Passage(max(h, 1e-6 * max(abs(t_h), abs(ray.t_max - t_h))), t_h);
}

// Mitsuba's spot: linear in the angle between the beam's edge and the cutoff. 1 for a point light.
float falloff(Light light, vec3 point) {
    vec3 from_light = point - light.position;
    // atan, not acos: accurate near the axis too
    float angle = atan(length(cross(light.direction, from_light)), dot(light.direction, from_light));
    if (angle <= light.beam_width) return 1.0;
    if (angle >= light.cutoff_angle) return 0.0;
    return (light.cutoff_angle - angle) / (light.cutoff_angle - light.beam_width);
}

// The part of the ray inside a spot's cone, as (begin, end), empty where begin >= end; the whole ray for a point light.
vec2 cone_interval(Ray ray, Light light) {
    vec2 whole = vec2(0.0, ray.t_max);
    if (light.cutoff_angle > 1.5707) return whole;
    // Counted from the light's projection s = t - t_h, where q is orthogonal to d and half the terms vanish:
    // inside where (q.a + s d.a)^2 >= cos^2 (|q|^2 + s^2) on the nappe that is lit.
    vec3 to_light = light.position - ray.o;
    float t_h = dot(to_light, ray.d);
    vec3 q = ray.d * t_h - to_light;
    float cosine = cos(light.cutoff_angle), c2 = cosine * cosine;
    float da = dot(ray.d, light.direction), qa = dot(q, light.direction);
    float a = da * da - c2, b = da * qa, c = qa * qa - c2 * dot(q, q);
    if (abs(a) < 1e-7) a = a < 0.0 ? -1e-7 : 1e-7;
    float discriminant = b * b - a * c;
    if (discriminant <= 0.0) return vec2(0.0);
    // the root without cancellation first, the other from the product of the two
    float r = -(b + (b < 0.0 ? -1.0 : 1.0) * sqrt(discriminant));
    float s0 = r / a, s1 = r == 0.0 ? s0 : c / r;
    vec2 s = vec2(min(s0, s1), max(s0, s1));
    if (a > 0.0) {
        // the ray ends up inside a nappe on either side; the lit one lies where it runs along the axis
        s = da > 0.0 ? vec2(s.y, 3e38) : vec2(-3e38, s.x);
    } else if (qa + 0.5 * (s.x + s.y) * da < 0.0) {
        return vec2(0.0);
    }
    return vec2(max(whole.x, t_h + s.x), min(whole.y, t_h + s.y));
}
