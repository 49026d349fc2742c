// Where the fog is: everywhere, or in a convex body, which is an intersection of FOG_PLANES half-spaces or a ball.
#include "contract.glsl"

#if FOG_PLANES > 0
uniform vec4 fog_planes[FOG_PLANES];   // unit outward normal n and offset o: inside is n . x <= o
#endif
#if FOG_BALL == 1
uniform vec4 fog_ball;                 // centre and radius
#endif

// The part of a line that is in fog, as (begin, end), empty where begin >= end.
vec2 fog_interval(vec3 o, vec3 d, vec2 line) {
#if FOG_PLANES > 0
    for (int i = 0; i < FOG_PLANES; ++i) {
        float slope = dot(fog_planes[i].xyz, d), inside = fog_planes[i].w - dot(fog_planes[i].xyz, o);
        if (slope > 0.0) line.y = min(line.y, inside / slope);
        else if (slope < 0.0) line.x = max(line.x, inside / slope);
        else if (inside < 0.0) return vec2(0.0);
    }
#endif
#if FOG_BALL == 1
    // counted from the centre's projection, where nothing cancels
    vec3 to_centre = fog_ball.xyz - o;
    float t_c = dot(to_centre, d);
    vec3 across = to_centre - t_c * d;
    float half_chord = sqrt(max((fog_ball.w - length(across)) * (fog_ball.w + length(across)), 0.0));
    line = vec2(max(line.x, t_c - half_chord), min(line.y, t_c + half_chord));
#endif
    return line.x < line.y ? line : vec2(0.0);
}

// What a length of fog leaves of the light.
vec3 transmittance(float length_in_fog) {
    return GREY == 1 ? vec3(exp(-sigma_t.x * length_in_fog)) : exp(-sigma_t * length_in_fog);
}
