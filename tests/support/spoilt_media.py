"""More ways to spoil the good scene: bounded media, directional lights, pictures, Phong, instances, phase functions."""

from __future__ import annotations

from spoilt_scenes import BALL, COLOUR, FOV, INTENSITY, PAINT, PHASE, RADIUS, SPOT, mesh, moved

FOG = '<ref id="fog"/>\n  </sensor>'
NULL = '<bsdf type="null"/><ref id="fog" name="interior"/>'
AROUND_ALL = moved('<scale value="20"/>') + NULL

FLUSH, DOUBLED = moved('<scale value="50"/><translate z="-1"/>'), moved('<scale value="2"/>')


def held(plugin: str, properties: str) -> str:
    """A shape before the ball that holds the fog."""
    return f'<shape type="{plugin}">{properties}</shape>{BALL}'


def picture(settings: str = "", name: str = "reflectance") -> str:
    return f'<texture type="bitmap" name="{name}"><string name="filename" value="picture.exr"/>{settings}</texture>'


MORE_CASES: dict[str, tuple[str, str, str]] = {
    # what holds a medium
    "null without a medium": (BALL, held("cube", '<bsdf type="null"/>'), "has a null BSDF and holds no medium"),
    "null on a surface": (PAINT, '<bsdf type="twosided"><bsdf type="null"/></bsdf>', "bounds a medium"),
    "two bodies of fog": (
        BALL,
        held("cube", AROUND_ALL)[: -len(BALL)] + held("cube", AROUND_ALL),
        "is a second shape with a null BSDF",
    ),
    "an open body": (BALL, held("cylinder", moved('<scale value="20"/>') + NULL), "it is not closed"),
    "a flat body": (BALL, held("rectangle", AROUND_ALL), "it is not closed"),
    "a body turned inside out": (
        BALL,
        held("cube", AROUND_ALL + '<boolean name="flip_normals" value="true"/>'),
        "look inward",
    ),
    "a ball turned inside out": (
        BALL,
        held("sphere", AROUND_ALL + '<boolean name="flip_normals" value="true"/>'),
        "looks inward",
    ),
    "a body that is not convex": (
        BALL,
        held("obj", '<string name="filename" value="dented.obj"/>' + AROUND_ALL),
        "it is not convex",
    ),
    "a body of many faces": (
        BALL,
        held("ply", '<string name="filename" value="torus.ply"/>' + AROUND_ALL),
        "and at most 64 are taken",
    ),
    "a body of another kind": (BALL, held("bsplinecurve", NULL), "cannot hold a medium; use one of ply"),
    "a camera that says it is in the fog and is not": (
        BALL,
        held("cube", NULL),
        "has a medium, and is outside the shape that holds it",
    ),
    "a camera in the fog that does not say so": (
        FOG,
        f"</sensor>{held('cube', AROUND_ALL)[: -len(BALL)]}",
        "is inside the shape that holds the medium",
    ),
    "a near plane that reaches into the body": (
        FOG,
        f'<float name="near_clip" value="4.5"/></sensor>{held("cube", NULL)[: -len(BALL)]}',
        "near plane that cuts the shape",
    ),
    "a far plane that cuts the body": (
        FOG,
        f'<float name="far_clip" value="5"/></sensor>{held("cube", NULL)[: -len(BALL)]}',
        "far plane that cuts the shape that holds the medium: use a far_clip above 6",
    ),
    "a floor in the body's face": (
        FOG,
        f'</sensor><shape type="rectangle">{FLUSH}</shape>{held("cube", NULL)[: -len(BALL)]}',
        "lies in a face of the shape that holds the medium",
    ),
    "a body with fog around it": (
        BALL,
        held("cube", AROUND_ALL + '<ref id="fog" name="exterior"/>'),
        "airlight takes none around a bounded one",
    ),
    "a surface that says it is in bounded fog": (
        RADIUS,
        f'{RADIUS}<ref id="fog" name="exterior"/></shape><shape type="cube">{AROUND_ALL}</shape><shape type="cube">',
        "a surface inside a bounded medium needs none",
    ),
    # lights
    "sun without a direction": (
        SPOT,
        f'<emitter type="directional"><vector name="direction" x="0" y="0" z="0"/></emitter>'
        f'<shape type="cube">{AROUND_ALL}</shape>{SPOT}',
        "has a 'direction' without length",
    ),
    "sun in two directions": (
        SPOT,
        '<emitter type="directional"><vector name="direction" x="0" y="1" z="0"/>'
        f'{moved("<translate/>")}</emitter><shape type="cube">{AROUND_ALL}</shape>{SPOT}',
        "has both a 'direction' and a 'to_world'",
    ),
    "sun without irradiance": (
        SPOT,
        f'<emitter type="directional"><float name="irradiance" value="0"/></emitter><shape type="cube">{AROUND_ALL}'
        f"</shape>{SPOT}",
        "has no irradiance",
    ),
    "slide that is not there": (
        INTENSITY,
        INTENSITY + picture(name="texture").replace("picture", "none"),
        "none.exr, and there is no such file",
    ),
    # pictures
    "picture that is no picture": (COLOUR, picture().replace("picture.exr", "noise.ply"), "cannot use its picture"),
    "picture of NaN": (COLOUR, picture().replace("picture", "nan"), "negative or not finite"),
    "picture brighter than white": (COLOUR, picture().replace("picture", "bright"), "should be at most 1"),
    "picture on a mesh without coordinates": (
        BALL,
        mesh("ply", f'<string name="filename" value="good.ply"/><bsdf type="diffuse">{picture()}</bsdf>'),
        "no texture coordinates",
    ),
    "picture wrapped oddly": (
        COLOUR,
        picture('<string name="wrap_mode" value="black"/>'),
        "use repeat, mirror, clamp",
    ),
    "picture filtered oddly": (
        COLOUR,
        picture('<string name="filter_type" value="cubic"/>'),
        "use bilinear, nearest",
    ),
    "misspelt in a picture": (COLOUR, picture('<boolean name="row" value="true"/>'), "'row' that airlight does not"),
    # Phong
    "Phong that shines too much": (
        PAINT,
        '<bsdf type="phong"><float name="diffuse_reflectance" value="0.9"/></bsdf>',
        "diffuse and specular together, of [1.1, 1.1, 1.1]",
    ),
    "Phong of a negative exponent": (
        PAINT,
        '<bsdf type="phong"><float name="exponent" value="-1"/></bsdf>',
        "between 0 and 10000",
    ),
    "misspelt in Phong": (PAINT, '<bsdf type="phong"><float name="shininess" value="9"/></bsdf>', "'shininess'"),
    # phase functions
    "k = 1": (PHASE, '<phase type="schlick"><float name="k" value="1"/></phase>', "k must lie strictly between"),
    "Cornette-Shanks of g = -1": (
        PHASE,
        '<phase type="cornette_shanks"><float name="g" value="-1"/></phase>',
        "strictly between",
    ),
    "table of one": (PHASE, '<phase type="tabphase"><string name="values" value="1"/></phase>', "two numbers or more"),
    "table of words": (PHASE, '<phase type="tabphase"><string name="values" value="a, b"/></phase>', "not numbers"),
    "table of nothing": (PHASE, '<phase type="tabphase"><string name="values" value="0, 0"/></phase>', "all be zero"),
    "table that is not there": (PHASE, '<phase type="tabphase"/>', "needs the property 'values'"),
    # instances
    "instance of a sphere": (
        BALL,
        f'<shape type="instance"><shape type="sphere"/></shape>{BALL}',
        "should hold a <ref> to one shapegroup",
    ),
    "empty group": (BALL, f'<shape type="shapegroup" id="g"/>{BALL}', "holds no shape"),
    "group inside its instance": (
        BALL,
        f'<shape type="instance"><shape type="shapegroup"><shape type="cube"/></shape></shape>{BALL}',
        "stands inside an instance",
    ),
    "sun of another scale": (
        SPOT,
        f'<emitter type="directional">{DOUBLED}</emitter><shape type="cube">{AROUND_ALL}</shape>{SPOT}',
        "use <lookat> or a 'direction'",
    ),
    "axis of the field of view as a colour": (FOV, FOV + '<rgb name="fov_axis" value="1, 1, 1"/>', "a <string>"),
    "light in a group": (
        BALL,
        f'<shape type="shapegroup"><shape type="cube"/><emitter type="point"/></shape>{BALL}',
        "'point' inside 'shapegroup' is outside",
    ),
    # lenses
    "two fields of view": (FOV, FOV + '<string name="focal_length" value="50mm"/>', "leave one out"),
    "lens of no length": (FOV, '<string name="focal_length" value="none"/>', "a length such as 50mm"),
    # what Mitsuba's parser would drop without a word
    "two of one name": (
        PAINT,
        '<bsdf name="b" type="diffuse"/><bsdf name="b" type="twosided"><bsdf type="diffuse"/></bsdf>',
        "is replaced by a later one",
    ),
    "an unused surface": (SPOT, f'<bsdf type="conductor" id="unused"/>{SPOT}', "use diffuse, phong or twosided"),
}
