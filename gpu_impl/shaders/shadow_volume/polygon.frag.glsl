// Where a pixel's own ray crosses the plane of the polygon, not where an interpolated depth puts it. Blending keeps the
// smallest of both components: the first crossing, and the last with its sign changed.
#include "camera_ray.glsl"
#include "lattice.glsl"

uniform sampler2D limits;
flat in vec4 plane;
out vec2 crossing;

void main() {
    ivec2 lattice = ivec2(gl_FragCoord.xy);
    vec4 limit = texelFetch(limits, lattice, 0);
    float depth = plane.w / dot(plane.xyz, vec3(on_view_plane(pixel_of(lattice)), 1.0));
    float t = depth * limit.z - limit.w;
    // also false where the ray runs within the plane
    crossing = t > limit.x && t < limit.y ? vec2(t, -t) : vec2(3e38);
}
