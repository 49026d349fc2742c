// Pieces as a technique hands them to its airlight model. A recording build defines RECORDING, and each piece that
// lit() is called with stands in a buffer then, in any order; in any other build the macro is empty.
#ifdef RECORDING
layout(std430, binding = 0) buffer RecordedCount { uint recorded_count; };
// cell's number in the lattice, row by row; bits of t0, dt and w
layout(std430, binding = 1) writeonly buffer RecordedPieces { uvec4 recorded_pieces[]; };
uniform int recorded_row;   // cells in a row

void record(float t0, float dt, float w) {
    uint place = atomicAdd(recorded_count, 1u);
    if (place >= uint(recorded_pieces.length())) return;
    uint cell = uint(gl_FragCoord.y) * uint(recorded_row) + uint(gl_FragCoord.x);
    recorded_pieces[place] = uvec4(cell, floatBitsToUint(vec3(t0, dt, w)));
}
#define RECORD_PIECE(t0, dt, w) record(t0, dt, w)
#else
#define RECORD_PIECE(t0, dt, w)
#endif
