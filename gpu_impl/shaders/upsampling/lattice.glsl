// The lattice grid/N: the fog is evaluated on every N-th pixel, in x and in y. An upsampling defines
//     vec4 upsampled(ivec2 pixel)
// the value at any pixel of the image.
#include "camera_ray.glsl"

uniform sampler2D scattering;            // evaluated on every N-th pixel
uniform sampler2D normal_and_distance;   // at full resolution; distance 0 where there is no surface
uniform int downsample;                  // N

// The four evaluated pixels around one, and their weights in bilinear interpolation.
struct Corners { ivec2 at[4]; float near[4]; };

Corners corners_of(ivec2 pixel) {
    vec2 coarse = (vec2(pixel) - float(downsample / 2)) / float(downsample);
    ivec2 base = ivec2(floor(coarse)), last = textureSize(scattering, 0) - 1;
    vec2 fraction = coarse - vec2(base);
    Corners corners;
    for (int i = 0; i < 4; ++i) {
        ivec2 corner = ivec2(i & 1, i >> 1);
        vec2 near = mix(1.0 - fraction, fraction, vec2(corner));
        corners.at[i] = clamp(base + corner, ivec2(0), last);
        corners.near[i] = near.x * near.y;
    }
    return corners;
}

// The pixel of the image that an evaluated one stands for.
ivec2 evaluated_pixel(ivec2 at) { return min(at * downsample + downsample / 2, image_size - 1); }

// Normal and distance of what a pixel sees; where there is no surface the background is one, infinitely far.
vec4 seen(ivec2 pixel) {
    vec4 found = texelFetch(normal_and_distance, pixel, 0);
    return vec4(found.xyz, found.w > 0.0 ? found.w : 1e30);
}
