// Distance from the light, or along parallel light; blending keeps the smallest, so that no depth buffer limits its
// precision.
uniform vec3 light_position;
uniform vec3 parallel_to;   // the way of parallel light, 0 for any other
in vec3 position;
out float nearest;
void main() {
    vec3 from_light = position - light_position;
    nearest = parallel_to == vec3(0.0) ? length(from_light) : dot(from_light, parallel_to);
}
