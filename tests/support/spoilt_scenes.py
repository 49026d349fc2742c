"""A good scene, and the many ways to spoil it: what is replaced, by what, and words that the refusal has to hold."""

from __future__ import annotations

PHASE = '<phase type="hg"><float name="g" value="0.5"/></phase>'
LOOK = '<lookat origin="0, 0, 5" target="0, 0, 0" up="0, 1, 0"/>'
SPOT_LOOK = '<lookat origin="0, 2, 0" target="0, 0, 0" up="0, 0, 1"/>'
FOV = '<float name="fov" value="45"/>'
WIDTH = '<integer name="width" value="16"/>'
FILM = f'<film type="hdrfilm">{WIDTH}<integer name="height" value="8"/></film>'
INTENSITY = '<float name="intensity" value="3"/>'
RADIUS = '<float name="radius" value="0.5"/>'
COLOUR = '<rgb name="reflectance" value="0.2, 0.3, 0.4"/>'
PAINT = f'<bsdf type="diffuse" id="paint">{COLOUR}</bsdf>'
BALL = '<shape type="sphere" id="ball">'
SPOT = '<emitter type="spot">'
SIGMA_T = '<float name="sigma_t" value="$sigma_t"/>'
GOOD = f"""<scene version="3.0.0">
  <default name="sigma_t" value="0.1"/>
  <medium type="homogeneous" id="fog">
    {SIGMA_T}
    <rgb name="albedo" value="0.9, 0.8, 0.7"/>
    {PHASE}
  </medium>
  <sensor type="perspective">
    {FOV}
    <transform name="to_world">{LOOK}</transform>
    {FILM}
    <ref id="fog"/>
  </sensor>
  {SPOT}
    {INTENSITY}
    <float name="cutoff_angle" value="30"/>
    <transform name="to_world">{SPOT_LOOK}</transform>
  </emitter>
  {BALL}
    {RADIUS}
    {PAINT}
  </shape>
</scene>"""


def moved(steps: str) -> str:
    return f'<transform name="to_world">{steps}</transform>'


def mesh(plugin: str, properties: str) -> str:
    return f'<shape type="{plugin}">{properties}</shape>{BALL}'


