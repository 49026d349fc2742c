"""The renderer as a whole: upsampling, sizes, shadow-map faces, refusals."""

from __future__ import annotations

import numpy as np
import pytest
from scene_files import POINT, point, sphere, spot, write_scene

from gpu_impl.context import create_context, shared_context
from gpu_impl.device import Device
from gpu_impl.geometry import Geometry
from gpu_impl.light_uniforms import light_uniforms
from gpu_impl.passes.shadow_map import render_shadow_map, tile_count
from gpu_impl.renderer import Renderer
from gpu_impl.shader_source import ShaderSource, compile_program, set_uniforms
from gpu_impl.techniques import TECHNIQUES, find_technique
from gpu_impl.textures import PictureTextures
from scenes.errors import InputError
from scenes.loader import load
from scenes.meshes import tessellate

QUADRATURE = "lit_intervals+quadrature"


def bilinear(image: np.ndarray, step: int) -> np.ndarray:
    """What plain interpolation makes of every `step`-th pixel."""
    height, width, _ = image.shape
    first = [min(step // 2, (n - 1) % step) for n in (height, width)]
    rows, columns = (np.arange(f, n, step) for f, n in zip(first, (height, width), strict=True))
    coarse = image[rows][:, columns]
    y, x = ((np.arange(n) - f) / step for f, n in zip(first, (height, width), strict=True))
    y0, x0 = np.floor(y).astype(int), np.floor(x).astype(int)

    def at(row: np.ndarray, column: np.ndarray) -> np.ndarray:
        return coarse[np.clip(row, 0, len(rows) - 1)][:, np.clip(column, 0, len(columns) - 1)]

    wy, wx = (y - y0)[:, None, None], (x - x0)[None, :, None]
    upper = (1 - wx) * at(y0, x0) + wx * at(y0, x0 + 1)
    return (1 - wy) * upper + wy * ((1 - wx) * at(y0 + 1, x0) + wx * at(y0 + 1, x0 + 1))


def depth_edges(depth: np.ndarray) -> np.ndarray:
    edges = np.zeros(depth.shape, bool)
    right, below = (np.abs(np.diff(depth, axis=axis)) > 0.1 * np.delete(depth, 0, axis) for axis in (1, 0))
    edges[:, 1:] |= right
    edges[:, :-1] |= right
    edges[1:] |= below
    edges[:-1] |= below
    return edges


@pytest.mark.parametrize("size", [(64, 64), (45, 31)])
@pytest.mark.parametrize("step", [2, 4, 8])
def test_downsampling_without_edges_is_bilinear(size: tuple[int, int], step: int, draw) -> None:
    scene = load("empty", size=size)
    full, coarse = (draw(scene, QUADRATURE, steps=2, shadow_map=8, downsample=n).scattering for n in (1, step))
    # the weights' floor of 1e-4 is what differs: measured 1.5e-4
    assert coarse == pytest.approx(bilinear(full, step), rel=4e-4)
    # measured 0.8 % and 1.7 % for a step of 8
    assert np.median(np.abs(coarse - full) / full) < 2.7e-4 * step**2


@pytest.mark.parametrize("size", [(128, 128), (101, 75)])
@pytest.mark.parametrize(("step", "better"), [(2, 0.4), (4, 0.5), (8, 0.85)])
def test_downsampling_keeps_depth_edges(size: tuple[int, int], step: int, better: float, draw) -> None:
    scene = load("sphere", size=size)
    full = draw(scene, QUADRATURE, shadow_map=512)
    coarse = draw(scene, QUADRATURE, shadow_map=512, downsample=step)
    edges = depth_edges(full.depth)
    assert edges.sum() > 200
    ours, plain = (
        (np.abs(image - full.scattering) / full.scattering)[edges].mean()
        for image in (coarse.scattering, bilinear(full.scattering, step))
    )
    # measured at the edges: 1.3 %, 2.9 %, 7.0 % where bilinear has 6.9 %, 9.2 %, 10.8 % (128^2)
    assert ours < better * plain
    # only the fog is evaluated coarsely
    assert (coarse.surface == full.surface).all()
    assert (coarse.depth == full.depth).all()


@pytest.mark.parametrize("size", [(1, 1), (1, 7), (9, 2), (17, 5)])
@pytest.mark.parametrize("step", [1, 2, 4, 8])
def test_any_size(size: tuple[int, int], step: int, draw) -> None:
    scene = load("sphere", size=size)
    frame = draw(scene, "Weng2010", shadow_map=64, downsample=step)
    height, width = size[1], size[0]
    assert frame.scattering.shape == frame.surface.shape == frame.composite.shape == (height, width, 3)
    assert frame.depth.shape == frame.lit_intervals.shape == (height, width)
    assert np.isfinite(frame.composite).all()
    assert (frame.scattering > 0).all()
    if size == (1, 1):
        # one pixel, evaluated whatever the step; by the same samples where no polygon bounds them
        unbounded = "lit_intervals:unbounded+weng2010"
        coarse, whole = (draw(scene, unbounded, shadow_map=64, downsample=n).scattering for n in (step, 1))
        assert coarse == pytest.approx(whole, rel=1e-6)
        # half a step of 128 and a texel of 64; measured 0.4 %, and 31 % too bright where polygons are lost
        assert frame.scattering == pytest.approx(whole, rel=0.02)


def test_renderers_do_not_disturb_each_other(draw) -> None:
    scenes = [load("sphere", size=(33, 21)), load("empty", size=(16, 24), phase="hg", g=0.6)]
    alone = [draw(scene, QUADRATURE, shadow_map=64) for scene in scenes]
    technique = find_technique(QUADRATURE, shadow_map=64)
    with Renderer(scenes[0]) as first, Renderer(scenes[1]) as second:
        for _ in range(2):
            for renderer, before in zip((first, second), alone, strict=True):
                again = renderer.render(technique)
                assert (again.composite == before.composite).all()
                assert (again.depth == before.depth).all()


def test_techniques_do_not_disturb_each_other() -> None:
    scene = load("sphere", size=(32, 32))
    techniques = [find_technique(name, shadow_map=64) for name in (QUADRATURE, "Nishita1987", "Weng2010")]
    with Renderer(scene) as renderer:
        first = [renderer.render(technique).scattering for technique in techniques]
        again = [renderer.render(technique).scattering for technique in reversed(techniques)]
    for one, other in zip(first, reversed(again), strict=True):
        assert (one == other).all()


SIX_AND_MORE = [(x, y, z) for x in (-1, 0, 1) for y in (-1, 0, 1) for z in (-1, 0, 1) if (x, y, z) != (0, 0, 0)]


@pytest.mark.parametrize(
    ("light", "tiles"),
    [(point(0.1, 0.2, -0.3), 6), (spot("0.1, 0.2, -0.3", "1, 0.5, 0.2", 50, 50), 1)],
    ids=["cube", "spot"],
)
def test_shadow_map_finds_the_nearest_surface_in_every_direction(
    light: str, tiles: int, tmp_path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """26 spheres around the light: at the middles of the cube's faces, across its edges, and over its corners."""
    # 5,120 triangles each, not 81,920: off by a thousandth of the radius, far below the tolerance
    monkeypatch.setattr(tessellate, "SUBDIVISIONS", 4)
    monkeypatch.setattr(tessellate, "sphere", tessellate.sphere.__wrapped__)
    centres = np.array([2.5 * np.array(v) / np.linalg.norm(v) for v in SIX_AND_MORE])
    # of different sizes, so that no face can stand in for another
    radii = 0.35 + 0.01 * np.arange(len(centres))
    scene = write_scene(tmp_path, light, "".join(sphere(*c, r) for c, r in zip(centres, radii, strict=True)))
    device, lamp = Device(shared_context()), scene.lights[0]
    assert tile_count(lamp) == tiles
    geometry = Geometry(device, scene)
    shadow_map = render_shadow_map(device, geometry, lamp, 512)

    side = 96
    directions = np.random.default_rng(2).normal(size=(side * side, 3))
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    points = device.context.texture(
        (side, side), 4, np.pad(lamp.position + directions, ((0, 0), (0, 1))).astype("f4"), dtype="f4"
    )
    main = """
        #include "shadow_lookup.glsl"
        uniform Light light;
        uniform sampler2D points;
        out vec4 result;
        void main() {
            vec3 point = texelFetch(points, ivec2(gl_FragCoord.xy), 0).xyz;
            result = vec4(nearest_surface(light, point), tile_position(point - light.position));
        }"""
    source = ShaderSource("<main>", {"TILES": tiles, "DIRECTIONAL": 0}, generated={"<main>": main})
    program = compile_program(device.context, ShaderSource("fullscreen.vert.glsl"), source)
    set_uniforms(program, light_uniforms(scene, lamp, PictureTextures(device)) | shadow_map.bind(0) | {"points": 1})
    points.use(1)
    target = device.texture((side, side), 4)
    device.fill(program, target)
    found = np.frombuffer(target.read(), np.float32).reshape(-1, 4)
    geometry.release()

    # distance to the nearest of the spheres, and how many texels away a silhouette is
    q = lamp.position - centres
    b, c = directions @ q.T, (q**2).sum(1) - radii**2
    passing = np.sqrt((q**2).sum(1) - b**2)
    with np.errstate(invalid="ignore"):
        exact = np.where((passing < radii) & (b < 0), -b - np.sqrt(b**2 - c), np.inf).min(1)
    # a texel is at most 2 / 512 of the distance wide, measured across the tile; the sphere's slope there is bounded
    clear = np.abs(passing - radii).min(1) > 0.06
    if tiles == 1:
        inside = np.arccos(np.clip(directions @ lamp.direction, -1, 1)) < lamp.cutoff_angle
        clear &= inside
    else:
        clip = np.einsum(
            "tij,nj->tni", shadow_map.matrices, np.pad(lamp.position + directions, ((0, 0), (0, 1)), constant_values=1)
        )
        ours = found[:, 3].astype(int)
        own = clip[ours, np.arange(len(ours))]
        # the tile's own matrix puts the direction where tile_position() does; float32 rounds the product
        assert own[:, :2] / own[:, 3:] == pytest.approx(found[:, 1:3], abs=2e-6)
        assert (np.abs(found[:, 1:3]) <= 1).all()
        assert set(ours) == set(range(6))
    hit = clear & np.isfinite(exact)
    missed = clear & np.isinf(exact)
    assert hit.sum() > 100
    assert missed.sum() > 100
    assert (found[missed, 0] > 1e30).all()
    assert found[hit, 0] == pytest.approx(exact[hit], rel=2e-2)
    shadow_map.texture.release()


def test_refusals() -> None:
    with pytest.raises(InputError, match="There is no technique 'Weng2011'"):
        find_technique("Weng2011")
    with pytest.raises(InputError, match="There is no visibility 'nothing'"):
        find_technique("nothing+quadrature")
    with pytest.raises(InputError, match="There is no airlight model 'nothing'"):
        find_technique("lit_intervals+nothing")
    for settings in ({"steps": 0}, {"steps": 1 << 21}, {"shadow_map": 0}, {"shadow_map": 20000}, {"downsample": 3}):
        (name,) = settings
        with pytest.raises(InputError, match=f"{name} is {settings[name]}"):
            find_technique("Weng2010", **settings)


def test_a_model_refuses_a_phase_function_it_cannot_take(draw) -> None:
    with pytest.raises(
        InputError, match="one_ei takes the phase function isotropic or rayleigh or schlick, and the scene has hg"
    ):
        draw(load("empty", size=(8, 8), phase="hg"), "Weng2010")


def test_what_opengl_cannot_hold_is_refused(tmp_path, draw) -> None:
    limit = shared_context().info["GL_MAX_TEXTURE_SIZE"]
    with pytest.raises(InputError, match=f"A shadow map of 6 x {limit // 6 + 1} texels"):
        draw(write_scene(tmp_path, POINT, size=(2, 2)), "Weng2010", shadow_map=limit // 6 + 1)
    if limit < 16384:
        with pytest.raises(InputError, match="The image is larger"):
            Renderer(load("empty", size=(16384, 1)))


def test_no_egl_is_one_sentence(monkeypatch: pytest.MonkeyPatch) -> None:
    import moderngl

    def fails(*_: object, **__: object) -> None:
        raise Exception("libEGL.so.1 not loaded\n")

    monkeypatch.setattr(moderngl, "create_context", fails)
    with pytest.raises(InputError) as caught:
        create_context()
    message = str(caught.value)
    assert "libEGL.so.1 not loaded" in message
    assert "make setup" in message
    assert "\n" not in message


def test_every_technique_draws(draw) -> None:
    scene = load("sphere", size=(16, 16))
    for name in TECHNIQUES:
        frame = draw(scene, name, shadow_map=64)
        assert frame.technique.name == name
        assert (frame.scattering > 0).all()
        assert (frame.composite == frame.surface + frame.scattering).all()


def test_scale_and_clips_of_mitsubas_own_leave_no_z_fighting(tmp_path, draw) -> None:
    floor = (
        "<shape type='rectangle'><transform name='to_world'><scale value='{0}'/><rotate x='1' angle='-90'/>"
        "<translate y='-{1}'/></transform></shape>"
    )
    depths = []
    for scale in (1, 1000):
        # a plate a thousandth above the floor, and near_clip at its default of 0.01 whatever the scale
        shapes = floor.format(4 * scale, 1 * scale) + floor.format(scale, 0.999 * scale)
        scene = write_scene(
            tmp_path,
            emitters=point(0.3 * scale, 2.6 * scale, 0),
            shapes=shapes,
            eye=f"0, 0, {5 * scale}",
            far=1e4,
            sigma_t="<float name='sigma_t' value='1e-5'/>",
        )
        depths.append(draw(scene, "lit_intervals+quadrature", steps=4, shadow_map=8).depth)
    hit = depths[0] < 100
    assert hit.sum() > 500
    # rays begin on the near plane, which does not scale here
    camera = scene.camera
    before = 0.01 * camera.rays()[2] / (camera.far - camera.near)
    # the wrong one of the two plates would be off by 2e-4
    np.testing.assert_allclose(depths[1][hit], (1000 * (depths[0] + before) - before)[hit], rtol=2e-5)


def test_normals_of_length_zero_are_black_as_in_mitsuba(tmp_path, draw) -> None:
    header = "ply\nformat ascii 1.0\nelement vertex 3\n" + "".join(
        f"property float {name}\n" for name in ("x", "y", "z", "nx", "ny", "nz")
    )
    rows = "-1 -1 0 0 0 0\n1 -1 0 0 0 0\n0 1 0 0 0 0\n"
    faces = "element face 1\nproperty list uchar int vertex_indices\nend_header\n"
    (tmp_path / "zero.ply").write_text(header + faces + rows + "3 0 1 2\n")
    scene = write_scene(tmp_path, shapes="<shape type='ply'><string name='filename' value='zero.ply'/></shape>")
    frame = draw(scene, "lit_intervals+quadrature", steps=4, shadow_map=8)
    assert (frame.depth < 20).any()
    assert (frame.surface == 0).all()
    assert np.isfinite(frame.scattering).all()
