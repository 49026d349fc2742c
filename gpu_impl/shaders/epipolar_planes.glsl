// Half-planes that end in the axis from the eye to the light, evenly spread around it (epipolar_planes.py).
uniform vec3 epipolar_axis;     // unit length
uniform vec3 plane_sides[2];    // unit vectors across it, at alpha = 0 and pi / 2
uniform vec2 plane_angles;      // alpha of the first plane, and from each to the next
uniform int plane_count;
uniform int planes_closed;      // 1 where they go all around

// The unit vector across the axis that a plane holds.
vec3 side_of(int plane) {
    float alpha = plane_angles.x + plane_angles.y * float(plane);
    return cos(alpha) * plane_sides[0] + sin(alpha) * plane_sides[1];
}

// Which plane a direction lies in, between two of them a fraction.
float plane_of(vec3 direction) {
    vec2 across = vec2(dot(direction, plane_sides[0]), dot(direction, plane_sides[1]));
    // on the axis itself any plane will do
    float alpha = across == vec2(0.0) ? 0.0 : atan(across.y, across.x);
    return (alpha - plane_angles.x) / plane_angles.y;
}

// The number of a plane that is there, for one up to `plane_count` beyond.
int existing_plane(int plane) {
    return planes_closed == 1 ? (plane + plane_count) % plane_count : clamp(plane, 0, plane_count - 1);
}
