"""What once ended otherwise than in a picture or a sentence, or in another mesh than Mitsuba's."""

from __future__ import annotations

import struct
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from gpu_impl.renderer import Renderer
from gpu_impl.techniques import find_technique
from reference.mitsuba_scene import instantiate
from scenes.errors import InputError
from scenes.loader import load
from scenes.meshes.readers import read_mesh
from scenes.mitsuba_setup import mitsuba

SCENE = """<scene version="3.0.0">
<medium type="homogeneous" id="fog"><float name="sigma_t" value="0.1"/></medium>
<sensor type="perspective">{sensor}{film}<ref id="fog"/>
<transform name="to_world"><lookat origin="0, 1, 8" target="0, 0, 0" up="0, 1, 0"/></transform></sensor>
<emitter type="point"><point name="position" x="0" y="3" z="0"/></emitter>{shape}
</scene>"""
SCENES: dict[str, dict[str, str]] = {
    "an axis that is a colour": {"sensor": '<float name="fov" value="9"/><rgb name="fov_axis" value="1, 1, 1"/>'},
    "an axis that is a number": {"sensor": '<float name="fov" value="9"/><float name="fov_axis" value="1"/>'},
    "a lens that is a number": {"sensor": '<float name="focal_length" value="50"/>'},
    "a group of nothing": {"shape": '<shape type="shapegroup" id="g"/>'},
    "an instance of nothing": {
        "shape": '<shape type="shapegroup" id="g"/><shape type="instance"><ref id="g"/></shape>',
    },
    "an integrator that is a mesh": {
        "shape": '<integrator type="ply"><string name="filename" value="none.ply"/></integrator>',
    },
    "a film in a sampler": {"sensor": '<sampler type="independent"><film type="hdrfilm"/></sampler>'},
}
# Mitsuba ends the process when it makes this
DEADLY = {"film": '<film type="hdrfilm"><rfilter type="box"><sensor type="blendbsdf"/></rfilter></film>'}
MAKE = "from reference.mitsuba_scene import instantiate as i; from scenes.loader import load; i(load({}))"


def scene_file(folder: Path, parts: dict[str, str]) -> Path:
    path = folder / "scene.xml"
    usual = {"sensor": '<float name="fov" value="45"/>', "film": '<film type="hdrfilm"/>', "shape": ""}
    path.write_text(SCENE.format(**usual | parts))
    return path


@pytest.mark.parametrize("case", SCENES)
def test_a_scene_ends_in_a_picture_or_in_one_sentence(tmp_path: Path, case: str) -> None:
    path = scene_file(tmp_path, SCENES[case])
    try:
        scene = load(path, size=(8, 6))
    except InputError as error:
        sentence = str(error)
        assert f"{path} (line " in sentence
        assert sentence.isprintable()
        assert sentence.endswith(".")
        return
    with Renderer(scene) as renderer:
        assert renderer.render(find_technique("lit_intervals+quadrature", steps=8)).composite.max() > 0
    instantiate(scene)


def test_the_scene_around_those_is_good(tmp_path: Path) -> None:
    assert load(scene_file(tmp_path, {}), size=(8, 6)).camera.width == 8


def test_a_filter_that_holds_a_sensor_is_not_made(tmp_path: Path) -> None:
    path = scene_file(tmp_path, DEADLY)
    assert load(path, size=(8, 6)).camera.width == 8
    done = subprocess.run([sys.executable, "-c", MAKE.format(repr(str(path)))], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr


OBJ = "v 0 1 0\nv -1 0 1\nv 1 0 1\nv 5 5 5\nf 1 2 3\n"
PLY = (
    "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
    "property {}\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n"
    "0 1 0 {}\n-1 0 1 2\n1 0 1 2\n{}\n"
)
LITTLE = PLY.format("int n", 2, "")[: PLY.format("int n", 2, "").index("0 1 0")].replace(
    "ascii", "binary_little_endian"
)
ROWS = struct.pack("<3fi3fi3fi", 0, 1, 0, 2, -1, 0, 1, 2, 1, 0, 1, 2) + struct.pack("<B3i", 3, 0, 1, 2)

FOUND: dict[str, tuple[str, bytes]] = {
    "a lone carriage return between lines": ("obj", OBJ.replace("0 1 0\n", "0 1 0\r").encode()),
    "a lone carriage return in a face": ("obj", OBJ.replace("2 3", "2\r3").encode()),
    "a form feed in a face": ("obj", OBJ.replace("f 1 2 3", "f 1\f2 3 4").encode()),
    "a zero byte": ("obj", OBJ.replace("0 1 0\n", "0 1 0\0\n").encode()),
    "an underscore in a coordinate": ("obj", OBJ.replace("5 5 5", "1_0 5 5").encode()),
    "an underscore in an index": ("obj", OBJ.replace("f 1", "f 0_1").encode()),
    "a comment behind a face": ("obj", OBJ.replace("2 3\n", "2 3 # 4\n").encode()),
    "a comment as long as may be": ("obj", f"#{'.' * 1022}\n{OBJ}".encode()),
    "a comment that is too long": ("obj", f"#{'.' * 1023}\n{OBJ}".encode()),
    "a line of Windows that ends the file": ("obj", OBJ.replace("\n", "\r\n").encode()[:-1]),
    "an underscore in text": ("ply", PLY.format("float n", "1_0", "3 0 1 2").encode()),
    "a fraction as an index": ("ply", PLY.format("float n", "2", "3 0 1.0 2").encode()),
    "a fraction as a whole number": ("ply", PLY.format("char n", "-0.5", "3 0 1 2").encode()),
    "whole numbers where declared": ("ply", PLY.format("int n", "-2", "3 0 +1 2").encode()),
    "two formats": (
        "ply",
        PLY.format("int n", 2, "3 0 1 2").replace("element vertex", "format ascii 1.0\nelement vertex").encode(),
    ),
    "bytes behind the last face": ("ply", LITTLE.encode() + ROWS + b"\n"),
    "no bytes behind the last face": ("ply", LITTLE.encode() + ROWS),
}


@pytest.mark.parametrize("case", FOUND)
def test_a_mesh_is_the_one_that_mitsuba_reads_or_none(tmp_path: Path, case: str) -> None:
    plugin, content = FOUND[case]
    path = tmp_path / f"mesh.{plugin}"
    path.write_bytes(content)
    mi = mitsuba()
    try:
        theirs = mi.traverse(mi.load_dict({"type": plugin, "filename": str(path)}))
    except RuntimeError:
        theirs = None
    try:
        ours = read_mesh(path)
    except InputError:
        return
    assert theirs is not None, "ours reads what Mitsuba refuses"
    np.testing.assert_array_equal(ours.faces.ravel(), np.array(theirs["faces"]))
    np.testing.assert_array_equal(ours.vertices.ravel(), np.array(theirs["vertex_positions"]))


HARMLESS = (
    *("a comment behind a face", "a comment as long as may be", "a line of Windows that ends the file"),
    *("whole numbers where declared", "no bytes behind the last face"),
)


@pytest.mark.parametrize("case", HARMLESS)
def test_the_harmless_ones_are_read(tmp_path: Path, case: str) -> None:
    plugin, content = FOUND[case]
    path = tmp_path / f"mesh.{plugin}"
    path.write_bytes(content)
    assert len(read_mesh(path).faces) == 1
