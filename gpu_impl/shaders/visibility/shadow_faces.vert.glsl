// All of the picture, and the faces of a light's shadow volumes: behind an edge, away from the light, without end; and
// their caps before the near plane, where a ray does not end on them. No face reaches beyond its corners, which neighbours share: each pixel is covered as often as volumes begin and end there.
#include "camera_ray.glsl"

struct Face { vec4 a, b, c; };
layout(std430, binding = 4) readonly restrict buffer Faces { Face faces[]; };
struct Draw { uint corners, instances, first, base; int inside; };
layout(std430, binding = 5) readonly restrict buffer Draws { Draw draws[]; };

uniform Light light;
uniform mat4 world_to_lattice;   // to the clip space of the lattice's pixels
flat out vec4 face_plane;        // normal, and the eye's distance times its length; 0 for all of the picture
flat out float face_volumes;     // see shadow_faces/buffers.glsl; for all of the picture how bright it is without faces

vec3 away_from_light(vec3 vertex) { return DIRECTIONAL == 1 ? light.direction : vertex - light.position; }

void main() {
    if (gl_VertexID < 3) {
        gl_Position = vec4(vec2[3](vec2(-1, -1), vec2(3, -1), vec2(-1, 3))[gl_VertexID], 0.0, 1.0);
        face_plane = vec4(0.0);
        face_volumes = float(1 - draws[0].inside);
        return;
    }
    Face face = faces[(gl_VertexID - 3) / 6];
    int number = (gl_VertexID - 3) % 6;
    face_volumes = face.a.w;
    vec3 eye = camera_to_world[3].xyz;
    if (face.c.w == 1.0) {
        // the second triangle of a cap is nowhere
        vec3 v = number == 0 ? face.a.xyz : number == 1 ? face.b.xyz : face.c.xyz;
        gl_Position = number < 3 ? world_to_lattice * vec4(v, 1.0) : vec4(0.0, 0.0, 0.0, 1.0);
        vec3 normal = cross(face.b.xyz - face.a.xyz, face.c.xyz - face.a.xyz);
        face_plane = vec4(normal, dot(normal, face.a.xyz - eye));
        return;
    }
    // corners 0 and 1 are the edge's, 2 and 3 lie behind them
    int corner = int[6](0, 1, 2, 2, 1, 3)[number];
    vec3 v = (corner & 1) == 0 ? face.a.xyz : face.b.xyz;
    gl_Position = world_to_lattice * (corner < 2 ? vec4(v, 1.0) : vec4(away_from_light(v), 0.0));
    vec3 normal = cross(away_from_light(face.a.xyz), face.b.xyz - face.a.xyz);
    face_plane = vec4(normal, dot(normal, face.a.xyz - eye));
}
