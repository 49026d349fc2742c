// A square point over each cell of the lattice whose corners do not see one surface; the others are left out.
#include "lattice.glsl"

uniform sampler2D cells;
uniform ivec2 image_size;

void main() {
    int columns = textureSize(cells, 0).x;
    ivec2 cell = ivec2(gl_VertexID % columns, gl_VertexID / columns);
    // OpenGL drops points whose middle lies outside the image: those are pushed back, and cover neighbours' pixels too
    ivec2 corner = cell * downsample + first_pixel - downsample / 2;
    vec2 middle = vec2(clamp(corner, ivec2(0), image_size)) / vec2(image_size);
    bool edge = texelFetch(cells, cell, 0).x > 0.0;
    gl_Position = edge ? vec4(2.0 * middle - 1.0, 0.0, 1.0) : vec4(2.0, 2.0, 2.0, 1.0);
    gl_PointSize = float(downsample);
}
