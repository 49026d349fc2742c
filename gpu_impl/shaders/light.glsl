// A light as seen from one ray.
#include "contract.glsl"
#include "bitmap.glsl"

// Where the ray passes the light: distance h, and t_h, the coordinate of the light's projection (Weng 2010, Fig. 4.6).
struct Passage { float h; float t_h; };

Passage passage(Ray ray, Light light) {
    vec3 to_light = light.position - ray.o;
    // The cross product keeps h accurate where the ray passes close by, down to the rounding of to_light itself. Below
    // that h is kept from vanishing: a ray through the light meets a singularity that no pixel can show, and one that
    // runs away from it has a limit that does not depend on h.
    float h = max(length(cross(to_light, ray.d)), max(1e-7 * length(to_light), 1e-15 * ray.t_max));
    return Passage(h, dot(to_light, ray.d));
}

// Mitsuba's spot: linear in the angle between the beam's edge and the cutoff. 1 for any other light.
// SPOT: 0 no spot, 1 a hard one, whose angle need not be known, 2 a soft one.
uniform float tan_cutoff;   // of the cutoff angle: a shader would compute it anew for each pixel
float falloff(Light light, vec3 point) {
#if SPOT == 0
    return 1.0;
#endif
    vec3 from_light = point - light.position;
#if SPOT == 1
    // by the tangent, accurate near the axis too
    float along = dot(light.direction, from_light);
    vec3 aside = cross(light.direction, from_light);
    return along > 0.0 && dot(aside, aside) < tan_cutoff * tan_cutoff * along * along ? 1.0 : 0.0;
#endif
    // atan, not acos: accurate near the axis too
    float angle = atan(length(cross(light.direction, from_light)), dot(light.direction, from_light));
    if (angle <= light.beam_width) return 1.0;
    if (angle >= light.cutoff_angle) return 0.0;
    return (light.cutoff_angle - angle) / (light.cutoff_angle - light.beam_width);
}

#if SPOT_TEXTURE == 1
uniform sampler2D spot_texture;
uniform Bitmap spot_bitmap;
uniform mat4 world_to_light;
#endif

// What of the light's intensity goes towards a point: its falloff, and its picture's colour.
vec3 angular(Light light, vec3 point) {
    vec3 share = vec3(falloff(light, point));
#if SPOT_TEXTURE == 1
    vec3 local = (world_to_light * vec4(point, 1.0)).xyz;
    // the picture fills the square around the cone
    if (share.x > 0.0)
        share *= look_up(spot_texture, spot_bitmap, 0.5 + 0.5 * local.xy / (local.z * tan_cutoff));
#endif
    return share;
}

// The part of the ray inside a spot's cone, as (begin, end), empty where begin >= end; the whole ray for any other
// light.
vec2 cone_interval(Ray ray, Light light) {
    vec2 whole = vec2(0.0, ray.t_max);
#if SPOT == 0
    return whole;
#endif
    // Counted from the light's projection, s = t - t_h, where q is orthogonal to d: inside the double cone where
    // |(q + s d) x axis|^2 <= sin^2 |q + s d|^2. With the sine a narrow cone keeps its digits.
    vec3 to_light = light.position - ray.o;
    float t_h = dot(to_light, ray.d);
    vec3 q = ray.d * t_h - to_light;
    float sine = sin(light.cutoff_angle), s2 = sine * sine;
    float da = dot(ray.d, light.direction), qa = dot(q, light.direction);
    vec3 dx = cross(ray.d, light.direction), qx = cross(q, light.direction);
    float a = s2 - dot(dx, dx), b = -dot(qx, dx), c = s2 * dot(q, q) - dot(qx, qx);
    if (abs(a) < 1e-9) a = a < 0.0 ? -1e-9 : 1e-9;
    // where a > 0 it is negative only by rounding: such a ray ends up inside a nappe whatever happens
    float discriminant = b * b - a * c;
    if (discriminant <= 0.0 && a < 0.0) return vec2(0.0);
    // the root without cancellation first, the other from the product of the two
    float r = -(b + (b < 0.0 ? -1.0 : 1.0) * sqrt(max(discriminant, 0.0)));
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
