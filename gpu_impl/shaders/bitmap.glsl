// A picture looked up as Mitsuba's `bitmap` does: row 0 at v = 0, texel centres at (i + 1/2) / n.
struct Bitmap { mat3x2 to_uv; bool nearest; int wrap; };   // wrap: 0 repeat, 1 mirror, 2 clamp

ivec2 wrapped(ivec2 texel, ivec2 size, int wrap) {
    if (wrap == 2) return clamp(texel, ivec2(0), size - 1);
    // GLSL leaves % of negative numbers open
    ivec2 period = wrap == 1 ? 2 * size : size;
    ivec2 m = texel - period * ivec2(floor(vec2(texel) / vec2(period)));
    m = clamp(m, ivec2(0), period - 1);
    return min(m, period - 1 - m + (wrap == 1 ? ivec2(0) : size));
}

vec3 look_up(sampler2D pixels, Bitmap bitmap, vec2 uv) {
    ivec2 size = textureSize(pixels, 0);
    vec2 place = (bitmap.to_uv * vec3(uv, 1.0)) * vec2(size);
    if (bitmap.nearest) return texelFetch(pixels, wrapped(ivec2(floor(place)), size, bitmap.wrap), 0).rgb;
    place -= 0.5;
    ivec2 base = ivec2(floor(place));
    vec2 f = place - vec2(base);
    vec3 corner[4];
    for (int i = 0; i < 4; ++i)
        corner[i] = texelFetch(pixels, wrapped(base + ivec2(i & 1, i >> 1), size, bitmap.wrap), 0).rgb;
    return mix(mix(corner[0], corner[1], f.x), mix(corner[2], corner[3], f.x), f.y);
}
