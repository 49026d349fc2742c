// How the geometry pass packs what it knows of a surface beside its normal and distance.

// A direction of any length on an octahedron, unfolded to a square (Meyer et al. 2010).
uint packed_direction(vec3 d) {
    float taxicab = abs(d.x) + abs(d.y) + abs(d.z);
    vec2 p = taxicab > 0.0 ? d.xy / taxicab : vec2(0.0);
    if (d.z < 0.0) p = (1.0 - abs(p.yx)) * vec2(p.x < 0.0 ? -1.0 : 1.0, p.y < 0.0 ? -1.0 : 1.0);
    return packSnorm2x16(p);
}

// Unit length; off by at most 6.2e-5 over 65,536 directions.
vec3 unpacked_direction(uint bits) {
    vec2 p = unpackSnorm2x16(bits);
    vec3 d = vec3(p, 1.0 - abs(p.x) - abs(p.y));
    float below = max(-d.z, 0.0);
    d.xy += vec2(p.x < 0.0 ? below : -below, p.y < 0.0 ? below : -below);
    return normalize(d);
}

// A reflectance is not negative, so that its sign bit is free.
uvec4 packed_material(vec3 reflectance, float two_sided, vec3 triangle_normal) {
    uvec3 bits = floatBitsToUint(abs(reflectance));
    return uvec4(bits.r | (two_sided > 0.0 ? 0x80000000u : 0u), bits.gb, packed_direction(triangle_normal));
}

vec3 diffuse_reflectance(uvec4 material) { return uintBitsToFloat(material.rgb & 0x7fffffffu); }
bool is_two_sided(uvec4 material) { return (material.r & 0x80000000u) != 0u; }
