// Joint bilateral upsampling (Weng 2010, section 1.2: "Bilateral filter"): the four nearest evaluated pixels, weighted
// by their closeness in the image and by how well their surface distance and normal agree with this pixel's.
uniform sampler2D scattering;            // evaluated on every N-th pixel
uniform sampler2D normal_and_distance;   // at full resolution
uniform int downsample;
uniform ivec2 image_size;
out vec4 result;

const float DISTANCE_SIGMA = 0.05;   // relative difference of distance at which a neighbour counts 1/e

vec4 surface(ivec2 pixel) {
    vec4 found = texelFetch(normal_and_distance, min(pixel, image_size - 1), 0);
    // where there is no surface the background is one, infinitely far
    return vec4(found.xyz, found.w > 0.0 ? found.w : 1e30);
}

void main() {
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    vec4 here = surface(pixel);
    vec2 coarse = (vec2(pixel) - float(downsample / 2)) / float(downsample);
    ivec2 base = ivec2(floor(coarse)), last = textureSize(scattering, 0) - 1;
    vec2 fraction = coarse - vec2(base);
    vec4 sum = vec4(0.0);
    float total = 0.0;
    for (int i = 0; i < 4; ++i) {
        ivec2 corner = ivec2(i & 1, i >> 1), at = clamp(base + corner, ivec2(0), last);
        vec4 there = surface(at * downsample + downsample / 2);
        vec2 near = mix(1.0 - fraction, fraction, vec2(corner));
        float apart = abs(there.w - here.w) / (DISTANCE_SIGMA * min(there.w, here.w));
        // a background has no normal: there the distance alone decides
        float agree = dot(here.xyz, here.xyz) * dot(there.xyz, there.xyz) > 0.0 ? max(dot(there.xyz, here.xyz), 0.0) : 1.0;
        // never quite zero: where no neighbour fits, the nearest still fill the pixel
        float weight = (near.x * near.y + 1e-4) * (exp(-apart) * agree + 1e-6);
        sum += weight * texelFetch(scattering, at, 0);
        total += weight;
    }
    result = sum / total;
}
