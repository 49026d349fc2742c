"""What the loader makes of a scene is what Mitsuba itself makes of the same file."""

from __future__ import annotations

import os
from pathlib import Path

import drjit as dr
import numpy as np
import pytest

from reference.mitsuba_scene import instantiate
from scenes.catalogue import FOLDER, shipped
from scenes.loader import load
from scenes.meshes.triangles import Triangles, ply_bytes
from scenes.mitsuba_setup import mitsuba
from scenes.model import Mesh, Scene

mi = mitsuba()

SCENE = """<scene version="3.0.0">
  <default name="sigma_t" value="0.1"/>
  <medium type="homogeneous" id="fog">
    <float name="sigma_t" value="$sigma_t"/>
    <rgb name="albedo" value="0.9, 0.8, 0.7"/>
    {phase}
  </medium>
  <sensor type="perspective">
    {camera}
    <film type="hdrfilm"><integer name="width" value="{width}"/><integer name="height" value="{height}"/></film>
    <ref id="fog"/>
  </sensor>
  {emitter}
  {shape}
</scene>"""
DEFAULTS = {
    "phase": "<phase type='isotropic'/>",
    "camera": "<float name='fov' value='45'/>",
    "width": 16,
    "height": 8,
    "emitter": "<emitter type='point'/>",
    "shape": "",
}
CORNERS = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], np.float32)
SIDES = np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]], np.uint32)


def written(folder: Path, **parts: object) -> Path:
    path = folder / "scene.xml"
    path.write_text(SCENE.format(**DEFAULTS | parts), encoding="utf-8")
    return path


def made_by_mitsuba(path: Path) -> object:
    """The scene by `mi.load_file`, without any of our code."""
    return mi.load_file(str(path), optimize=False)


