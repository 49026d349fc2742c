// Airlight where the light is outside the medium, or infinitely far: only part of its way to the ray is attenuated.
//
// The way ends where it leaves the body that holds the medium. Through plane i of a polytope that is after the share
// a / (a + c) of the way, a the point's distance inside the plane and c the light's outside it; for parallel light after
// the length a / c, c the rate at which it nears the plane. Both grow with q = a / c, so the plane with the least q
// decides; q is linear along the ray, and between the places where another plane takes over everything is smooth.
#include "light.glsl"
#include "light_leg.glsl"

const float THICKEST = 8.0;   // optical depth that one set of nodes takes
const int MOST_PARTS = 64;
const float DARKEST = 88.0;   // beyond this optical depth float32 holds no light

// The mean of e^-s for s that runs evenly from a to b.
vec3 mean_transmittance(vec3 a, vec3 b) {
    vec3 x = abs(b - a), series = 1.0 - x * (0.5 - x * (1.0 / 6.0 - x / 24.0));
    return exp(-min(a, b)) * mix((1.0 - exp(-x)) / max(x, 1e-30), series, lessThan(x, vec3(0.02)));
}

// Gauss-Legendre over a smooth piece, in the angle at which a point light sees it (which cancels 1 / d^2), or in distance.
vec3 smooth_piece(Ray ray, Light light, float t0, float dt) {
    Passage p = passage(ray, light);
    float s_a = t0 - p.t_h, angle = atan(dt * p.h, p.h * p.h + s_a * (s_a + dt));
    vec3 sum = vec3(0.0);
    for (int i = 0; i < NODES; ++i) {
        float tangent = tan(angle * NODE[i]);
        float t = t0 + (DIRECTIONAL == 1 ? dt * NODE[i]
                                          : tangent * (p.h * p.h + s_a * s_a) / (p.h - s_a * tangent));
        vec3 point = ray.o + t * ray.d;
        vec3 l = DIRECTIONAL == 1 ? -light.direction : normalize(light.position - point);
        vec2 half_angle = 0.25 * vec2(dot(l + ray.d, l + ray.d), dot(l - ray.d, l - ray.d));
        sum += WEIGHT[i] * phase(half_angle) * angular(light, point) * exp(-sigma_t * (t + light_leg(light, point)));
    }
    return sum * (DIRECTIONAL == 1 ? dt : angle / p.h);
}

vec3 in_parts(Ray ray, Light light, float t0, float dt) {
    float thinnest = min(sigma_t.x, min(sigma_t.y, sigma_t.z));
    dt = min(dt, DARKEST / max(thinnest, 1e-30) - t0);
    if (dt <= 0.0) return vec3(0.0);
    float thickest = max(sigma_t.x, max(sigma_t.y, sigma_t.z)) * dt;
    int parts = clamp(int(ceil(thickest / THICKEST)), 1, MOST_PARTS);
    vec3 sum = vec3(0.0);
    for (int i = 0; i < parts; ++i) sum += smooth_piece(ray, light, t0 + dt * float(i) / float(parts), dt / float(parts));
    return sum;
}

// For unit intensity (or irradiance) and unit scattering coefficient.
vec3 through_boundary(Ray ray, Light light, float t0, float dt) {
#if FOG_PLANES == 0
    return in_parts(ray, light, t0, dt);
#else
    vec3 sum = vec3(0.0);
    float t = t0, end = t0 + dt;
    for (int piece = 0; piece < FOG_PLANES && t < end; ++piece) {
        // q = level + slope (t' - t) of the plane that decides at t; of two, the one that falls faster
        float level = 3e38, slope = 0.0, next = end;
        // as many pieces as planes at most; what a rounding leaves is the last one's
        bool last = piece == FOG_PLANES - 1;
        for (int pass = 0; pass < 2; ++pass) {
            for (int i = 0; i < FOG_PLANES; ++i) {
                vec3 n = fog_planes[i].xyz;
                float c = DIRECTIONAL == 1 ? -dot(n, light.direction) : dot(n, light.position) - fog_planes[i].w;
                if (c <= 0.0) continue;
                float q = max(fog_planes[i].w - dot(n, ray.o + t * ray.d), 0.0) / c, dq = -dot(n, ray.d) / c;
                if (pass == 0 && (q < level || (q == level && dq < slope))) { level = q; slope = dq; }
                // the first that takes over
                if (pass == 1 && dq < slope && !last) next = min(next, t + max((q - level) / (slope - dq), 1e-6 * dt));
            }
        }
        float length = next - t;
        if (DIRECTIONAL == 1) {
            vec2 half_angle = 0.5 + 0.5 * vec2(-1.0, 1.0) * dot(light.direction, ray.d);
            sum += phase(half_angle) * length
                 * mean_transmittance(sigma_t * (t + level), sigma_t * (next + level + slope * length));
        } else sum += in_parts(ray, light, t, length);
        t = next;
    }
    return sum;
#endif
}
