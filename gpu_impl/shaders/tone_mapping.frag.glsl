// From linear Rec.709 to what a display takes, for looking at only.
uniform sampler2D composite;   // linear Rec.709
uniform float exposure;        // factor on every radiance
out vec4 display;

const vec3 LUMINANCE = vec3(0.2126, 0.7152, 0.0722);   // Rec. ITU-R BT.709
const float WHITE = 4.0;                               // exposed luminance from which on a pixel is white: two stops above 1

// IEC 61966-2-1
vec3 srgb_encoded(vec3 linear) {
    return mix(12.92 * linear, 1.055 * pow(linear, vec3(1.0 / 2.4)) - 0.055, greaterThan(linear, vec3(0.0031308)));
}

void main() {
    vec3 exposed = exposure * max(texelFetch(composite, ivec2(gl_FragCoord.xy), 0).rgb, 0.0);
    // Reinhard et al. 2002, Eq. 4: the luminance L (1 + L / L_white^2) / (1 + L); the colour keeps its proportions
    float luminance = dot(exposed, LUMINANCE);
    vec3 mapped = exposed * (1.0 + luminance / (WHITE * WHITE)) / (1.0 + luminance);
    display = vec4(srgb_encoded(min(mapped, 1.0)), 1.0);
}
