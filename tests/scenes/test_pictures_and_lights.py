"""Pictures, directional lights, lenses, instances, near planes and search paths, as loaded, against Mitsuba's own."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from slab import VIEWS, slab_scene

from reference.integrator import dr, mi
from reference.mitsuba_scene import instantiate
from scenes.errors import InputError
from scenes.loader import load
from scenes.media import PHASES
from scenes.model import Scene

CAMERA = """<sensor type='perspective'>{lens}<film type='hdrfilm'><integer name='width' value='30'/>
  <integer name='height' value='20'/></film><ref id='fog'/>
  <transform name='to_world'><lookat origin='1, 2, 5' target='0, 0, 0' up='0, 1, 0'/></transform></sensor>"""
FOV = "<float name='fov' value='45'/>"
LAMP = "<emitter type='point'/>"


def written(folder: Path, body: str, lens: str = FOV, light: str = LAMP, name: str = "scene.xml") -> Path:
    path = folder / name
    path.write_text(
        f"<scene version='3.0.0'><medium type='homogeneous' id='fog'/>{CAMERA.format(lens=lens)}{light}{body}</scene>"
    )
    return path


@pytest.mark.parametrize("lens", ["50mm", "35", "24mm"])
def test_a_lens_sees_what_mitsubas_sees(lens: str, tmp_path: Path) -> None:
    scene = load(written(tmp_path, "", lens=f"<string name='focal_length' value='{lens}'/>"))
    x_fov = mi.traverse(instantiate(scene).sensor)["x_fov"]
    assert np.degrees(2 * np.arctan(scene.camera.tan_half_x)) == pytest.approx(np.array(x_fov).item(), rel=1e-6)


def test_a_directional_light_travels_as_mitsubas(tmp_path: Path) -> None:
    scene = slab_scene(tmp_path, VIEWS["from above"], direction="0.6, -1, -0.3")
    (light,) = scene.lights
    (emitter,) = instantiate(scene).scene.emitters()
    ds, weight = emitter.sample_direction(dr.zeros(mi.Interaction3f), mi.Point2f(0.5), True)
    assert light.direction == pytest.approx(-np.array(ds.d).ravel(), abs=1e-6)
    assert light.intensity == pytest.approx(np.array(weight).ravel(), rel=1e-6)
    assert np.linalg.det(light.to_world[:3, :3]) == pytest.approx(1)


@pytest.mark.parametrize("plugin", sorted(PHASES.keys() - {"tabphase"}))
def test_a_phase_function_that_is_told_nothing_is_mitsubas(plugin: str, tmp_path: Path) -> None:
    path = written(tmp_path, "")
    path.write_text(path.read_text().replace("id='fog'/>", f"id='fog'><phase type='{plugin}'/></medium>", 1))
    scene = load(path)
    cosine = np.linspace(-1, 1, 9)
    mei = dr.zeros(mi.MediumInteraction3f, 9)
    mei.wi = mi.Vector3f(0, 0, -1)
    mei.sh_frame = mi.Frame3f(mei.wi)
    wo = mi.Vector3f(np.stack([np.sqrt(1 - cosine**2), np.zeros(9), cosine]).astype(np.float32))
    held = instantiate(scene).medium.phase_function().eval_pdf(mi.PhaseFunctionContext(None), mei, wo)[1]
    np.testing.assert_allclose(np.broadcast_to(np.array(held), 9), scene.phase.evaluate(cosine), rtol=1e-5)


def test_a_phong_surface_that_is_told_nothing_is_the_plugins(tmp_path: Path) -> None:
    scene = load(written(tmp_path, "<shape type='cube' id='box'><bsdf type='phong'/></shape>"))
    held = mi.traverse(instantiate(scene).scene)
    material = scene.meshes[0].material
    assert material.diffuse == pytest.approx(np.full(3, float(held["box.bsdf.diffuse_reflectance.value"][0])))
    assert material.specular == pytest.approx(np.full(3, float(held["box.bsdf.specular_reflectance.value"][0])))
    assert material.exponent == pytest.approx(float(held["box.bsdf.exponent"][0]))


def picture(folder: Path, linear: bool) -> str:
    rng = np.random.default_rng(4)
    if linear:
        mi.Bitmap(rng.random((5, 7, 3)).astype(np.float32)).write(str(folder / "picture.exr"))
        return "picture.exr"
    mi.Bitmap((255 * rng.random((5, 7, 3))).astype(np.uint8)).write(str(folder / "picture.png"))
    return "picture.png"


@pytest.mark.parametrize("linear", [True, False], ids=["exr", "png"])
@pytest.mark.parametrize("raw", [True, False], ids=["raw", "colour"])
def test_pixels_are_mitsubas(linear: bool, raw: bool, tmp_path: Path) -> None:
    texture = f"""<texture type='bitmap' name='reflectance'>
      <string name='filename' value='{picture(tmp_path, linear)}'/><boolean name='raw' value='{str(raw).lower()}'/>
      <transform name='to_uv'><rotate z='1' angle='30'/><scale x='2' y='3'/><translate x='0.1'/></transform>
      </texture>"""
    scene = load(written(tmp_path, f"<shape type='cube' id='box'><bsdf type='diffuse'>{texture}</bsdf></shape>"))
    loaded = scene.meshes[0].material.diffuse
    held = mi.traverse(instantiate(scene).scene)
    data, to_uv = (held[f"box.bsdf.reflectance.{name}"] for name in ("data", "to_uv"))
    stored = np.array(data, np.float64).reshape(5, 7, 3)
    if np.array(data).dtype == np.uint8:
        # 8 bits stay 8 bits in Mitsuba, and are turned into numbers as they are looked up
        stored = stored / 255
        stored = stored if raw else np.where(stored <= 0.04045, stored / 12.92, ((stored + 0.055) / 1.055) ** 2.4)
    np.testing.assert_allclose(loaded.pixels, stored, atol=1e-6)
    np.testing.assert_allclose(loaded.to_uv, np.array(to_uv.matrix).reshape(3, 3)[:2], atol=1e-6)


def ball(folder: Path, radius: float) -> None:
    """A folder `models` with a PLY, seen through <path>."""
    (folder / "models").mkdir(parents=True)
    corners = radius * np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], np.float32)
    mi_mesh = mi.Mesh("m", 4, 4)
    held = mi.traverse(mi_mesh)
    held["vertex_positions"] = corners.ravel()
    held["faces"] = np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]], np.uint32).ravel()
    held.update()
    mi_mesh.write_ply(str(folder / "models" / "thing.ply"))


def test_path_elements_serve_their_own_scene_alone(tmp_path: Path) -> None:
    shape = "<path value='models'/><shape type='ply'><string name='filename' value='thing.ply'/></shape>"
    scenes: list[Scene] = []
    for name, radius in (("a", 1.0), ("b", 2.0)):
        ball(tmp_path / name, radius)
        scenes.append(load(written(tmp_path / name, shape)))
    before = [str(folder) for folder in mi.file_resolver()]
    scenes.append(load(tmp_path / "a" / "scene.xml"))
    assert [float(scene.meshes[0].vertices.max()) for scene in scenes] == [1, 2, 1]
    assert [str(folder) for folder in mi.file_resolver()] == before
    assert scenes[0].digest == scenes[2].digest != scenes[1].digest


def test_instances_lie_where_mitsuba_has_them(tmp_path: Path) -> None:
    body = """<shape type='shapegroup' id='g'>
        <shape type='cube' id='one'>
          <transform name='to_world'><scale value='0.3'/><translate x='0.2'/></transform></shape>
        <shape type='sphere'><point name='center' x='0' y='0.5' z='0'/><float name='radius' value='0.2'/></shape>
        </shape>
      <shape type='instance' id='i'><ref id='g'/><transform name='to_world'><rotate z='1' angle='30'/><scale x='-1'/>
        </transform></shape>
      <shape type='instance' id='j'><transform name='to_world'><translate z='1'/></transform><ref id='g'/></shape>"""
    scene = load(written(tmp_path, body))
    assert [mesh.name for mesh in scene.meshes] == ["i.one", "i.member_1", "j.one", "j.member_1"]
    box = instantiate(scene).scene.bbox()
    vertices = np.concatenate([mesh.vertices for mesh in scene.meshes])
    # Embree's boxes of instances are boxes of boxes: not smaller, and by no more than a turned cube's
    assert (vertices.min(0) >= np.array(box.min).ravel() - 1e-4).all()
    assert (vertices.max(0) <= np.array(box.max).ravel() + 1e-4).all()
    for mesh in scene.meshes:
        # turned over with the mirror: the corners still run counter-clockwise seen from where the normals point
        a, b, c = (mesh.vertices[mesh.faces[:, k]].astype(np.float64) for k in range(3))
        outward = (np.cross(b - a, c - a) * mesh.normals[mesh.faces[:, 0]]).sum(-1)
        assert (outward > 0).all()


def hazy_box(folder: Path, corner: str, inside: bool) -> Path:
    """A camera at the origin that looks along -z, its near plane's corners at (+-1, +-1, -1), and a box of fog."""
    path = folder / "scene.xml"
    path.write_text(
        f"""<scene version='3.0.0'><medium type='homogeneous' id='fog'/>
          <shape type='cube'><bsdf type='null'/><ref name='interior' id='fog'/>{corner}</shape>{LAMP}
          <sensor type='perspective'><float name='fov' value='90'/><float name='near_clip' value='1'/>
            <transform name='to_world'><lookat origin='0, 0, 0' target='0, 0, -1' up='0, 1, 0'/></transform>
            <film type='hdrfilm'><integer name='width' value='4'/><integer name='height' value='4'/></film>
            {"<ref id='fog'/>" * inside}</sensor></scene>"""
    )
    return path


@pytest.mark.parametrize("x", [-1, 1])
@pytest.mark.parametrize("y", [-1, 1])
def test_each_corner_of_the_near_plane_counts(x: int, y: int, tmp_path: Path) -> None:
    # boxes of half-width 0.3 at the corner, and just beyond it
    box = "<transform name='to_world'><scale value='0.3'/><translate x='{}' y='{}' z='-1'/></transform>"
    with pytest.raises(InputError, match="near plane that cuts the shape"):
        load(hazy_box(tmp_path, box.format(1.2 * x, 1.2 * y), inside=False))
    assert load(hazy_box(tmp_path, box.format(1.4 * x, 1.2 * y), inside=False)).boundary is not None
    # a box that holds all of the near plane, and one that leaves one corner out
    large = """<transform name='to_world'><scale value='2'/><rotate z='1' angle='45'/><translate x='{}' y='{}'/>
        </transform>"""
    assert load(hazy_box(tmp_path, large.format(0, 0), inside=True)).boundary is not None
    with pytest.raises(InputError, match="near plane that cuts the shape"):
        load(hazy_box(tmp_path, large.format(-0.8 * x, -0.8 * y), inside=True))
