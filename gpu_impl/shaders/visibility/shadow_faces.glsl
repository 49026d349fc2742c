// James 2003, "True volumetric shadows": airlight of the whole ray, once for all of the picture, less that behind each face
// by which the ray enters a shadow volume, more that behind each by which it leaves one. Nothing is sorted, and nothing
// knows of the others: where volumes overlap, light is taken away as often as there are volumes.
#include "camera_ray.glsl"
#include "light.glsl"

flat in vec4 face_plane;
flat in float face_volumes;

void visibility(Ray ray, Light light) {
    // inside the cone of a spot: not every model asks the driver for that
    vec2 range = cone_interval(ray, light);
    float begin = range.x, w = face_volumes;
    if (face_plane.xyz != vec3(0.0)) {
        float from_eye = face_plane.w / dot(face_plane.xyz, ray.d);
        // What is drawn lies before the eye. Where rounding has it behind, the ray all but runs along the face, which it
        // meets beyond everything.
        if (!(from_eye > 0.0)) return;
        // a face between the eye and where the ray begins counts from there on
        begin = max(begin, from_eye - dot(ray.o - camera_to_world[3].xyz, ray.d));
        // The rasteriser knows a face's front by its corners as it has rounded them, so that of a volume's faces as many
        // are entered as are left, whatever happens at its edges.
        if (gl_FrontFacing) w = -w;
    }
    if (begin < range.y) lit(begin, range.y - begin, w);
}
