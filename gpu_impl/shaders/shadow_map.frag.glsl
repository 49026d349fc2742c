// Distance to the light; blending keeps the smallest, so that no depth buffer limits its precision.
uniform vec3 light_position;
in vec3 position;
out float nearest;
void main() { nearest = distance(position, light_position); }
