// The driver: evaluates one technique for one light on each cell of its lattice. Its result is added to that of other
// lights. rgb: airlight L_m, the radiance that fog scatters to the eye; a: lit pieces that the strategy reported.
#include "ray_in_fog.glsl"
#include "current_ray.glsl"
#include "recording.glsl"
#include "light.glsl"
#include "<airlight>"
#include "<visibility>"

uniform Light light;
layout(location = 0) out vec4 result;

vec2 the_cone;
uniform int turns;                // of a loop that a compiler does not see the end of
const float CUT_OFF = -1e30;      // in place of the number of pieces

#if AIRLIGHT_AT_CORNERS == 1
in vec3 corner_airlight;   // of whole pieces under a light that is alike in all directions
#endif

void add_piece(float t0, float dt, float w) {
    COUNT_PIECE;
    RECORD_PIECE(t0, dt, w);
    result.rgb += w * airlight(current_ray, light, t0, dt);
}

void lit(float t0, float dt, float w) {
    result.a += 1.0;
#if AIRLIGHT_AT_CORNERS == 1
    COUNT_PIECE;
    float middle = t0 + 0.5 * dt;
    // by depth alone all of the cone is lit alike, as it is where the driver cuts pieces
    vec3 share = DEPTH_ONLY == 1 ? vec3(the_cone.x < middle && middle < the_cone.y)
                                 : angular(light, current_ray.o + middle * current_ray.d);
    result.rgb += w * share * corner_airlight;
#else
    if (CLIP_TO_CONE) {
        float begin = max(t0, the_cone.x), end = min(t0 + dt, the_cone.y);
        if (begin >= end) return;
        if (begin > t0 || end < t0 + dt) dt = end - begin;
        t0 = begin;
    }
#if IN_STEPS == 1
    // no longer than a step of STEPS over the ray; a piece of one step stays whole, whatever its rounding
    int parts = max(int(ceil(dt * float(STEPS) / current_ray.t_max - 0.01)), 1);
    dt /= float(parts);
    for (int i = 0; i < parts; ++i) add_piece(t0 + float(i) * dt, dt, w);
#else
    add_piece(t0, dt, w);
#endif
#endif
}

void main() {
    current_ray = ray_in_fog(ivec2(gl_FragCoord.xy), light, current_start);
    result = vec4(0.0);
    START_COUNTING;
    if (current_ray.t_max <= 0.0) return;
    // without the ray's end: pieces end there by themselves, but for those that are taken away behind it (printed.glsl)
    the_cone = cone_interval(Ray(current_ray.o, current_ray.d, 3e38), light);
    visibility(current_ray, light);
    // Software OpenGL may end the loops of an invocation after so many turns, without a word (llvmpipe: 65,535 of all its
    // loops together). Then it ends this one too, and the picture says so.
    int turned = 0;
    for (int i = 0; i < turns; ++i) ++turned;
    if (turned < turns) result.a = CUT_OFF;
}
