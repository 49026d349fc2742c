uniform mat4 world_to_clip;
in vec3 in_position;
in vec3 in_normal;
in vec3 in_coordinates;
out vec3 position;
out vec3 normal;
out vec3 coordinates;
void main() {
    position = in_position;
    normal = in_normal;
    coordinates = in_coordinates;
    gl_Position = world_to_clip * vec4(in_position, 1.0);
}
