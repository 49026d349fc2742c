// Which rays a lattice evaluates: position in the image [pixel], how far behind the beginning of the camera's ray the fog
// begins, and how long the ray in fog is [scene unit].
#include "ray_in_fog.glsl"

uniform Light light;
out vec4 place;

void main() {
    ivec2 cell = ivec2(gl_FragCoord.xy);
    float start;
    Ray ray = ray_in_fog(cell, light, start);
    place = vec4(position_of(cell), start, ray.t_max);
}
