// As uniform_march_jittered.glsl, with the fractions from a tile of blue noise (blue_noise.py): neighbours differ as much as
// can be, so that where an error follows the fraction evenly it has no low frequencies, which are those that are seen. At
// the edge of a shadow it jumps, and keeps some.
#include "visibility/parts/march.glsl"

uniform sampler2D blue_noise;   // the tile; its values are spread evenly over 0 to 1

void visibility(Ray ray, Light light) {
    ivec2 texel = ivec2(gl_FragCoord.xy) % textureSize(blue_noise, 0);
    march(ray, light, texelFetch(blue_noise, texel, 0).r);
}
