// A shadow polygon: the part of the plane through light and edge that lies behind the edge, two triangles without a far
// end, or one that lies beyond whatever is seen.
#include "camera_ray.glsl"
#include "lattice.glsl"
#include "shadow_volume/edges.glsl"

uniform Light light;
uniform mat4 world_to_lattice;   // to the clip space of the lattice's pixels
flat out vec4 plane;             // xyz: normal in the camera's frame, w: its distance from the eye times its length

// By so much of its length an edge is made longer at either end: polygons that meet in a corner end where they must, each by
// itself, so that their common side is not rasterised alike, and a ray along it could slip through.
const float OVERLAP = 1.0 / 16.0;
// And by so many pixels of the lattice: a rasteriser rounds corners to 1 / 256 of one, and a fine mesh's edge that is seen
// from afar may be shorter than that.
const float ROUNDED = 1.0 / 128.0;

// The corner behind `v`; w = 0 for one without end. Around the light the polygon's far side is parallel to its edge.
vec4 far_corner(vec3 v, float end) {
    vec3 away = away_from(light, v);
    if (end > 1e6) return vec4(away, 0.0);
    return vec4(DIRECTIONAL == 1 ? v + away * max(end - dot(v - light.position, away), 0.0)
                                  : light.position + away * max(end, 1.0), 1.0);
}

void main() {
    uvec4 edge = silhouette[uint(gl_VertexID) / QUAD_CORNERS];
    vec3 a = vertices[edge.x].xyz, b = vertices[edge.y].xyz;
    // corners 0 and 1 are the edge's, 2 and 3 lie behind them
    int corner = int[6](0, 1, 2, 2, 1, 3)[uint(gl_VertexID) % QUAD_CORNERS];
    vec3 v = (corner & 1) == 0 ? a : b, outwards = (corner & 1) == 0 ? a - b : b - a;
    float pixel = 2.0 * tan_half.x * float(downsample) / float(image_size.x) * abs((world_to_lattice * vec4(v, 1.0)).w);
    v += (OVERLAP + ROUNDED * pixel / length(outwards)) * outwards;
    gl_Position = world_to_lattice * (corner < 2 ? vec4(v, 1.0) : far_corner(v, uintBitsToFloat(edge.z)));
    vec3 normal = shadow_plane(light, a, b);
    plane = vec4(normal * mat3(camera_to_world), dot(normal, a - camera_to_world[3].xyz));
}
