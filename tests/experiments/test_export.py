"""The export alone gives another engine every ray, every depth and every light: rebuilt here in numpy."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from plain_exr import PlainExr, read_plain
from scene_files import point, sphere, spot, write_scene

from experiments.export import write_export
from scenes.errors import InputError
from scenes.mitsuba_setup import mitsuba
from scenes.model import Scene

WIDTH, HEIGHT = 40, 24
CENTRE, RADIUS = np.array([0.4, -0.3, 0.2]), 0.7
# a quadrilateral beside it, by its corners
CORNERS = np.array([[-1.6, 0.1, 0.5], [-0.8, 0.1, 0.5], [-0.8, 1.0, 0.5], [-1.6, 1.0, 0.5]])
RECTANGLE = (
    "<shape type='rectangle'><transform name='to_world'><scale x='0.4' y='0.45'/>"
    "<translate x='-1.2' y='0.55' z='0.5'/></transform></shape>"
)
SPOT = spot("0, 3, 0", "0.5, 0, 0", 25, 10)


@pytest.fixture(scope="module")
def scene(tmp_path_factory: pytest.TempPathFactory) -> Scene:
    """Seen from one side and from above, so that no axis and no sign is like another."""
    return write_scene(
        tmp_path_factory.mktemp("scene"),
        emitters=point(0.3, 2.6, 0) + SPOT,
        shapes=sphere(*CENTRE, RADIUS) + RECTANGLE,
        size=(WIDTH, HEIGHT),
        eye="1.5, 1.1, 4.2",
        near=0.5,
        phase="<phase type='hg'><float name='g' value='0.6'/></phase>",
    )


@pytest.fixture(scope="module")
def exported(scene: Scene, tmp_path_factory: pytest.TempPathFactory) -> tuple[dict, PlainExr]:
    folder = tmp_path_factory.mktemp("export") / "new"
    write_export(folder, scene)
    assert sorted(path.name for path in folder.iterdir()) == ["README.txt", "pixels.exr", "scene.json"]
    return json.loads((folder / "scene.json").read_text()), read_plain(folder / "pixels.exr")


def rays(description: dict) -> np.ndarray:
    """Directions of the pixels as README.txt has them, (H, W, 3)."""
    camera, image = description["camera"], description["image"]
    x = (2 * np.arange(image["width"]) + 1) / image["width"] - 1
    y = 1 - (2 * np.arange(image["height"]) + 1) / image["height"]
    tangents = [np.tan(np.radians(camera[f"fov_{axis}_degrees"]) / 2) for axis in "xy"]
    found = (
        np.array(camera["forward"])
        + (tangents[0] * x)[None, :, None] * camera["right"]
        + (tangents[1] * y)[:, None, None] * camera["up"]
    )
    return found / np.linalg.norm(found, axis=-1, keepdims=True)


def pixels_of(matrices: dict, points: np.ndarray, convention: str) -> np.ndarray:
    """Where points fall in the image, (N, 2) in pixels, by one of the two sets of matrices."""
    homogeneous = np.c_[points, np.ones(len(points))]
    if convention == "opengl":
        clip = homogeneous @ np.array(matrices["view"]).T @ np.array(matrices["projection"]).T
        ndc = clip[:, :3] / clip[:, 3:]
        assert (np.abs(ndc) < 1).all()
        return (ndc[:, :2] * [1, -1] + 1) / 2 * [WIDTH, HEIGHT]
    local = homogeneous @ np.linalg.inv(matrices["to_world"]).T
    sample = local @ np.array(matrices["camera_to_sample"]).T
    assert (sample[:, 2] / sample[:, 3] < 1).all()
    return sample[:, :2] / sample[:, 3:] * [WIDTH, HEIGHT]


def met(direction: np.ndarray, eye: np.ndarray, centre: np.ndarray, radius: float) -> tuple[np.ndarray, np.ndarray]:
    """Where rays meet a sphere, and whether they do, away from its rim, where a rounding decides."""
    half_b = direction @ (eye - centre)
    root = half_b**2 - (eye - centre) @ (eye - centre) + radius**2
    return -half_b - np.sqrt(np.maximum(root, 0)), root > 0.01


def test_the_rays_are_those_of_the_scene(exported: tuple, scene: Scene) -> None:
    description, _ = exported
    # measured: 3.4e-16
    np.testing.assert_allclose(rays(description), scene.camera.rays()[1], rtol=0, atol=1e-14)


def test_depth_is_that_of_a_sphere_met_by_the_rebuilt_rays(exported: tuple) -> None:
    description, plain = exported
    direction, eye = rays(description), np.array(description["camera"]["position"])
    expected, ball = met(direction, eye, CENTRE, RADIUS)
    assert 20 < ball.sum() < WIDTH * HEIGHT / 2
    expected = expected[ball]
    distance = plain.channels["distance.Y"][ball]
    np.testing.assert_allclose(distance, expected, rtol=1e-6)  # measured: 2.5e-7
    along = direction @ np.array(description["camera"]["forward"])
    np.testing.assert_allclose(plain.channels["z.Y"][ball], expected * along[ball], rtol=1e-6)
    before_near = description["camera"]["near"] / along[ball]
    np.testing.assert_allclose(plain.channels["depth.Z"][ball], expected - before_near, rtol=1e-6)
    normal = np.stack([plain.channels[f"normal.{letter}"][ball] for letter in "RGB"], axis=-1)
    outward = (eye + direction[ball] * expected[:, None] - CENTRE) / RADIUS
    np.testing.assert_allclose(normal, outward, rtol=0, atol=4e-6)  # measured: 1.8e-6
    assert (plain.channels["hit.Y"][ball] == 1).all()


def test_rays_that_meet_nothing_end_on_the_far_plane(exported: tuple) -> None:
    description, plain = exported
    missed = plain.channels["hit.Y"] == 0
    assert 0 < missed.sum() < missed.size
    np.testing.assert_allclose(plain.channels["z.Y"][missed], description["camera"]["far"], rtol=2e-7)  # measured: 0
    assert not plain.channels["normal.R"][missed].any()


@pytest.mark.parametrize("convention", ["opengl", "mitsuba"])
def test_known_vertices_fall_on_the_edge_of_what_was_hit(exported: tuple, convention: str) -> None:
    description, plain = exported
    corners = pixels_of(description["camera"][convention], CORNERS, convention)
    # inside where every edge has the pixel's centre on the same side
    centres = np.stack(np.meshgrid(np.arange(WIDTH) + 0.5, np.arange(HEIGHT) + 0.5), axis=-1)
    edges = np.roll(corners, -1, axis=0) - corners
    sides = [
        edge[0] * (centres - a)[..., 1] - edge[1] * (centres - a)[..., 0]
        for a, edge in zip(corners, edges, strict=True)
    ]
    inside = np.all(np.array(sides) < 0, axis=0)
    facing = plain.channels["normal.B"] > 0.999999
    assert inside.sum() > 20
    np.testing.assert_array_equal(facing, inside)


def test_the_matrices_are_mitsubas_and_opengls_own(exported: tuple, scene: Scene) -> None:
    description, plain = exported
    camera, mi = description["camera"], mitsuba()
    size, lens = mi.ScalarVector2i(WIDTH, HEIGHT), mi.Float(camera["fov_x_degrees"])
    theirs = mi.perspective_projection(size, size, mi.ScalarVector2i(0, 0), lens, mi.Float(0.5), mi.Float(25))
    theirs = np.array(theirs.matrix).reshape(4, 4)
    np.testing.assert_allclose(camera["mitsuba"]["camera_to_sample"], theirs, rtol=0, atol=1e-6)  # measured: 2.4e-7
    # both put the end of every ray into its own pixel
    direction, eye = rays(description), np.array(camera["position"])
    ends = (eye + direction * plain.channels["distance.Y"][..., None]).reshape(-1, 3)
    ends = eye + 0.999 * (ends - eye)
    centres = np.stack(np.meshgrid(np.arange(WIDTH) + 0.5, np.arange(HEIGHT) + 0.5), axis=-1).reshape(-1, 2)
    for convention in ("opengl", "mitsuba"):
        found = pixels_of(camera[convention], ends, convention)
        np.testing.assert_allclose(found, centres, rtol=0, atol=1e-12)  # measured: 1.7e-14


def test_lights_fog_and_phase_function_are_there_with_their_units(exported: tuple) -> None:
    description, _ = exported
    first, second = description["lights"]
    assert (first["kind"], first["intensity"], first["unit"]) == ("point", [10, 10, 10], "W / sr")
    assert first["position"] == pytest.approx([0.3, 2.6, 0])
    assert (second["beam_width_degrees"], second["cutoff_angle_degrees"]) == pytest.approx((10, 25))
    assert second["direction"] == pytest.approx(list(np.array([0.5, -3, 0]) / np.hypot(0.5, 3)))
    assert "linearly with the angle" in second["falloff"]
    assert description["medium"]["sigma_s"] == pytest.approx([0.09] * 3)
    assert description["medium"]["sigma_t"] == pytest.approx([0.1] * 3)
    assert description["phase"]["name"] == "hg"
    assert description["phase"]["parameters"] == pytest.approx({"g": 0.6})


def test_it_says_what_made_it(exported: tuple, scene: Scene) -> None:
    description, plain = exported
    for made_by in (description["made_by"], {key[9:]: value for key, value in plain.texts.items()}):
        assert made_by["scene_digest"] == scene.digest
        assert made_by["scene_file"] == str(scene.path)
        assert made_by["airlight"]


def test_the_boundary_of_the_fog_stops_no_ray(tmp_path: Path) -> None:
    boundary = (
        "<shape type='cube'><transform name='to_world'><scale value='1.5'/></transform><bsdf type='null'/>"
        "<ref name='interior' id='fog'/></shape>"
    )
    scene = write_scene(tmp_path, shapes=sphere(0, 0, 0, 0.5) + boundary, size=(16, 16), inside=False)
    write_export(tmp_path / "there", scene)
    plain = read_plain(tmp_path / "there" / "pixels.exr")
    description = json.loads((tmp_path / "there" / "scene.json").read_text())
    expected, ball = met(rays(description), np.array([0.0, 0, 5]), np.zeros(3), 0.5)
    assert ball.sum() > 10
    np.testing.assert_allclose(plain.channels["distance.Y"][ball], expected[ball], rtol=1e-6)  # measured: 2.2e-8
    # past the ball, through both faces of the cube
    assert plain.channels["hit.Y"][7, 1] == 0
    planes = description["medium"]["boundary"]["planes"]
    assert sorted(map(tuple, np.round(planes, 6))) == sorted(
        (*(sign * axis), 1.5) for axis in np.eye(3) for sign in (1, -1)
    )
    # rebuilt by the words beside them
    words = description["medium"]["boundary"]["convention"]
    relation = {"<=": np.less_equal, ">=": np.greater_equal}[words.split("n . x ")[1].split(" o ")[0]]
    points = np.random.default_rng(2).uniform(-3, 3, (500, 3))
    inside = relation(points @ np.array(planes)[:, :3].T, np.array(planes)[:, 3]).all(axis=1)
    np.testing.assert_array_equal(inside, (np.abs(points) < 1.5).all(axis=1))
    assert 20 < inside.sum() < 200


def test_the_command_writes_it_and_estimates_nothing(airlight, tmp_path: Path) -> None:
    result = airlight("reference", "empty", "-p", "sigma_t=0.2", "--size", 8, 6, "--export", "there")
    assert result.code == 0, result.err
    assert sorted(path.name for path in tmp_path.iterdir()) == ["there"]
    text = (tmp_path / "there" / "README.txt").read_text()
    assert "airlight reference empty -p sigma_t=0.2 --size 8 6 --out reference.exr" in text
    # over its own files, and nobody else's
    assert airlight("reference", "empty", "--size", 10, 6, "--export", "there").code == 0
    assert read_plain(tmp_path / "there" / "pixels.exr").channels["z.Y"].shape == (6, 10)
    (tmp_path / "other").mkdir()
    (tmp_path / "other" / "README.txt").write_text("mine")
    (tmp_path / "file").write_text("")
    for words, said in (
        (["--export", "other"], "other/README.txt is of no export of ours, and would be lost"),
        (["--export", "file"], "choose another --export"),
        (["--export", "there", "--deterministic"], "Without --out nothing is estimated; leave --deterministic out."),
        ([], "reference needs --out with a file for the estimate, or --export with a folder"),
    ):
        result = airlight("reference", "empty", "--size", 8, 6, *words)
        assert result.code == 2
        assert said in result.err
    assert (tmp_path / "other" / "README.txt").read_text() == "mine"


def test_an_export_that_fails_leaves_what_was_there(scene: Scene, tmp_path: Path, monkeypatch) -> None:
    write_export(tmp_path, scene)
    before = {path.name: path.read_bytes() for path in tmp_path.iterdir()}

    def full(*_: object, **__: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(Path, "write_text", full)
    with pytest.raises(InputError, match="No space left on device"):
        write_export(tmp_path, scene)
    assert {path.name: path.read_bytes() for path in tmp_path.iterdir()} == before
