// The march as engines ship it against bands: neighbouring rays take their samples at other fractions of a step. These are
// interleaved gradient noise (Jimenez 2014, "Next Generation Post Processing in Call of Duty: Advanced Warfare"), which has
// nearly all fractions within any 3 x 3 rays, so that a small blur would take the noise away. None follows here: what is
// compared is the march.
#include "visibility/parts/march.glsl"

// `place` is a pixel's centre [pixel of the lattice]; the constants are Jimenez's
float interleaved_gradient_noise(vec2 place) {
    return fract(52.9829189 * fract(dot(place, vec2(0.06711056, 0.00583715))));
}

void visibility(Ray ray, Light light) { march(ray, light, interleaved_gradient_noise(gl_FragCoord.xy)); }
