// Edges of a scene that are in one light's silhouette, and the call that draws their polygons.
#include "contract.glsl"

layout(std430, binding = 3) readonly restrict buffer Vertices { vec4 vertices[]; };
// Two vertices, and the bits of a number that says where the edge's polygon ends: of how many times the edge's distance
// from the light, or of the distance along parallel light.
layout(std430, binding = 6) restrict buffer Silhouette { uvec4 silhouette[]; };
// what glDrawArraysIndirect takes, and the bits of the distance from the light beyond which nothing is seen
layout(std430, binding = 7) restrict buffer Draw { uint corners, instances, first, base; uint reach; };

const uint QUAD_CORNERS = 6u;   // of its two triangles

// Where a polygon goes on behind a vertex, whatever the length.
vec3 away_from(Light light, vec3 vertex) { return DIRECTIONAL == 1 ? light.direction : vertex - light.position; }

// Normal of the plane through the light and an edge. The edge itself is short, and its difference is nearly exact.
vec3 shadow_plane(Light light, vec3 a, vec3 b) { return cross(away_from(light, a), b - a); }
