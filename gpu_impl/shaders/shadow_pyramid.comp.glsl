// One level of the shadow map's pyramid from the one below (visibility/parts/shadow_pyramid.glsl).
#include "visibility/parts/shadow_pyramid.glsl"

layout(local_size_x = 8, local_size_y = 8) in;
layout(rg32f) uniform writeonly image2D nodes;
uniform int level;

void main() {
    int size = tile_size >> level, below = tile_size >> (level - 1);
    ivec2 node = ivec2(gl_GlobalInvocationID.xy);
    int tile = node.x / size;
    node.x -= tile * size;
    if (tile >= TILES || node.y >= size) return;
    // the last takes three where the level below has an odd number
    ivec2 first = 2 * node, last = ivec2(node.x + 1 < size ? first.x + 1 : below - 1,
                                         node.y + 1 < size ? first.y + 1 : below - 1);
    vec2 found = vec2(3e38, -3e38);
    for (int y = first.y; y <= last.y; ++y) {
        for (int x = first.x; x <= last.x; ++x) {
            vec2 here = distances_in(ivec2(x, y), level - 1, tile);
            found = vec2(min(found.x, here.x), max(found.y, here.y));
        }
    }
    imageStore(nodes, ivec2(tile * size + node.x, node.y), vec4(found, 0.0, 0.0));
}
