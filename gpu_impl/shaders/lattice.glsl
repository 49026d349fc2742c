// The lattice grid/N, see lattice.py.
uniform int downsample;       // N
uniform ivec2 first_pixel;    // of the image that is evaluated

// The pixel of the image that one of the lattice stands for.
ivec2 pixel_of(ivec2 lattice) { return lattice * downsample + first_pixel; }
