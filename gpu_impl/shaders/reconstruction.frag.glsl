// Brings the airlight of one light from its lattice to every pixel of the image.
#include "<reconstruction>"

out vec4 airlight_and_pieces;

void main() { airlight_and_pieces = upsampled(ivec2(gl_FragCoord.xy)); }
