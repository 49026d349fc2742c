// The ray of this invocation's cell, which the driver sets before anything is asked.
#include "contract.glsl"

Ray current_ray;
float current_start;   // how far behind the beginning of the camera's ray it begins, where fog does
