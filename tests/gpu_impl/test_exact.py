"""The visibility `exact`: against a float64 brute force over all texels, against shadows in closed form, and spoilt."""

from __future__ import annotations

import itertools
from dataclasses import replace

import numpy as np
import pytest
from map_walk import FILE, ROW, Walk, apart, point_light, reported, spot_light, sun
from oracles import SphereScene, whole_ray_airlight
from scene_files import point, write_scene
from shadow_volumes import SHADOWS, plate, shadowed_airlight
from texel_intervals import texel_intervals

from gpu_impl.context import shared_context
from gpu_impl.device import Device
from gpu_impl.passes.shadow_map import MAP_FRAME
from gpu_impl.renderer import Renderer
from gpu_impl.shader_source import SHADERS
from gpu_impl.techniques import find_technique
from scenes.loader import load

LIGHTS = {"point": point_light(), "spot": spot_light(), "sun": sun()}
EXACT = "exact+quadrature"
NOTHING = 3e38
LINE = "visibility/parts/map_line.glsl"
PYRAMID = "visibility/parts/shadow_pyramid.glsl"
# what breaks the traversal, and where
FAULTS = {
    "a border too far": (LINE, "node.last.x + 1 : node.first.x,", "node.last.x + 2 : node.first.x,"),
    "the tile's mirror image": (LINE, "^ (stretch.side & 1)", "^ (1 - (stretch.side & 1))"),
    "another axis": (LINE, "int[6](4, 5, 0, 1, 1, 0)", "int[6](5, 4, 0, 1, 1, 0)"),
    "half a texel": (LINE, "floor((0.5 + 0.5 * position.xy", "floor((0.53 + 0.5 * position.xy"),
    "a last node without its rest": (PYRAMID, "number.x + 1 < size ? last.x : tile_size - 1", "last.x"),
    "the other bound": (FILE, "far > reached.x && near <= reached.y", "far > reached.y && near <= reached.y"),
    "dark for lit": (FILE, "near <= reached.y", "near <= reached.x"),
    "one side only": (FILE, "max(along, -reached.x)", "along"),
    "the last piece lost": (FILE, "if (is_last) whole = held;", ""),
    "pieces bridged": (FILE, "is_whole = part.x > held.y;", "is_whole = part.x > held.y + 0.05;"),
    "a node skipped": (FILE, "node.last.y + 1 : node.first.y - 1", "node.last.y + 2 : node.first.y - 1"),
}


