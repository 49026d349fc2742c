uniform mat4 world_to_clip;
in vec3 in_position;
out vec3 position;
void main() {
    position = in_position;
    gl_Position = world_to_clip * vec4(in_position, 1.0);
}
