#include "fog.glsl"

// How much of the way from a point to the light is fog.
float light_leg(Light light, vec3 point) {
    vec3 to_light = DIRECTIONAL == 1 ? -light.direction : light.position - point;
    float d = DIRECTIONAL == 1 ? 3e38 : length(to_light);
#if FOG_PLANES == 0 && FOG_BALL == 0
    return d;
#else
    if (d == 0.0) return 0.0;
    vec2 line = fog_interval(point, DIRECTIONAL == 1 ? to_light : to_light / d, vec2(0.0, d));
    return line.y - line.x;
#endif
}