def noise(size: int, tiles: int, seed: int) -> np.ndarray:
    """Distances in blocks, which a pyramid can skip, with nearer texels and holes strewn in."""
    random = np.random.default_rng(seed)
    blocks = random.uniform(0.4, 3, (8, 8 * tiles))
    texels = blocks[np.arange(size) * 8 // size][:, np.arange(tiles * size) * 8 // size]
    strewn = random.random(texels.shape)
    texels = np.where(strewn < 0.15, random.uniform(0.3, 3, texels.shape), texels)
    return np.where(strewn > 0.93, NOTHING, texels).astype(np.float32)


def random_walk(kind: str, size: int, rays: int) -> Walk:
    """Rays from anywhere to anywhere."""
    random = np.random.default_rng(size)
    direction = random.normal(size=(rays, 3))
    if kind == "spot":
        direction = LIGHTS[kind].position + [0.6, 0, 0.8] + 0.4 * direction
        origin = random.uniform(-2, 2, (rays, 3))
        direction -= origin
    else:
        origin = random.uniform(-2, 2, (rays, 3))
    direction /= np.linalg.norm(direction, axis=1, keepdims=True)
    tiles = 6 if kind == "point" else 1
    ends = random.uniform(0.5, 6, rays)
    parts = (part.astype(np.float32) for part in (origin, direction, ends))
    return Walk(*parts, LIGHTS[kind], noise(size, tiles, size))


def expected(walk: Walk) -> list[list[tuple[float, float]]]:
    device = Device(shared_context())
    shadow_map = walk.map_of(device)
    found = []
    for origin, direction, end in zip(walk.origin, walk.direction.astype(float), walk.end, strict=True):
        way = direction / np.linalg.norm(direction)
        found.append(
            texel_intervals(shadow_map, walk.stored.astype(float), walk.light, origin.astype(float), way, float(end))
        )
    shadow_map.texture.release()
    device.release()
    return found


def off(walk: Walk, **settings) -> np.ndarray:
    """How much of each ray is told wrongly [scene unit]."""
    found, _ = reported(walk, **settings)
    return np.array([apart(*pair) for pair in zip(found, expected(walk), strict=True)])


@pytest.mark.parametrize(
    ("kind", "size", "rays"),
    [*itertools.product(LIGHTS, (1, 3, 17, 64), (2 * ROW,)), ("point", 1000, 8), ("sun", 1000, 16)],
)
def test_every_texel_crossing_is_told(kind: str, size: int, rays: int) -> None:
    walk = random_walk(kind, size, rays)
    found, _ = reported(walk)
    truth = expected(walk)
    wrong = [apart(*pair) for pair in zip(found, truth, strict=True)]
    assert sum(map(len, truth)) > 4
    # none is lost, none invented, neighbours are one
    assert [len(one) for one in found] == [len(one) for one in truth]
    # float32 on rays of up to 6 units: measured 5.2e-5, in the median 3.0e-5 (1,000 texels, hundreds of ends a ray)
    assert max(wrong) < 1.5e-4
    assert np.median(wrong) < 6e-5


@pytest.mark.parametrize("fault", FAULTS)
def test_the_brute_force_notices(fault: str) -> None:
    file, right, wrong = FAULTS[fault]
    text = (SHADERS / file).read_text()
    assert right in text
    walk = random_walk("point", 17, ROW)
    # measured: 2.8e-6 as it is
    assert off(walk, changed={file: text.replace(right, wrong)}).max() > 0.01


def beside_a_cavern() -> Walk:
    """Rays about as far from the light as all texels reach, so that what is lit lies about the nearest place."""
    random, rays, light = np.random.default_rng(3), ROW, LIGHTS["point"]
    way, aside = random.normal(size=(2, rays, 3))
    way /= np.linalg.norm(way, axis=1, keepdims=True)
    aside -= (aside * way).sum(-1, keepdims=True) * way
    aside *= random.uniform(1.0, 1.2, (rays, 1)) / np.linalg.norm(aside, axis=1, keepdims=True)
    parts = (light.position + aside - 2 * way, way, np.full(rays, 4.0))
    stored = random.uniform(0.3, 1.25, (64, 6 * 64)).astype(np.float32)
    return Walk(*(part.astype(np.float32) for part in parts), light, stored)


def across_the_sun() -> Walk:
    """Rays all but at right angles to parallel light, among texels whose distances are all but theirs."""
    random, rays, light = np.random.default_rng(4), ROW, LIGHTS["sun"]
    way = np.cross(light.direction, random.normal(size=(rays, 3)))
    way /= np.linalg.norm(way, axis=1, keepdims=True)
    way += random.choice([-1, 1], (rays, 1)) * random.uniform(2e-3, 5e-3, (rays, 1)) * light.direction
    way /= np.linalg.norm(way, axis=1, keepdims=True)
    away = 0.2 * random.normal(size=(rays, 3))
    # the map's plane has the height 1 below all that BOUNDS hold
    away -= ((away - light.position) @ light.direction - 1)[:, None] * light.direction
    stored = (1 + random.uniform(-5e-3, 5e-3, (64, 64))).astype(np.float32)
    return Walk(*(part.astype(np.float32) for part in (away - 0.7 * way, way, np.full(rays, 1.4))), light, stored)


# other walks, what breaks the traversal on them and by how much they are off without [scene unit]
CLOSE = {
    "the nearest place forgotten": (
        beside_a_cavern,
        "along < 0.0 && leave > 0.0 ? 0.0 : min(abs(along), abs(leave))",
        "min(abs(along), abs(leave))",
        2e-5,
    ),
    "light that is never all but level": (
        across_the_sun,
        "max(approach.aside, 1e-18)",
        "max(approach.aside, 1e-2)",
        1e-3,
    ),
}


@pytest.mark.parametrize("fault", CLOSE)
def test_what_lies_about_the_nearest_place_is_told(fault: str) -> None:
    make, right, wrong, limit = CLOSE[fault]
    walk, text = make(), (SHADERS / FILE).read_text()
    assert right in text
    assert sum(map(len, expected(walk))) > 3 * ROW
    assert off(walk).max() < limit
    assert off(walk, changed={FILE: text.replace(right, wrong)}).max() > 0.01


def special_rays() -> tuple[np.ndarray, np.ndarray]:
    """Through the light, from it, in the planes that part a cube's faces, through its corners, along texel borders."""
    ways = np.array([way for way in itertools.product((-1.0, 0.0, 1.0), repeat=3) if any(way)])
    ways /= np.linalg.norm(ways, axis=1, keepdims=True)
    beside = [way * t for way in ways for t in (0.0, 0.25, -1.5)]
    pairs = [(origin, way) for origin in beside for way in ways]
    return np.array([pair[0] for pair in pairs]), np.array([pair[1] for pair in pairs])


@pytest.mark.parametrize("size", [1, 2, 17, 64])
def test_edges_and_corners_of_a_cube_lose_nothing(size: int) -> None:
    """The light sees a ball around it: any line through any edge or corner has one piece of it, or none."""
    aside, direction = special_rays()
    light, radius, end = LIGHTS["point"], 1.25, 4.0
    # float32 keeps these sums on the planes that are meant
    walk = Walk(
        (aside + np.float32(light.position)).astype(np.float32),
        direction.astype(np.float32),
        np.full(len(aside), end, np.float32),
        light,
        np.full((size, 6 * size), radius, np.float32),
    )
    found, _ = reported(walk)
    t_h = -(aside * direction).sum(-1)
    square = radius**2 - (aside**2).sum(-1) + t_h**2
    assert (np.abs(square) > 1e-3).all()
    half = np.sqrt(np.maximum(square, 0))
    begin, stop = np.maximum(t_h - half, 0), np.minimum(t_h + half, end)
    lit = (square > 0) & (stop > begin)
    # some begin or end on the ball itself, where either answer is right
    clear = ~lit | (stop - begin > 1e-4)
    assert (lit & clear).sum() > 1000
    for ray in np.flatnonzero(clear):
        assert len(found[ray]) <= 1 + (not lit[ray])
        # measured 6e-7
        assert apart(found[ray], [(begin[ray], stop[ray])] if lit[ray] else []) < 4e-6


def radial(way: np.ndarray, beside: np.ndarray, stored: np.ndarray) -> Walk:
    """Rays on lines through the light, which begin at `beside` along them and are 4 long."""
    light = LIGHTS["point"]
    light = replace(light, position=light.position.astype(np.float32).astype(float))
    way = way / np.linalg.norm(way, axis=1, keepdims=True)
    parts = (light.position + beside[:, None] * way, way, np.full(len(way), 4.0))
    return Walk(*(part.astype(np.float32) for part in parts), light, stored)


def unlike_all(told: list[tuple[float, float]], truths: list[list[tuple[float, float]]], end: float) -> float:
    """Length of the ray that `told` has lit and all of `truths` dark, or the other way round."""
    cuts = np.unique([0.0, end, *np.ravel(told), *(t for truth in truths for t in np.ravel(truth))])
    middle = 0.5 * (cuts[1:] + cuts[:-1])
    lit = [np.sum([(a < middle) & (middle < b) for a, b in one], axis=0, dtype=int) for one in (told, *truths)]
    lit = [np.broadcast_to(one, middle.shape) for one in lit]
    return float(np.diff(cuts)[np.all([lit[0] != one for one in lit[1:]], axis=0)].sum())


@pytest.mark.parametrize("size", [17, 64])
def test_rays_through_the_light_read_the_texels_on_both_sides(size: int) -> None:
    """Every texel has a distance of its own, which shows what a ray reads on its two sides of the light."""
    random = np.random.default_rng(5)
    edges = special_rays()[1][:26]
    ways = np.concatenate([edges, edges @ MAP_FRAME.T, random.normal(size=(76, 3))])
    ways /= np.linalg.norm(ways, axis=1, keepdims=True)
    # from the light, through it, up to it, and away from it
    beside = np.repeat([0.0, -1.5, -4.0, 0.01], len(ways))
    way = np.tile(ways, (4, 1))
    stored = random.uniform(0.2, 3, (size, 6 * size)).astype(np.float32)
    found, _ = reported(radial(way, beside, stored))
    # rounding decides which of two texels a ray along their border is in, for each of its parts
    tilts = [1e-4 * np.array(tilt) for tilt in itertools.product((-1, 1), repeat=3)]
    truths = [expected(radial(way + tilt, beside, stored)) for tilt in tilts]
    told = [[(begin, begin + length) for begin, length in pieces] for pieces in found]
    wrong = [unlike_all(mine, [truth[ray] for truth in truths], 4.0) for ray, mine in enumerate(told)]
    # measured 7.0e-7
    assert max(wrong) < 2e-6


def test_a_buffer_tells_the_same() -> None:
    for kind in LIGHTS:
        walk = random_walk(kind, 17, ROW)
        (texture, reads), (buffer, same_reads) = reported(walk), reported(walk, storage="buffer")
        assert (reads == same_reads).all()
        assert all((a == b).all() for a, b in zip(texture, buffer, strict=True))


def test_a_pyramid_spares_reads() -> None:
    """A ray in the open meets the top of each tile; one beside blocks reads fewer texels than it crosses."""
    walk = random_walk("point", 512, ROW)
    walk.stored[:] = NOTHING
    _, reads = reported(walk)
    # a ray crosses five faces of a cube at most
    assert reads.max() <= 5
    with Renderer(load("sphere", size=(64, 64))) as renderer:
        read = renderer.counts(find_technique(EXACT, shadow_map=1024))["shadow_map_reads"]
    # measured 36.0 in the mean and 118 at most, of more than 500 texels
    assert read.mean() < 60
    assert read.max() < 250


def error(image: np.ndarray, truth: np.ndarray) -> np.ndarray:
    """Relative to the pixel, or to a thousandth of the mean where it is darker."""
    return np.abs(image - truth).max(-1) / np.maximum(truth.max(-1), 1e-3 * truth.mean())


@pytest.mark.parametrize("name", SHADOWS)
def test_it_converges_to_shadows_in_closed_form(name: str) -> None:
    """The eye in shadow, light behind the eye, grazing edges, two pieces a ray."""
    scene = load(name, size=(64, 64))
    errors, means = [], []
    with Renderer(scene) as renderer:
        # how near an edge lies to a border of texels is luck, one for all pixels where it is parallel to them
        for sizes in ((225, 256, 287), (1800, 2048, 2296)):
            frames = [renderer.render(find_technique(EXACT, shadow_map=size)) for size in sizes]
            truth = shadowed_airlight(scene, frames[0].depth.astype(np.float64))
            errors.append(np.mean([error(frame.scattering, truth) for frame in frames]))
            means.append(np.mean([frame.scattering.mean(dtype=float) for frame in frames]) / truth.mean() - 1)
    # an eighth of the width: measured 0.09 (slit) to 0.24 (light_behind_eye, some rays nearly along an edge's plane)
    assert errors[1] < 0.25 * errors[0]
    assert abs(means[1]) < 1e-3


def test_the_exact_shadow_of_a_sphere() -> None:
    scene = load("sphere", size=(64, 64))
    truth = SphereScene(scene).scattering()
    with Renderer(scene) as renderer:
        errors = [
            np.percentile(error(renderer.render(find_technique(EXACT, shadow_map=size)).scattering, truth), 95)
            for size in (256, 512, 1024)
        ]
    for coarse, fine in itertools.pairwise(errors):
        assert fine < 0.7 * coarse
    # measured 4.5e-4; the march of 256 samples, 3.1e-3
    assert errors[-1] < 1e-3


@pytest.mark.parametrize("size", [16, 64, 256])
def test_a_floor_neither_shades_what_lies_before_it_nor_lets_light_through(tmp_path, size: int) -> None:
    """Rays end on a floor whose texels are wider than the rays' last part is high, on either side of it."""
    floor = (
        "<shape type='rectangle'><transform name='to_world'><scale value='60'/><rotate x='1' angle='-90'/>"
        "<translate y='{}'/></transform></shape>"
    )
    technique = find_technique(EXACT, shadow_map=size)
    above = write_scene(tmp_path, point(0.3, 2.6, 0), floor.format(-1), size=(48, 48))
    with Renderer(above) as renderer:
        frame = renderer.render(technique)
        (pieces,) = renderer.record(technique)
    depth = frame.depth.ravel()
    length = np.bincount(pieces.cell, weights=pieces.dt, minlength=depth.size)
    # at the far plane a ray may end above the floor, in what the map cannot tell from it
    on_floor = depth < 24
    assert on_floor.mean() > 0.3
    assert (np.bincount(pieces.cell, minlength=depth.size)[on_floor] == 1).all()
    # all of the ray; measured 2.2e-7 of it
    assert np.abs(length / depth - 1)[on_floor].max() < 1e-6
    below = write_scene(tmp_path, point(0.3, 2.6, 0), floor.format(1.5), size=(48, 48))
    with Renderer(below) as renderer:
        frame = renderer.render(technique)
    origin, direction, _ = below.camera.rays()
    place = origin + frame.depth[..., None] * direction - below.lights[0].position
    # a texel on the light's horizon sees past the floor, for all that is in it
    sine = -place[..., 1] / np.linalg.norm(place, axis=-1)
    ends_on_it = (frame.depth < 24) & (sine > 2.9 / size)
    assert ends_on_it.mean() > 0.1
    assert (frame.scattering[ends_on_it] == 0).all()


def test_what_lies_close_before_a_surface_is_not_taken_for_it(tmp_path) -> None:
    """A level board 4 % of the light's distance above the floor shades it, and the fog between the two."""
    plane = "<shape type='rectangle'><transform name='to_world'><scale x='{}' y='{}'/><rotate x='1' angle='-90'/>"
    plane += "<translate y='{}'/></transform></shape>"
    floor, board, half = -1.0, -0.85, 1.2
    shapes = plane.format(60, 60, floor) + plane.format(half, half, board)
    scene = write_scene(tmp_path, point(-2.5, 2.6, 0), shapes, size=(48, 48), eye="4, 1, 0.3")
    technique = find_technique(EXACT, shadow_map=1024)
    with Renderer(scene) as renderer:
        depth = renderer.render(technique).depth.astype(float).ravel()
        (pieces,) = renderer.record(technique)
    origin, direction, _ = (np.asarray(part, float) for part in scene.camera.rays())
    origin = np.broadcast_to(origin, direction.shape)
    share = (np.arange(2000) + 0.5) / 2000
    place = origin.reshape(-1, 1, 3) + (share * depth[:, None])[..., None] * direction.reshape(-1, 1, 3)
    away = place - scene.lights[0].position
    seen_at = scene.lights[0].position + away * ((board - scene.lights[0].position[1]) / away[..., 1])[..., None]
    dark = (place[..., 1] < board) & (np.abs(seen_at[..., [0, 2]]) < half).all(-1)
    # rays that end in the shadow, none of them on its border
    ends = (
        dark[:, -1] & (np.abs(place[:, -1, 1] - floor) < 1e-2) & (np.abs(seen_at[:, -1, [0, 2]]) < half - 0.02).all(-1)
    )
    assert ends.sum() > 50
    length = np.bincount(pieces.cell, weights=pieces.dt, minlength=depth.size)
    wrong = np.abs(length - depth * (1 - dark.mean(-1)))[ends]
    assert (depth * dark.mean(-1))[ends].max() > 0.2
    # texels of a 1,000th of the light's distance on rays at a slant: measured 6.8e-3
    assert wrong.max() < 0.02


def test_without_an_occluder_a_ray_is_one_piece(tmp_path) -> None:
    scene = write_scene(tmp_path, point(0.3, 2.6, 0), size=(16, 16))
    with Renderer(scene) as renderer:
        frame = renderer.render(find_technique(EXACT, shadow_map=64))
    assert (frame.lit_intervals == 1).all()
    # measured 3e-7
    assert error(frame.scattering, whole_ray_airlight(scene)).max() < 2e-6


def test_the_plates_of_the_slit_stay_dark_from_below() -> None:
    """What leaks through a slanted surface within half a texel is the map's fault, not the light's."""
    scene = load("slit", size=(64, 64))
    with Renderer(scene) as renderer:
        frame = renderer.render(find_technique(EXACT, shadow_map=512))
    depth = frame.depth.astype(np.float64)
    origin, direction, _ = scene.camera.rays()
    end = origin + depth[..., None] * direction
    truth = shadowed_airlight(scene, depth).max(-1)
    dark = (np.abs(end[..., 1] - plate(0, 1, 2.2)[0][1]) < 1e-3) & (truth < 1e-6 * truth.mean())
    assert dark.sum() > 300
    assert (frame.scattering[dark].max(-1) == 0).mean() > 0.99
