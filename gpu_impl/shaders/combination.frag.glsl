// The "Bilateral filter" of Weng 2010, Fig. 1.3: brings the airlight to full resolution and adds it to the surface's
// light, attenuated on its way to the eye (Eq. 14: L_b e^{-tau} + L_m).
#include "fog.glsl"
#include "<upsampling>"

uniform sampler2D surface;   // L_b, as it leaves the surface
#if SPLIT == 1
layout(location = 0) out vec4 attenuated_surface;
layout(location = 1) out vec4 airlight_and_pieces;
#else
out vec4 composite;
#endif

void main() {
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    vec4 airlight = DOWNSAMPLED == 1 ? upsampled(pixel) : texelFetch(scattering, pixel, 0);
    float d = texelFetch(normal_and_distance, pixel, 0).w;
    Ray ray = camera_ray(pixel);
    vec2 leg = fog_interval(ray.o, ray.d, vec2(0.0, d));
    vec4 reflected = texelFetch(surface, pixel, 0) * vec4(transmittance(leg.y - leg.x), 1.0);
#if SPLIT == 1
    attenuated_surface = reflected;
    airlight_and_pieces = airlight;
#else
    composite = vec4(reflected.rgb + airlight.rgb, 1.0);
#endif
}
