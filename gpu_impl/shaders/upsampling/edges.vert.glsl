// A square point over each cell of the lattice whose corners do not see one surface; the others are left out.
uniform sampler2D cells;
uniform ivec2 image_size;
uniform int downsample;

void main() {
    int columns = textureSize(cells, 0).x;
    ivec2 cell = ivec2(gl_VertexID % columns, gl_VertexID / columns);
    // OpenGL drops points whose middle lies outside the image: the last ones are pushed back and cover their neighbours too
    vec2 middle = vec2(min(cell * downsample, image_size)) / vec2(image_size);
    bool edge = texelFetch(cells, cell, 0).x > 0.0;
    gl_Position = edge ? vec4(2.0 * middle - 1.0, 0.0, 1.0) : vec4(2.0, 2.0, 2.0, 1.0);
    gl_PointSize = float(downsample);
}