# --- camera ----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("axis", ["x", "y", "diagonal", "smaller", "larger"])
@pytest.mark.parametrize(("width", "height"), [(16, 16), (24, 10), (7, 33), (1, 1)])
@pytest.mark.parametrize(
    "placed",
    [
        "<float name='fov' value='45'/>",
        """<float name='fov' value='110'/><float name='near_clip' value='0.7'/><float name='far_clip' value='31'/>
           <transform name='to_world'><lookat origin='3, -2, 5' target='0.3, 0.4, 0' up='0.1, 1, 0.2'/></transform>""",
        """<float name='fov' value='9'/>
           <transform name='to_world'>
             <scale x='-1'/><rotate x='0.6' z='0.8' angle='77'/><translate x='-1' y='4' z='2'/>
           </transform>""",
    ],
)
def test_rays_are_mitsubas_own(tmp_path: Path, axis: str, width: int, height: int, placed: str) -> None:
    path = written(tmp_path, camera=f"{placed}<string name='fov_axis' value='{axis}'/>", width=width, height=height)
    origin, direction, t_max = load(path).camera.rays()
    pixel = dr.arange(mi.UInt32, width * height)
    centre = mi.Point2f((pixel % width + 0.5) / width, (pixel // width + 0.5) / height)
    ray = made_by_mitsuba(path).sensors()[0].sample_ray(0.0, 0.0, centre, mi.Point2f(0.5))[0]
    # measured: 3.7e-7, 8.4e-7 and 3.1e-7 at the most; Mitsuba computes in float32
    np.testing.assert_allclose(direction.reshape(-1, 3), np.array(ray.d).T, atol=1e-6)
    np.testing.assert_allclose(origin.reshape(-1, 3), np.array(ray.o).T, atol=2e-6)
    np.testing.assert_allclose(t_max.ravel(), np.array(ray.maxt), rtol=2e-6)


def test_a_size_that_is_asked_for_replaces_the_films(tmp_path: Path) -> None:
    scene = load(written(tmp_path), size=(20, 30))
    assert (scene.camera.width, scene.camera.height) == (20, 30)
    assert instantiate(scene).sensor.film().size().numpy().tolist() == [20, 30]


# --- medium, phase function, lights, reflectance ---------------------------------------------------------------------


def held_by_mitsuba(path: Path) -> dict[str, np.ndarray]:
    """Mitsuba's parameters by the end of their key, which is all that tells a nameless plugin's."""
    held = mi.traverse(made_by_mitsuba(path))
    keys = [key for key in held.keys() if "." in key and not key.endswith("to_world")]  # noqa: SIM118
    return {key.split(".", 1)[-1]: np.array(held[key], np.float64) for key in keys}


def test_medium_and_reflectance_are_mitsubas(tmp_path: Path) -> None:
    shape = """<shape type='cube'><bsdf type='twosided'>
      <bsdf type='diffuse'><rgb name='reflectance' value='0.2, 0.3, 0.4'/></bsdf></bsdf></shape>"""
    path = written(tmp_path, shape=shape, phase="<phase type='hg'><float name='g' value='-0.3'/></phase>")
    scene, held = load(path), held_by_mitsuba(path)
    np.testing.assert_allclose(scene.medium.sigma_t, np.full(3, held["sigma_t.value.value"].item()), rtol=1e-6)
    np.testing.assert_allclose(scene.medium.albedo, held["albedo.value.value"].ravel(), rtol=1e-6)
    assert scene.phase.mean_cosine == pytest.approx(held["phase_function.g"].item(), rel=1e-6)
    (reflectance,) = (value for key, value in held.items() if key.endswith("reflectance.value"))
    np.testing.assert_allclose(scene.meshes[0].material.diffuse, reflectance.ravel(), rtol=1e-6)
    assert scene.meshes[0].material.two_sided


def test_what_a_scene_leaves_out_is_mitsubas_default(tmp_path: Path) -> None:
    path = tmp_path / "scene.xml"
    path.write_text(
        """<scene version='3.0.0'><sensor type='perspective'><float name='fov' value='50'/><film type='hdrfilm'/>
           <medium type='homogeneous'/></sensor>
           <emitter type='spot'/><shape type='cube'/></scene>"""
    )
    scene, held = load(path), held_by_mitsuba(path)
    assert [scene.camera.width, scene.camera.height] == held["film.size"].tolist()
    assert [scene.camera.near, scene.camera.far] == pytest.approx([held["near_clip"].item(), held["far_clip"].item()])
    medium = made_by_mitsuba(path).sensors()[0].get_medium()
    sigma_s, _, sigma_t = medium.get_scattering_coefficients(dr.zeros(mi.MediumInteraction3f))
    np.testing.assert_allclose(scene.medium.sigma_t, np.array(sigma_t).ravel(), rtol=1e-6)
    np.testing.assert_allclose(scene.medium.sigma_s, np.array(sigma_s).ravel(), rtol=1e-6)
    light = scene.lights[0]
    assert np.degrees(light.cutoff_angle) == pytest.approx(held["cutoff_angle"].item())
    assert np.degrees(light.beam_width) == pytest.approx(held["beam_width"].item())
    np.testing.assert_allclose(light.intensity, np.broadcast_to(held["intensity.value"].ravel(), 3))
    np.testing.assert_allclose(
        scene.meshes[0].material.diffuse, np.full(3, held["bsdf.reflectance.value"].item()), rtol=1e-6
    )
    assert not scene.meshes[0].material.two_sided


@pytest.mark.parametrize("value", ["<float name='{}' value='0.3'/>", "<rgb name='{}' value='0.1, 0.2, 0.3'/>"])
@pytest.mark.parametrize(
    "position",
    [
        "<point name='position' x='1' y='2' z='3'/>",
        "<transform name='to_world'><scale value='2'/><translate x='4' y='-1'/></transform>",
    ],
)
def test_a_point_light_is_mitsubas(tmp_path: Path, value: str, position: str) -> None:
    path = written(tmp_path, emitter=f"<emitter type='point'>{value.format('intensity')}{position}</emitter>")
    check_light(load(path), made_by_mitsuba(path))


@pytest.mark.parametrize("angles", [(20, 15), (24, 24), (80, 0), (89, 88)])
@pytest.mark.parametrize("first", ["", "<scale value='3'/>", "<scale z='-1'/>"])
def test_a_spot_light_is_mitsubas(tmp_path: Path, angles: tuple[int, int], first: str) -> None:
    path = written(
        tmp_path,
        emitter=f"""<emitter type='spot'><rgb name='intensity' value='1, 2, 3'/>
          <float name='cutoff_angle' value='{angles[0]}'/><float name='beam_width' value='{angles[1]}'/>
          <transform name='to_world'>{first}<lookat origin='1, 2, 0' target='0, 0, 1' up='0, 0, 1'/></transform>
          </emitter>""",
    )
    check_light(load(path), made_by_mitsuba(path))


def check_light(scene: Scene, theirs: object) -> None:
    """Intensity towards random points, by our numbers and Mitsuba's emitter."""
    (light,) = scene.lights
    target = np.random.default_rng(1).uniform(-4, 4, (400, 3))
    away = target - light.position
    distance = np.linalg.norm(away, axis=1)
    angle = np.arccos(np.clip(away @ light.direction / distance, -1, 1))
    edge = max(light.cutoff_angle - light.beam_width, 1e-9)
    falloff = np.ones(400) if light.kind == "point" else np.clip((light.cutoff_angle - angle) / edge, 0, 1)
    point = dr.zeros(mi.Interaction3f, 400)
    point.p = mi.Point3f(target.T)
    sample, weight = theirs.emitters()[0].sample_direction(point, mi.Point2f(0.5), True)
    np.testing.assert_allclose(np.array(sample.dist), distance, rtol=1e-6)
    found = np.array(weight).T * distance[:, None] ** 2
    # measured: 4.0e-7 for a point and 3.4e-6 for these spots; on the rim itself float32 decides between light and dark
    away_from_rim = np.abs(angle - light.cutoff_angle) >= 1e-4
    expected = falloff[:, None] * light.intensity
    assert np.abs(found - expected)[away_from_rim].max() < 1e-5 * light.intensity.max()
    assert 0 < np.count_nonzero(falloff) <= 400


@pytest.mark.parametrize("xml", ["<float name='{}' value='0.3'/>", "<spectrum name='{}' value='0.3'/>"])
def test_grey_reflectances_and_coefficients(tmp_path: Path, xml: str) -> None:
    path = written(
        tmp_path, shape=f"<shape type='cube'><bsdf type='diffuse'>{xml.format('reflectance')}</bsdf></shape>"
    )
    path.write_text(path.read_text().replace('<float name="sigma_t" value="$sigma_t"/>', xml.format("sigma_t")))
    path.write_text(path.read_text().replace('<default name="sigma_t" value="0.1"/>', ""))
    scene, held = load(path), held_by_mitsuba(path)
    np.testing.assert_allclose(scene.meshes[0].material.diffuse, 0.3)
    np.testing.assert_allclose(scene.medium.sigma_t, 0.3)
    assert held["bsdf.reflectance.value"].item() == pytest.approx(0.3)
    assert held["sigma_t.value.value"].item() == pytest.approx(0.3)


def test_names_of_nested_plugins_have_no_bearing(tmp_path: Path) -> None:
    """Exporters write them: <film name="film">, <bsdf name="bsdf">."""
    plain = written(tmp_path, shape="<shape type='cube'><bsdf type='diffuse'/></shape>").read_text()
    named = plain
    for kind in ("film", "bsdf", "shape", "phase", "emitter"):
        assert named.count(f"<{kind} type=") == 1
        named = named.replace(f"<{kind} type=", f"<{kind} name='my_{kind}' type=")
    path = tmp_path / "named.xml"
    path.write_text(named)
    scene = load(path)
    assert (len(scene.lights), len(scene.meshes), scene.camera.width) == (1, 1, 16)
    instantiate(scene)


# --- shapes ----------------------------------------------------------------------------------------------------------

SPHERE = "<point name='center' x='0.3' y='0.2' z='-0.1'/><float name='radius' value='0.7'/>"
CYLINDER = (
    "<point name='p0' x='0.1' y='0' z='0.2'/><point name='p1' x='0.5' y='0.9' z='0'/><float name='radius' value='0.4'/>"
)
FLAT = "<boolean name='face_normals' value='true'/>"
EVEN = {
    "as it is": "",
    "turned and scaled": "<rotate x='0.6' z='0.8' angle='50'/><scale value='1.7'/><translate x='0.4' y='-0.2'/>",
    "mirrored": "<scale x='-1'/><rotate y='1' angle='30'/>",
    "inverted": "<scale value='-2'/><rotate x='0.6' z='0.8' angle='50'/>",
}
UNEVEN = {
    "stretched": "<scale x='1' y='2' z='0.5'/><rotate y='1' angle='30'/>",
    "sheared": "<matrix value='1 0.4 0 0.1 0 1 0.2 0 0 0 1 0 0 0 0 1'/>",
}
SHAPES = [
    *[(shape, placed) for shape in (("sphere", SPHERE), ("cylinder", CYLINDER)) for placed in EVEN.values()],
    *[
        (shape, placed)
        for shape in (
            ("rectangle", ""),
            ("cube", ""),
            ("disk", ""),
            ("ply", "<string name='filename' value='bare.ply'/>"),
            ("ply", "<string name='filename' value='smooth.ply'/>"),
            ("ply", f"<string name='filename' value='smooth.ply'/>{FLAT}"),
            ("obj", "<string name='filename' value='bare.obj'/>"),
            ("obj", "<string name='filename' value='smooth.obj'/>"),
            ("obj", f"<string name='filename' value='bare.obj'/>{FLAT}"),
        )
        for placed in (EVEN | UNEVEN).values()
    ],
]


@pytest.fixture
def mesh_folder(tmp_path: Path) -> Path:
    """A tetrahedron in both formats, with normals and without."""
    (tmp_path / "bare.ply").write_bytes(ply_bytes(Triangles(CORNERS, SIDES)))
    (tmp_path / "smooth.ply").write_bytes(ply_bytes(Triangles(CORNERS, SIDES, CORNERS - np.float32(0.25))))
    lines = [f"v {x} {y} {z}" for x, y, z in CORNERS]
    bare = lines + ["f " + " ".join(str(i + 1) for i in side) for side in SIDES]
    normals = [f"vn {x} {y} {z}" for x, y, z in CORNERS - 0.25]
    smooth = lines + normals + ["f " + " ".join(f"{i + 1}//{i + 1}" for i in side) for side in SIDES]
    (tmp_path / "bare.obj").write_text("\n".join(bare))
    (tmp_path / "smooth.obj").write_text("\n".join(smooth))
    return tmp_path


def on_the_mesh(mesh: Mesh, count: int = 200) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Random points of a mesh, off its edges: position, normal of the face, shading normal, (count, 3) each."""
    rng = np.random.default_rng(3)
    faces = mesh.faces[rng.integers(len(mesh.faces), size=count)]
    weights = 0.05 + 0.85 * rng.dirichlet([1, 1, 1], count)
    corners = mesh.vertices[faces].astype(np.float64)
    geometric = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    geometric /= np.linalg.norm(geometric, axis=1, keepdims=True)
    shading = geometric if mesh.normals is None else np.einsum("ij,ijk->ik", weights, mesh.normals[faces])
    return (
        np.einsum("ij,ijk->ik", weights, corners),
        geometric,
        shading / np.linalg.norm(shading, axis=1, keepdims=True),
    )


@pytest.mark.parametrize("flip", ["false", "true"])
@pytest.mark.parametrize(("shape", "placed"), SHAPES)
def test_a_shape_lies_where_mitsubas_rays_meet_it(
    mesh_folder: Path, shape: tuple[str, str], placed: str, flip: str
) -> None:
    plugin, inner = shape
    path = written(
        mesh_folder,
        shape=f"<shape type='{plugin}'>{inner}<boolean name='flip_normals' value='{flip}'/>"
        f"<transform name='to_world'>{placed}</transform></shape>",
    )
    position, geometric, shading = on_the_mesh(load(path).meshes[0])
    theirs = made_by_mitsuba(path)
    # from both sides: a ray from inside a thin corner would meet another face first, so it starts close by
    for side in (-1, 1):
        ray = mi.Ray3f(mi.Point3f((position + side * 2e-3 * geometric).T), mi.Vector3f((-side * geometric).T))
        si = theirs.ray_intersect(ray)
        assert dr.all(si.is_valid())
        # measured: 9.1e-5 on a sphere of radius 1.4 and 5.8e-5 on a tube of 0.8, their chord error; 1.1e-6 elsewhere
        assert np.abs(np.array(si.p).T - position).max() < (1.1e-4 if plugin in ("sphere", "cylinder") else 3e-6)
        # measured: 1.0e-6
        assert np.abs(np.array(si.sh_frame.n).T - shading).max() < 5e-6


def test_a_tessellated_sphere_keeps_its_chord_error(tmp_path: Path) -> None:
    path = written(tmp_path, shape=f"<shape type='sphere'>{SPHERE}</shape>")
    position, _, _ = on_the_mesh(load(path).meshes[0], 2000)
    radius = np.linalg.norm(position - [0.3, 0.2, -0.1], axis=1)
    # DESIGN.md, section 2
    assert np.abs(radius / 0.7 - 1).max() < 1e-4


def test_shapes_without_an_id_get_a_name_of_their_own(tmp_path: Path) -> None:
    path = written(tmp_path, shape="<shape type='cube'/><shape type='disk' id='plate'/><shape type='cube'/>")
    names = [mesh.name for mesh in load(path).meshes]
    assert names[1] == "plate"
    assert len(set(names)) == 3


# --- parameters and the digest ---------------------------------------------------------------------------------------


def test_parameters_change_what_they_name() -> None:
    plain, changed = load("empty"), load("empty", sigma_t=0.3, albedo=0.5, intensity=7, phase="hg", g=-0.2)
    np.testing.assert_allclose(plain.medium.sigma_t, 0.1)
    np.testing.assert_allclose(changed.medium.sigma_t, 0.3)
    np.testing.assert_allclose(changed.medium.sigma_s, 0.15)
    np.testing.assert_allclose(changed.lights[0].intensity, 7)
    assert (plain.phase.name, changed.phase.name, changed.phase.mean_cosine) == ("isotropic", "hg", -0.2)
    assert changed.parameters == {"sigma_t": "0.3", "albedo": "0.5", "intensity": "7", "phase": "hg", "g": "-0.2"}


def test_a_scene_is_found_by_name_with_and_without_its_ending() -> None:
    assert load("sphere").path == load("sphere.xml").path == FOLDER / "sphere.xml"


def test_a_path_may_hold_any_letters(tmp_path: Path) -> None:
    folder = tmp_path / "Nébel 雾"
    folder.mkdir()
    assert load(written(folder)).name == "scene"


def test_the_digest_tells_scenes_apart(tmp_path: Path) -> None:
    path = written(tmp_path)
    same = [load(path).digest, load(path).digest, load(path, size=(16, 8)).digest, load(path, sigma_t=0.1).digest]
    assert len(set(same)) == 1
    others = [load(path, sigma_t=0.2).digest, load(path, size=(16, 9)).digest, load(path, size=(17, 8)).digest]
    path.write_text(path.read_text().replace("0.9, 0.8, 0.7", "0.9, 0.8, 0.71"))
    assert len({*same, *others, load(path).digest}) == 5


def test_the_digest_goes_by_a_meshs_content_not_its_folder(mesh_folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    scene = mesh_folder / "scene"
    scene.mkdir()
    path = written(scene, shape="<shape type='ply'><string name='filename' value='thing.ply'/></shape>")
    digests = []
    for folder, mesh in (("one", "bare"), ("a & <b>", "bare"), ('"three"', "smooth")):
        (mesh_folder / folder).mkdir()
        (mesh_folder / folder / "thing.ply").write_bytes((mesh_folder / f"{mesh}.ply").read_bytes())
        monkeypatch.setenv("AIRLIGHT_MESH_DIR", str(mesh_folder / folder))
        digests.append(load(path).digest)
    assert digests[0] == digests[1] != digests[2]


# --- shipped scenes --------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("name", "phase"), [*((name, "isotropic") for name in shipped()), ("empty", "rayleigh"), ("sphere", "hg")]
)
def test_a_shipped_scene_is_mitsubas_as_it_stands(name: str, phase: str) -> None:
    """`mi.load_file` and `mi.render` take the unchanged file; only the meshes' folder is made known."""
    scene = load(name, size=(16, 16), phase=phase)
    for mesh in scene.meshes:
        if mesh.file:
            mi.file_resolver().append(os.path.dirname(mesh.file.path))
    theirs = mi.load_file(str(scene.path), optimize=False, phase=phase)
    assert [len(theirs.shapes()), len(theirs.emitters())] == [len(scene.meshes), len(scene.lights)]
    sensor = theirs.sensors()[0]
    held = mi.traverse(sensor)
    held["film.size"] = mi.ScalarVector2u(16, 16)
    held.update()
    image = np.array(mi.render(theirs, sensor=sensor, spp=4))[..., :3]
    assert image.shape == (16, 16, 3)
    assert np.isfinite(image).all()
    assert image.mean() > 0
