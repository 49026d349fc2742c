// The contract between the three parts of a technique. A technique is
//     visibility strategy  x  airlight model  x  lattice
// and each part knows the others only through what stands here.
#include "counting.glsl"

// Begins on the near plane, as Mitsuba's rays do, or where it enters a bounded medium; t_max is the distance to the
// surface, to the far plane or to where it leaves the medium. All of it lies in fog.
struct Ray { vec3 o; vec3 d; float t_max; };

// A point or spot light has an intensity [W/sr], and half-angles [rad] that are pi for a point light. A directional light
// (DIRECTIONAL 1) has an irradiance in place of the intensity, travels along `direction`, and its position is any point
// before the scene.
struct Light { vec3 position; vec3 direction; vec3 intensity; float beam_width; float cutoff_angle; };

// The medium [1 / scene unit].
uniform vec3 sigma_s;
uniform vec3 sigma_t;

// A MODEL defines
//     const bool CLIP_TO_CONE      true: the driver cuts pieces at the edge of a spot's cone, inside which the model
//                                  takes the intensity as constant or smooth; false: it samples the intensity itself
//     vec3 airlight(Ray ray, Light light, float t0, float dt)
// the radiance that reaches the eye from the lit piece [t0, t0 + dt], the eye leg's transmittance included.
// dt is passed explicitly because float32 loses it in t1 - t0. WHOLE_LEG is 1 where the light is a point in the fog,
// so that all of its way to the piece is; otherwise the model asks light_leg() (light_leg.glsl), or takes no such scene.
vec3 airlight(Ray ray, Light light, float t0, float dt);
// A model that works on one extinction coefficient at a time, and gives the colour that all channels would have with it,
// runs once in grey fog, three times in coloured fog.
#define PER_CHANNEL(f, ray, light, t0, dt) \
    (GREY == 1 ? f(ray, light, t0, dt, sigma_t.x) : vec3(f(ray, light, t0, dt, sigma_t.x).x, \
     f(ray, light, t0, dt, sigma_t.y).y, f(ray, light, t0, dt, sigma_t.z).z))

// A STRATEGY defines
//     void visibility(Ray ray, Light light)
// and reports lit pieces, in any order, by calling lit(). w is any real number: 1 for a lit interval, a fraction for
// filtered visibility, +1 and -1 for shadow-volume faces that are added and subtracted. It asks in_shadow() of points
// (shadow_lookup.glsl), or whatever else its Supply brings (gpu_impl/visibilities/strategy.py). It is called once for each
// cell of the lattice; or, where it brings a vertex shader that draws slices or faces, once for each of their fragments,
// whose results are added up.
void visibility(Ray ray, Light light);
void lit(float t0, float dt, float w);

// A LATTICE defines
//     vec2 position_of(ivec2 cell)
// where in the image the ray of a cell goes [pixel], the first pixel's centre being (0.5, 0.5); outside the image for a
// cell without a ray. What it evaluates comes to all pixels by an upsampling, or by its own
//     vec4 upsampled(ivec2 pixel)
