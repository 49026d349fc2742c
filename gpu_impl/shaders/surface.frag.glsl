// "Render Scene" of Weng 2010, Fig. 1.3: direct light of one light on diffuse surfaces, attenuated on both legs.
#include "camera_ray.glsl"
#include "light.glsl"
#include "shadow_lookup.glsl"

uniform Light light;
uniform sampler2D normal_and_distance;
uniform sampler2D surface_material;
uniform sampler2D triangle_normal;
uniform float texel_slope;   // width of a shadow-map texel at distance 1
out vec4 result;

void main() {
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    vec4 surface = texelFetch(normal_and_distance, pixel, 0), material = texelFetch(surface_material, pixel, 0);
    Ray ray = camera_ray(pixel);
    vec3 point = ray.o + surface.w * ray.d, to_light = light.position - point;
    float d = length(to_light);
    float cos_eye = dot(surface.xyz, -ray.d), cos_light = dot(surface.xyz, to_light) / d;
    result = vec4(0.0);
    if (surface.w == 0.0) return;
    // Mitsuba's diffuse: black unless eye and light are on the front side; twosided: on the same side
    if (!(cos_eye * cos_light > 0.0) || (material.a == 0.0 && cos_eye < 0.0)) return;
    cos_light = abs(cos_light);
    // A texel holds the distance at its centre; across it a slanted triangle varies by this much.
    vec3 flat_normal = texelFetch(triangle_normal, pixel, 0).xyz;
    float slope = length(cross(flat_normal, to_light)) / max(abs(dot(flat_normal, to_light)), 1e-30);
    float bias = texel_slope * d * min(slope, 20.0) + 1e-4 * d;
    if (d - bias > nearest_surface(light, point)) return;
    result.rgb = material.rgb * 0.318309886183791 * cos_light * light.intensity * falloff(light, point) / (d * d)
               * exp(-sigma_t * (surface.w + d));
}
