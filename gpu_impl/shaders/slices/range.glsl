// Between which depths along the viewing axis slices lie: bits of floats, which are ordered as the floats are.
layout(std430, binding = 4) restrict buffer Range { uint first_depth, last_depth; };
