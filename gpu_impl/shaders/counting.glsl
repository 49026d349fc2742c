// What a technique does for a ray. A counting build defines COUNTING; in any other the macros are empty, so that a count
// costs nothing where nobody asks. Each macro stands as a statement where the work is done.
#ifdef COUNTING
layout(location = 1) out vec4 counts;   // pieces, shadow-map reads, exponential integrals, exponentials
#define START_COUNTING counts = vec4(0.0)
#define COUNT_PIECE counts.x += 1.0
#define COUNT_READ counts.y += 1.0
#define COUNT_EI counts.z += 1.0
// A vector's exponentials are as many as it has components; sines, cosines and arc tangents are not counted. The builtin
// itself stays in the expression: called from a function of ours, compilers round what is around it differently. It is
// written twice, so nothing that counts may stand in its argument.
float components(float x) { return 1.0; }
float components(vec2 x) { return 2.0; }
float components(vec3 x) { return 3.0; }
#define exp(x) (counts.w += components(x), exp(x))
#else
#define START_COUNTING
#define COUNT_PIECE
#define COUNT_READ
#define COUNT_EI
#endif
