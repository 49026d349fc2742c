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

// The receiver of the light, whether the ray comes to it from the lit side, and from where on a texel may mistake it.
struct SeenSurface { Receiver receiver; bool from_lit_side; float near; };

const float ROUNDING = 1e-4;   // of the distances of a map and of a plane, relative

SeenSurface seen_surface(Ray ray, Light light) {
    ivec2 pixel = ivec2(position_of(ivec2(gl_FragCoord.xy)));
    float t = texelFetch(normal_and_distance, pixel, 0).w - current_start;
    SeenSurface seen;
    seen.near = 3e38;
    if (t + current_start <= 0.0) return seen;
    vec3 point = ray.o + t * ray.d, normal = unpacked_direction(texelFetch(surface_material, pixel, 0).a);
    vec3 to_light = DIRECTIONAL == 1 ? -light.direction : normalize(light.position - point);
    float cosine = dot(normal, ray.d);
    seen.receiver = receiver_of(light, point, normal, map_position(light, point));
    seen.from_lit_side = cosine * dot(normal, to_light) < 0.0;
    // Over half a texel's diagonal the plane's distance changes by 0.71 slack |n x l| / |n . l|, and the ray is that far
    // from it where it has 0.71 slack |n x l| / |n . d| to go; twice as much leaves room for the bias.
    seen.near = t - 1.5 * seen.receiver.slack * length(cross(normal, to_light)) / max(abs(cosine), 1e-6);
    return seen;
}

// Whether the texel's sample lies on the seen surface.
bool sees(Light light, SeenSurface seen, ivec2 texel, int tile, float stored) {
    float here = plane_distance(light, seen.receiver, vec3(middle_of(texel), tile));
    return abs(stored - here) <= seen.receiver.bias + ROUNDING * seen.receiver.distance;
}
