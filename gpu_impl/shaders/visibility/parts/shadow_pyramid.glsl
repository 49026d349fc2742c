// The least and the largest distance of every square of 2^level texels of a tile of the shadow map.
//
// A level has half as many nodes on a side as the one below, rounded down, as OpenGL's mip levels have; the last in a
// row takes what is left over.
#include "shadow_lookup.glsl"

uniform sampler2D shadow_pyramid;   // exact.py: its mip level 0 is level 1, since level 0 is the map

struct Node { ivec2 number; ivec2 first; ivec2 last; };   // and its first and last texel

Node node_around(ivec2 texel, int level) {
    int size = tile_size >> level;
    ivec2 number = min(texel >> level, ivec2(size - 1)), last = ((number + 1) << level) - 1;
    return Node(number, number << level, ivec2(number.x + 1 < size ? last.x : tile_size - 1,
                                               number.y + 1 < size ? last.y : tile_size - 1));
}

vec2 distances_in(ivec2 node, int level, int tile) {
    if (level == 0) return vec2(stored_distance(node, vec3(0.0, 0.0, tile)));
    COUNT_READ;
    return texelFetch(shadow_pyramid, ivec2(tile * (tile_size >> level) + node.x, node.y), level - 1).rg;
}