# what is replaced in the good scene, by what, and what the sentence has to say
CASES: dict[str, tuple[str, str, str]] = {
    # plugins outside the subset, known to Mitsuba or to nobody
    "thin lens": (
        'type="perspective"',
        'type="thinlens"',
        "line 8, col 4): sensor plugin 'thinlens' is not supported; use perspective",
    ),
    "unknown sensor": ('type="perspective"', 'type="pinhole"', "use perspective"),
    "heterogeneous medium": ('type="homogeneous"', 'type="heterogeneous"', "use homogeneous"),
    "unknown medium": ('type="homogeneous"', 'type="fog"', "use homogeneous"),
    "microflakes": (PHASE, '<phase type="sggx"/>', "use isotropic, rayleigh, hg, schlick, cornette_shanks or tabphase"),
    "unknown phase": (
        PHASE,
        '<phase type="mie"/>',
        "use isotropic, rayleigh, hg, schlick, cornette_shanks or tabphase",
    ),
    "sun": (SPOT, f'<emitter type="directional"/>{SPOT}', "'directional' needs a bounded medium"),
    "sky": (SPOT, f'<emitter type="envmap"/>{SPOT}', "use point or spot"),
    "unknown light": (SPOT, f'<emitter type="lamp"/>{SPOT}', "use point or spot"),
    "area light in a shape": (
        BALL,
        f'{BALL}<emitter type="area"/>',
        "'area' inside 'sphere' is outside what airlight supports",
    ),
    "unknown shape": (BALL, f'<shape type="teapot"/>{BALL}', "use one of ply, obj, sphere"),
    "shape without a type": (BALL, f'<shape type=""/>{BALL}', "use one of ply, obj, sphere"),
    "instances": (BALL, f'<shape type="instance"/>{BALL}', "should hold a <ref> to one shapegroup"),
    "metal": (PAINT, '<bsdf type="conductor"/>', "use diffuse, phong or twosided"),
    "unknown surface": (PAINT, '<bsdf type="velvet"/>', "use diffuse, phong or twosided"),
    "spectral film": ('type="hdrfilm"', 'type="specfilm"', "use hdrfilm"),
    "unknown film": ('type="hdrfilm"', 'type="ldrfilm"', "use hdrfilm"),
    # properties that nothing reads
    "misspelt in a light": ('"cutoff_angle"', '"cuttoff_angle"', "'cuttoff_angle' that airlight does not know"),
    "misspelt in the camera": (FOV, FOV + '<float name="fra_clip" value="3"/>', "'fra_clip'"),
    "misspelt in the medium": ('"albedo"', '"albeddo"', "'albeddo'"),
    "misspelt in the phase": ('name="g"', 'name="G"', "'G'"),
    "misspelt in a shape": ('name="radius"', 'name="raduis"', "'raduis'"),
    "misspelt in a surface": ('"reflectance"', '"reflectanse"', "'reflectanse'"),
    "misspelt in the film": ('name="width"', 'name="widht"', "'widht'"),
    "crop of the film": (WIDTH, WIDTH + '<integer name="crop_width" value="4"/>', "'crop_width'"),
    "off-centre camera": (
        FOV,
        FOV + '<float name="principal_point_offset_x" value="0.1"/>',
        "'principal_point_offset_x'",
    ),
    "property of the scene": (SPOT, f'<float name="exposure" value="1"/>{SPOT}', "'exposure'"),
    "texture in a spot": (
        INTENSITY,
        INTENSITY + '<texture type="checkerboard" name="texture"/>',
        "'checkerboard' is not supported as a texture; use bitmap",
    ),
    "light in the medium": (PHASE, PHASE + '<emitter type="point"/>', "'point' inside 'homogeneous'"),
    "shape in a shape": (RADIUS, '<shape type="cube"/>', "'cube' inside 'sphere'"),
    "fog in an opaque shape": (RADIUS, '<ref id="fog" name="interior"/>', "'homogeneous' inside 'sphere' is outside"),
    "other fog around a shape": (
        RADIUS,
        '<medium type="homogeneous" name="exterior"/>',
        "takes only the fog that fills space",
    ),
    "camera in a shape": (RADIUS, '<sensor type="perspective"/>', "'perspective' inside 'sphere' is outside"),
    # what is missing or there twice
    "camera outside the fog": ('<ref id="fog"/>', "", "is not inside a medium"),
    "no medium": ('<ref id="fog"/>\n  </sensor>', "</sensor>", "<ref id='...'/> of a medium"),
    "no film": (FILM, "", "add <film type='hdrfilm'/>"),
    "no camera": (GOOD, '<scene version="3.0.0"><emitter type="point"/></scene>', "has no sensor"),
    "two cameras": (
        SPOT,
        f'<sensor type="perspective">{FOV}<ref id="fog"/></sensor>{SPOT}',
        "has 2 sensors: it should have exactly one",
    ),
    "two films": (FILM, FILM + '<film type="hdrfilm"/>', "is a second film"),
    "two media": ('<ref id="fog"/>', '<ref id="fog"/><medium type="homogeneous"/>', "is a second medium"),
    "two phases": (PHASE, PHASE + '<phase type="isotropic"/>', "is a second phasefunction"),
    "two surfaces": (PAINT, PAINT + '<bsdf type="diffuse"/>', "is a second bsdf"),
    "empty twosided": (PAINT, '<bsdf type="twosided"/>', "should hold one diffuse or phong BSDF"),
    "twosided in twosided": (
        PAINT,
        f'<bsdf type="twosided"><bsdf type="twosided">{PAINT}</bsdf></bsdf>',
        "should hold one diffuse or phong BSDF",
    ),
    "the same id twice": ('id="paint"', 'id="ball"', 'duplicate ID: "ball"'),
    # numbers
    "no intensity": (INTENSITY, '<float name="intensity" value="0"/>', "has no intensity"),
    "negative intensity": (INTENSITY, '<rgb name="intensity" value="1, -1, 1"/>', "should be finite and not negative"),
    "NaN intensity": (INTENSITY, '<float name="intensity" value="nan"/>', "should be finite and not negative"),
    "infinite intensity": (INTENSITY, '<float name="intensity" value="inf"/>', "should be finite and not negative"),
    "coloured light by wavelength": (
        INTENSITY,
        '<spectrum name="intensity" value="400:0.1, 700:0.2"/>',
        "should be an <rgb> or a <float>",
    ),
    "light of even spectrum": (INTENSITY, '<spectrum name="intensity" value="3"/>', "should be an <rgb> or a <float>"),
    "g = 1": ('name="g" value="0.5"', 'name="g" value="1"', "strictly between -1 and 1"),
    "g = -1": ('name="g" value="0.5"', 'name="g" value="-1"', "strictly between -1 and 1"),
    "g = nan": ('name="g" value="0.5"', 'name="g" value="nan"', "should be a finite number"),
    "negative sigma_t": (
        'name="sigma_t" value="0.1"',
        'name="sigma_t" value="-0.1"',
        "should be finite and not negative",
    ),
    "sigma_t beyond float32": ('name="sigma_t" value="0.1"', 'name="sigma_t" value="1e39"', "should be finite"),
    "negative scale of the medium": (
        SIGMA_T,
        SIGMA_T + '<float name="scale" value="-1"/>',
        "must be finite and not negative",
    ),
    "albedo above 1": ("0.9, 0.8, 0.7", "0.9, 1.2, 0.7", "albedo must lie between 0 and 1"),
    "albedo of four": ("0.9, 0.8, 0.7", "0.9, 0.8, 0.7, 1", "could not parse RGB value"),
    "field of view 0": (FOV, '<float name="fov" value="0"/>', "between 0 and 180"),
    "field of view 180": (FOV, '<float name="fov" value="180"/>', "between 0 and 180"),
    "field of view once around": (FOV, '<float name="fov" value="400"/>', "between 0 and 180"),
    "field of view nan": (FOV, '<float name="fov" value="nan"/>', "should be a finite number"),
    "axis of the field of view": (
        FOV,
        FOV + '<string name="fov_axis" value="z"/>',
        "use x, y, diagonal, smaller or larger",
    ),
    "near plane behind the far one": (FOV, FOV + '<float name="near_clip" value="1e5"/>', "0 < near_clip < far_clip"),
    "near plane at the eye": (FOV, FOV + '<float name="near_clip" value="0"/>', "0 < near_clip < far_clip"),
    "far plane at infinity": (FOV, FOV + '<float name="far_clip" value="inf"/>', "should be a finite number"),
    "spot of 90 degrees": ('"cutoff_angle" value="30"', '"cutoff_angle" value="90"', "use 0 <= beam <= cutoff < 90"),
    "spot of 0 degrees": ('"cutoff_angle" value="30"', '"cutoff_angle" value="0"', "use 0 <= beam <= cutoff < 90"),
    "beam wider than the spot": (
        INTENSITY,
        INTENSITY + '<float name="beam_width" value="40"/>',
        "use 0 <= beam <= cutoff < 90",
    ),
    "radius 0": (RADIUS, '<float name="radius" value="0"/>', "should be positive"),
    "negative radius": (RADIUS, '<float name="radius" value="-1"/>', "should be positive"),
    "radius that float32 cannot square": (RADIUS, '<float name="radius" value="1e30"/>', "should be positive (1e-15"),
    "sigma_t as a colour above 1": (SIGMA_T, '<rgb name="sigma_t" value="1, 2, 1"/>', "use a 'scale' too"),
    "radius nan": (RADIUS, '<float name="radius" value="nan"/>', "should be a finite number"),
    "tube of no radius": (BALL, mesh("cylinder", '<float name="radius" value="0"/>'), "should be positive"),
    "tube of no length": (BALL, mesh("cylinder", '<point name="p1" x="0" y="0" z="0"/>'), "two different ends"),
    "centre nan": (RADIUS, '<point name="center" x="nan" y="0" z="0"/>', "should be a finite point"),
    "reflectance above 1": ("0.2, 0.3, 0.4", "0.2, 0.3, 1.4", "should be at most 1"),
    "negative reflectance": ("0.2, 0.3, 0.4", "0.2, 0.3, -0.4", "should be finite and not negative"),
    "image without pixels": (WIDTH, '<integer name="width" value="0"/>', "0 x 8 pixels cannot be made: use 1 to 16384"),
    "image of negative size": (WIDTH, '<integer name="width" value="-4"/>', "use 1 to 16384"),
    "image beyond 32 bits": (WIDTH, '<integer name="width" value="1000000000000"/>', "use 1 to 16384"),
    "image beyond 64 bits": (
        WIDTH,
        '<integer name="width" value="100000000000000000000000"/>',
        "could not parse integer",
    ),
    "half a pixel": (WIDTH, '<float name="width" value="16.5"/>', "should be an <integer>"),
    # transforms
    "NaN in a transform": (RADIUS, moved('<translate x="nan"/>'), "not finite or cannot be inverted"),
    "transform beyond float32": (RADIUS, moved('<scale value="1e39"/>'), "not finite or cannot be inverted"),
    "scale 0": (RADIUS, moved('<scale value="0"/>'), "not finite or cannot be inverted"),
    "flattened": (RADIUS, moved('<scale x="1" y="0" z="1"/>'), "not finite or cannot be inverted"),
    "too large for float32": (
        RADIUS,
        RADIUS.replace("0.5", "1e14") + moved('<scale value="1e25"/>'),
        "beyond what float32 holds",
    ),
    "matrix of four": (RADIUS, moved('<matrix value="1 0 0 0"/>'), "matrix must have 9 or 16 values"),
    "rotation about nothing": (RADIUS, moved('<rotate angle="30"/>'), "rotation axis cannot be zero"),
    "rotation about a long axis": (
        RADIUS,
        moved('<rotate x="1" y="1" angle="30"/>'),
        "not of unit length; normalise it",
    ),
    "look at oneself": (LOOK, '<lookat origin="0, 0, 5" target="0, 0, 5" up="0, 1, 0"/>', "invalid lookat"),
    "scaled camera": (LOOK, '<scale value="2"/>', "use <lookat>, rotations and translations"),
    "sheared camera": (LOOK, '<matrix value="1 0.2 0 0 1 0 0 0 1"/>', "use <lookat>, rotations and translations"),
    "stretched spot": (SPOT_LOOK, f'<scale x="3"/>{SPOT_LOOK}', "scales unevenly or shears"),
    "stretched sphere": (RADIUS, moved('<scale x="3"/>'), "scales unevenly or shears"),
    "sheared tube": (
        BALL,
        mesh("cylinder", moved('<matrix value="1 0.2 0 0 1 0 0 0 1"/>')),
        "scales unevenly or shears",
    ),
    "a point in two places": (
        SPOT,
        '<emitter type="point"><point name="position" x="1" y="0" z="0"/>'
        + moved("<translate/>")
        + "</emitter>"
        + SPOT,
        "both a 'position' and a 'to_world'",
    ),
    # types
    "number as a word": (RADIUS, '<float name="radius" value="big"/>', "could not parse floating point value"),
    "number as a string": (RADIUS, '<string name="radius" value="0.5"/>', "should be a finite number"),
    "number as a truth value": (RADIUS, '<boolean name="radius" value="true"/>', "should be a finite number"),
    "number as a point": (RADIUS, '<point name="radius" x="1" y="1" z="1"/>', "should be a finite number"),
    "point as a number": (RADIUS, '<float name="center" value="1"/>', "should be a <point>"),
    "point as a string": (RADIUS, '<string name="center" value="1, 2, 3"/>', "should be a <point>"),
    "point as a colour": (RADIUS, '<rgb name="center" value="0.1, 0.2, 0.3"/>', "should be a <point>"),
    "transform as a string": (RADIUS, '<string name="to_world" value="identity"/>', "should be a <transform>"),
    "transform as a number": (RADIUS, '<float name="to_world" value="1"/>', "should be a <transform>"),
    "truth value as a string": (RADIUS, '<string name="flip_normals" value="false"/>', "should be a <boolean>"),
    "truth value as a number": (RADIUS, '<float name="flip_normals" value="1"/>', "should be a <boolean>"),
    "truth value of neither kind": (
        RADIUS,
        '<boolean name="flip_normals" value="perhaps"/>',
        "could not parse boolean",
    ),
    "colour as a string": (COLOUR, '<string name="reflectance" value="0.5"/>', "should be an <rgb> or a <float>"),
    "colour as a truth value": (
        COLOUR,
        '<boolean name="reflectance" value="true"/>',
        "should be an <rgb> or a <float>",
    ),
    "colour as a vector": (COLOUR, '<vector name="reflectance" x="1" y="0" z="0"/>', "should be an <rgb> or a <float>"),
    "colour by name": ("0.2, 0.3, 0.4", "red", "could not parse RGB value"),
    "colour by wavelength": (
        COLOUR,
        '<spectrum name="reflectance" value="400:0.1, 700:0.2"/>',
        "should be an <rgb> or a <float>",
    ),
    "colour from a file that is not there": (
        COLOUR,
        '<spectrum name="reflectance" filename="none.spd"/>',
        "file does not exist",
    ),
    "texture as reflectance": (COLOUR, '<texture type="checkerboard" name="reflectance"/>', "use bitmap or an <rgb>"),
    "picture as reflectance": (
        COLOUR,
        '<texture type="bitmap" name="reflectance"><string name="filename" value="x.png"/></texture>',
        "x.png, and there is no such file",
    ),
    "volume as sigma_t": (SIGMA_T, '<volume type="constvolume" name="sigma_t"/>', "only an <rgb> or a <float>"),
    "size as a string": (WIDTH, '<string name="width" value="16"/>', "should be an <integer>"),
    # references and includes
    "reference to the wrong kind": (PAINT, '<ref id="fog"/>', "'homogeneous' inside 'sphere' is outside"),
    "reference to nothing": (PAINT, '<ref id="nope"/>', 'unresolved reference to "nope"'),
    "reference to oneself": (PAINT, '<ref id="ball"/>', "circular reference"),
    "references in a circle": (
        PAINT,
        '<bsdf type="twosided" id="a"><bsdf type="twosided" id="b"><ref id="a"/></bsdf></bsdf>',
        "circular reference",
    ),
    "include of nothing": (SPOT, f'<include filename="none.xml"/>{SPOT}', '"none.xml" not found'),
    "include of itself": (SPOT, f'<include filename="bad.xml"/>{SPOT}', "include recursion depth"),
    "include of a folder": (SPOT, f'<include filename="/"/>{SPOT}', "failed"),
    "parameter without a default": ("$sigma_t", "$sigma", "undefined parameter: $sigma"),
    # meshes
    "mesh that is nowhere": (
        BALL,
        mesh("ply", '<string name="filename" value="no_such.ply"/>'),
        "line 19, col 4): The mesh 'no_such.ply' is in none of",
    ),
    "mesh without a name": (BALL, mesh("ply", ""), "needs the property 'filename'"),
    "mesh with an empty name": (BALL, mesh("ply", '<string name="filename" value=""/>'), "should be a <string>"),
    "mesh called 3": (BALL, mesh("ply", '<float name="filename" value="3"/>'), "should be a <string>"),
    "folder as a mesh": (BALL, mesh("ply", '<string name="filename" value="/folder.ply"/>'), "there is no such file"),
    "PLY read as OBJ": (BALL, mesh("obj", '<string name="filename" value="torus.ply"/>'), "reads .obj files"),
    "flatness as a number": (
        BALL,
        mesh("ply", '<string name="filename" value="torus.ply"/><float name="face_normals" value="1"/>'),
        "should be a <boolean>",
    ),
    "mesh with NaN": (BALL, mesh("ply", '<string name="filename" value="nan.ply"/>'), "vertex 1 is NaN"),
    "mesh with no faces": (BALL, mesh("ply", '<string name="filename" value="cloud.ply"/>'), "has no faces"),
    "mesh of random bytes": (BALL, mesh("ply", '<string name="filename" value="noise.ply"/>'), "not a PLY file"),
    # XML
    "empty file": (GOOD, "", "No document element"),
    "blank file": (GOOD, "\n\n", "No document element"),
    "not XML": (GOOD, "hello world", "No document element"),
    "cut short": ("</scene>", "", "Start-end tags mismatch"),
    "another root": (GOOD, '<html version="3.0.0"/>', "html"),
    "no version": (' version="3.0.0"', "", "missing version attribute"),
    "odd version": ("3.0.0", "new", "invalid version number"),
    "only a medium": (GOOD, '<medium version="3.0.0" type="homogeneous"/>', "has no sensor"),
    "empty scene": (GOOD, '<scene version="3.0.0"/>', "has no sensor"),
    "unknown element": (BALL, f"<sphere/>{BALL}", "unsupported XML element: <sphere>"),
    "element without a type": (BALL, f"<shape/>{BALL}", 'missing required attribute "type"'),
    "property without a name": (RADIUS, '<float value="0.5"/>', 'missing required attribute "name"'),
    "property without a value": (RADIUS, '<float name="radius"/>', 'missing required attribute "value"'),
    "property with a unit": (RADIUS, '<float name="radius" value="0.5" unit="m"/>', 'unexpected attribute "unit"'),
}
