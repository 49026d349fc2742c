// A ray as a straight line through the tiles of the shadow map.
//
// `along` counts from the place of the ray's range that is nearest to the light. A position in a tile is homogeneous,
// (x, y, w) with x / w and y / w from -1 to 1, and linear in `along`; so where the line crosses a border of texels is one
// division, and in either direction of the tile it goes one way only.
#include "shadow_lookup.glsl"
#include "visibility/parts/shadow_pyramid.glsl"

struct MapLine { vec3 at; vec3 per_along; };   // position at along = 0, and how fast it changes

// What of the line lies in one tile: where it ends, by which side, and which way it goes there in x and y: -1, 0, 1.
struct Stretch { int tile; MapLine line; ivec2 heading; float end; int side; };

const float NEVER = 3e38;
const int OUTSIDE = -1;   // around a flat map, where nothing casts a shadow

// `nearest`: the place at along = 0, seen from the light
MapLine line_in_tile(int tile, vec3 nearest, vec3 d, Light light) {
#if TILES == 1
    vec3 x = tile_row(0), y = tile_row(1), w = tile_row(3);
    vec3 from = DIRECTIONAL == 1 ? (tile_matrix * vec4(light.position, 1.0)).xyw : vec3(0.0);
    return MapLine(from + vec3(dot(x, nearest), dot(y, nearest), dot(w, nearest)), vec3(dot(x, d), dot(y, d), dot(w, d)));
#else
    // the axes of position_in_cube()
    nearest = in_map_frame(nearest);
    d = in_map_frame(d);
    if (tile == 0) return MapLine(nearest.zyx, d.zyx);
    if (tile == 1) return MapLine(vec3(-nearest.z, nearest.y, -nearest.x), vec3(-d.z, d.y, -d.x));
    if (tile == 2) return MapLine(nearest.xzy, d.xzy);
    if (tile == 3) return MapLine(vec3(-nearest.x, nearest.z, -nearest.y), vec3(-d.x, d.z, -d.y));
    if (tile == 4) return MapLine(vec3(-nearest.x, nearest.yz), vec3(-d.x, d.yz));
    return MapLine(vec3(nearest.xy, -nearest.z), vec3(d.xy, -d.z));
#endif
}

// Where the line comes in between a tile's sides and where it leaves, and by which: 0 and 1 for x = w and x = -w, 2 and 3
// for y. Neighbouring tiles ask about their common side with the same subtractions, so that the one's way out is the
// other's way in, whatever is rounded: no line goes back, and none is caught at a corner.
vec2 inside_of(MapLine line, out int side) {
    vec4 depth = line.at.z + vec4(-line.at.x, line.at.x, -line.at.y, line.at.y);
    vec4 slope = line.per_along.z + vec4(-line.per_along.x, line.per_along.x, -line.per_along.y, line.per_along.y);
    vec2 inside = vec2(-NEVER, NEVER);
    side = -1;
    for (int i = 0; i < 4; ++i) {
        float crossing = -depth[i] / slope[i];
        if (slope[i] > 0.0) inside.x = max(inside.x, crossing);
        if (slope[i] == 0.0 && depth[i] < 0.0) inside.x = NEVER;
        if (slope[i] < 0.0 && crossing < inside.y) {
            inside.y = crossing;
            side = i;
        }
    }
    return inside;
}

Stretch stretch_in(int tile, vec3 nearest, vec3 d, Light light, float begin, float end) {
    MapLine line = line_in_tile(tile, nearest, d, light);
    ivec2 heading = ivec2(sign(line.per_along.xy * line.at.z - line.at.xy * line.per_along.z));
    Stretch stretch = Stretch(tile, line, heading, end, -1);
    // a spot's cone lies in its tile
#if TILES > 1 || DIRECTIONAL == 1
    vec2 inside = inside_of(line, stretch.side);
    stretch.end = clamp(inside.y, begin, end);
#endif
#if DIRECTIONAL == 1
    if (tile == OUTSIDE) {
        stretch.heading = ivec2(0);
        stretch.end = begin < inside.x && inside.x < inside.y ? min(inside.x, end) : end;
    }
#endif
    return stretch;
}

// The first tile of a line that begins at `along`.
Stretch first_stretch(vec3 nearest, vec3 d, Light light, float along, float end) {
#if DIRECTIONAL == 1
    int side;
    vec2 inside = inside_of(line_in_tile(0, nearest, d, light), side);
    int tile = inside.x <= along && along < inside.y ? 0 : OUTSIDE;
#elif TILES == 1
    int tile = 0;
#else
    int tile = int(position_in_cube(in_map_frame(nearest) + along * in_map_frame(d)).z);
#endif
    return stretch_in(tile, nearest, d, light, along, end);
}

// The tile that follows at `along`, where a stretch ends.
Stretch next_stretch(Stretch stretch, vec3 nearest, vec3 d, Light light, float along, float end) {
    // a cube's opposite faces are 2 i and 2 i + 1
    const int BEYOND_X[6] = int[6](4, 5, 0, 1, 1, 0), BEYOND_Y[6] = int[6](2, 2, 4, 4, 2, 2);
#if TILES == 1
    int tile = stretch.tile == OUTSIDE ? 0 : OUTSIDE;
#else
    int tile = (stretch.side < 2 ? BEYOND_X[stretch.tile] : BEYOND_Y[stretch.tile]) ^ (stretch.side & 1);
#endif
    return stretch_in(tile, nearest, d, light, along, end);
}

// Which texel the line is in; one of the tile's whatever is rounded.
ivec2 texel_at(MapLine line, float along) {
    vec3 position = line.at + along * line.per_along;
    // clamped before it is an integer, which may be too small for it: where two sides of a cube meet at the light
    if (position.z <= 0.0) position = line.per_along;
    vec2 texel = floor((0.5 + 0.5 * position.xy / position.z) * float(tile_size));
    return ivec2(clamp(texel, vec2(0.0), vec2(tile_size - 1)));
}

// Where the stretch leaves a node in x and in y; NEVER where it goes another way, and at the sides of the tile.
vec2 crossing_of(Stretch stretch, Node node) {
    ivec2 border = ivec2(stretch.heading.x > 0 ? node.last.x + 1 : node.first.x,
                         stretch.heading.y > 0 ? node.last.y + 1 : node.first.y);
    vec2 place = vec2(2 * border - tile_size) / float(tile_size);
    vec2 slope = stretch.line.per_along.xy - place * stretch.line.per_along.z;
    vec2 crossing = (place * stretch.line.at.z - stretch.line.at.xy) / slope;
    bool x = slope.x * float(stretch.heading.x) > 0.0 && border.x > 0 && border.x < tile_size;
    bool y = slope.y * float(stretch.heading.y) > 0.0 && border.y > 0 && border.y < tile_size;
    return vec2(x ? crossing.x : NEVER, y ? crossing.y : NEVER);
}
