// The slices of Dobashi 2002: planes parallel to the image, each a mesh of cells, CELL pixels of the lattice on a side. At
// the cells' corners the airlight of the slab around the slice is evaluated, but for light and shadow and what the light
// sends in each direction, which change from pixel to pixel.
//
// An instance is a row of cells of one slice, as a strip of triangles.
#undef SPOT
#undef SPOT_TEXTURE
#define SPOT 0
#define SPOT_TEXTURE 0
#include "camera_ray.glsl"
#include "fog.glsl"
#include "lattice.glsl"
#include "<airlight>"
#include "slices/range.glsl"

uniform Light light;
uniform ivec2 lattice_size;
flat out vec2 slice;         // depth of its middle along the viewing axis, and how thick its slab is
out vec3 corner_airlight;

void main() {
    int rows = (lattice_size.y + CELL - 1) / CELL, number = gl_InstanceID / rows, row = gl_InstanceID % rows;
    // from the lattice's corner, in its pixels; the last cells may reach beyond it
    vec2 place = float(CELL) * vec2(gl_VertexID / 2, row + gl_VertexID % 2);
    gl_Position = vec4(2.0 * place / vec2(lattice_size) - 1.0, 0.0, 1.0);
    corner_airlight = vec3(0.0);
    float first = uintBitsToFloat(first_depth), thickness = (uintBitsToFloat(last_depth) - first) / float(STEPS);
    slice = vec2(first + (float(number) + 0.5) * thickness, thickness);
    if (first_depth >= last_depth) {
        // no ray has fog that the light reaches: all corners in one place
        gl_Position = vec4(0.0, 0.0, 0.0, 1.0);
        return;
    }
    Ray ray = camera_ray((place - 0.5) * float(downsample) + vec2(first_pixel) + 0.5);
    float stretch = 1.0 / dot(ray.d, camera_to_world[2].xyz), dt = thickness * stretch;
    // with as much fog before the slice as there is before this corner, whether that is in fog or not
    float t = (slice.x - clip_planes.x) * stretch;
    vec2 fog = fog_interval(ray.o, ray.d, vec2(0.0, t));
    float way = fog.y - fog.x;
    ray = Ray(ray.o + (t - way) * ray.d, ray.d, way + 0.5 * dt);
    corner_airlight = airlight(ray, light, way - 0.5 * dt, dt);
}
