// "Render Scene" of Weng 2010, Fig. 1.3: direct light of one light on diffuse and Phong surfaces, as it leaves them.
// Fog attenuates it on its way to the surface, which the print of Eq. 14 leaves out (LIGHT_LEG 0).
#include "camera_ray.glsl"
#include "light.glsl"
#include "light_leg.glsl"
#include "gbuffer.glsl"
#include "surface_shadow.glsl"

uniform Light light;
uniform sampler2D normal_and_distance;
uniform usampler2D surface_material;
uniform sampler2D surface_specular;
out vec4 result;

void main() {
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    vec4 surface = texelFetch(normal_and_distance, pixel, 0);
    uvec4 material = texelFetch(surface_material, pixel, 0);
    Ray ray = camera_ray(pixel);
    vec3 point = ray.o + surface.w * ray.d;
    float d = distance_from(light, point);
    vec3 l = DIRECTIONAL == 1 ? -light.direction : (light.position - point) / d;
    float cos_eye = dot(surface.xyz, -ray.d), cos_light = dot(surface.xyz, l);
    result = vec4(0.0);
    if (surface.w == 0.0) return;
    // Mitsuba's diffuse: black unless eye and light are on the front side; twosided: on the same side
    if (!(cos_eye * cos_light > 0.0) || (cos_eye < 0.0 && !is_two_sided(material))) return;
    cos_light = abs(cos_light);
    vec3 reflected = diffuse_reflectance(material) * 0.318309886183791;
#if SPECULAR == 1
    vec4 specular = texelFetch(surface_specular, pixel, 0);
    // Lafortune and Willems 1994: a lobe about the mirrored direction, normalised
    float cos_mirror = dot(reflect(ray.d, surface.xyz), l);
    if (cos_mirror > 0.0)
        reflected += specular.rgb * (specular.a + 2.0) * 0.159154943091895 * pow(cos_mirror, specular.a);
#endif
    float share = share_lit(light, point, unpacked_direction(material.a));
    if (share == 0.0) return;
    result.rgb = share * reflected * cos_light * light.intensity * angular(light, point) / (DIRECTIONAL == 1 ? 1.0 : d * d);
    if (LIGHT_LEG == 1) result.rgb *= transmittance(light_leg(light, point));
}
