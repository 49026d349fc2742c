// What the two passes know that find the faces of a light's shadow volumes; why these are all, shadow_casters.py says.
#include "contract.glsl"

layout(std430, binding = 0) readonly restrict buffer Vertices { vec4 vertices[]; };
layout(std430, binding = 1) readonly restrict buffer Triangles { uvec4 triangles[]; };   // three vertices, and its part
// two vertices, where the edge's triangles begin in `sides`, how many there are
layout(std430, binding = 2) readonly restrict buffer Edges { uvec4 edges[]; };
// twice a triangle's number, and 1 more where the triangle runs along its edge from the second vertex to the first
layout(std430, binding = 3) readonly restrict buffer Sides { uint sides[]; };
// of each triangle: 1 where it faces the light, -1 where it looks away, 0 where it is seen edge-on
layout(std430, binding = 4) restrict buffer Facing { int facing[]; };
// Of each part, whose first is all that is not closed, triangles between eye and light that face the light and that look
// away from it; and how many more the line from the eye passes from inside than from outside behind the light.
struct Part { int towards, away, around_light; };
layout(std430, binding = 5) restrict buffer Parts { Part parts[]; };
// A face's two vertices on the ground, or a cap's three, whose c.w is 1; a.w: how many volumes begin where one goes through
// it from its front.
struct Face { vec4 a, b, c; };
layout(std430, binding = 6) writeonly restrict buffer Faces { Face faces[]; };
// What glMultiDrawArraysIndirect takes: all of the picture, and the faces of each work group. Behind each is room for a
// number; the first has how many volumes the eye is in.
struct Draw { uint corners, instances, first, base; int inside; };
layout(std430, binding = 7) restrict buffer Draws { Draw draws[]; };

uniform Light light;
