// The surface at which the ray ends, and which texels of the shadow map see it too.
//
// A texel is a sample, the distance along its middle. Taken for the distance of all directions in it, a slanted surface
// shades what lies before it, and lets light through to what lies behind it, for up to half a texel. At the end of a ray
// there is more to know: where the sample lies in the plane of the triangle that ends the ray, that triangle is what the
// texel sees, and the ray is before it up to its end, or behind it.
#include "ray_in_fog.glsl"
#include "current_ray.glsl"
#include "gbuffer.glsl"
#include "surface_shadow.glsl"

uniform usampler2D surface_material;

// The receiver of the light, where the ray meets it, the cosine at which it does, and whether from the lit side.
struct SeenSurface { Receiver receiver; float t; float cosine; bool from_lit_side; };

const float ROUNDING = 1e-4;   // of the distances of a map and of a plane, relative

SeenSurface seen_surface(Ray ray, Light light) {
    ivec2 pixel = ivec2(position_of(ivec2(gl_FragCoord.xy)));
    float distance = texelFetch(normal_and_distance, pixel, 0).w;
    SeenSurface seen;
    seen.t = 3e38;
    seen.cosine = 1.0;
    if (distance == 0.0) return seen;
    seen.t = distance - current_start;
    vec3 point = ray.o + seen.t * ray.d, normal = unpacked_direction(texelFetch(surface_material, pixel, 0).a);
    float to_plane = DIRECTIONAL == 1 ? dot(normal, light.direction) : dot(normal, point - light.position);
    seen.cosine = abs(dot(normal, ray.d));
    seen.from_lit_side = dot(normal, ray.d) * to_plane > 0.0;
    seen.receiver = receiver_of(light, point, normal, map_position(light, point));
    return seen;
}

// Whether a texel may mistake the seen surface for an occluder of the ray at t, or overlook it, at most `distance` from
// the light: over half a texel's diagonal the plane's height above the light changes by up to 0.71 texel_slope distance,
// and the ray is (seen.t - t) cosine before it. A whole one leaves room for the bias.
bool is_near(SeenSurface seen, float t, float distance) {
    return (seen.t - t) * seen.cosine <= texel_slope * (DIRECTIONAL == 1 ? 1.0 : distance);
}

// Whether the texel's sample lies on the seen surface.
bool sees(Light light, SeenSurface seen, ivec2 texel, int tile, float stored) {
    float here = plane_distance(light, seen.receiver, vec3(middle_of(texel), tile));
    return abs(stored - here) <= seen.receiver.bias + ROUNDING * seen.receiver.distance;
}
