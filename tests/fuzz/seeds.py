"""Good scenes and meshes that the fuzzer spoils, and the small files that they name."""

from __future__ import annotations

import re
import struct
from pathlib import Path

import numpy as np
from spoilt_scenes import GOOD

from scenes.catalogue import FOLDER, scene_path, shipped
from scenes.meshes.triangles import Triangles, ply_bytes
from scenes.mitsuba_setup import mitsuba

_FOG = """
  <default name="sigma_t" value="0.1"/>
  <default name="albedo" value="0.9"/>
"""
_EYE = """
  <sensor type="perspective" id="eye">
    <float name="fov" value="45"/><string name="fov_axis" value="smaller"/>
    <float name="near_clip" value="0.1"/><float name="far_clip" value="50"/>
    <transform name="to_world"><lookat origin="0, 1, 8" target="0, 0.5, 0" up="0, 1, 0"/></transform>
    <film type="hdrfilm"><integer name="width" value="16"/><integer name="height" value="12"/>
      <rfilter type="box"/></film>
    <sampler type="independent"><integer name="sample_count" value="4"/></sampler>
    {medium}
  </sensor>
"""
# every kind of shape, BSDF and texture of the supported subset
_SHAPES = """
  <bsdf type="diffuse" id="paint"><rgb name="reflectance" value="0.2, 0.3, 0.4"/></bsdf>
  <texture type="bitmap" id="checks"><string name="filename" value="checks.png"/>
    <string name="filter_type" value="nearest"/><string name="wrap_mode" value="mirror"/>
    <transform name="to_uv"><scale x="3" y="2" z="1"/></transform></texture>
  <shape type="rectangle" id="floor">
    <transform name="to_world"><scale value="3"/><rotate x="1" angle="-90"/><translate y="-1"/></transform>
    <bsdf type="diffuse"><ref name="reflectance" id="checks"/></bsdf>
  </shape>
  <shape type="ply" id="box"><string name="filename" value="box.ply"/><boolean name="face_normals" value="true"/>
    <transform name="to_world"><scale value="0.4"/><translate x="-1"/></transform>
    <bsdf type="phong"><rgb name="diffuse_reflectance" value="0.3, 0.1, 0.1"/>
      <float name="specular_reflectance" value="0.4"/><float name="exponent" value="20"/></bsdf>
  </shape>
  <shape type="obj" id="tent"><string name="filename" value="tent.obj"/><boolean name="flip_normals" value="false"/>
    <transform name="to_world"><rotate y="1" angle="30"/><translate x="1"/></transform>
    <bsdf type="twosided"><ref id="paint"/></bsdf>
  </shape>
  <shape type="cube" id="brick"><transform name="to_world"><scale x="0.2" y="0.3" z="-0.2"/></transform></shape>
  <shape type="disk" id="plate"><transform name="to_world"><translate x="0.5" y="1.2"/></transform>
    <ref id="paint"/></shape>
  <shape type="shapegroup" id="group"><shape type="cube"><ref id="paint"/>
    <transform name="to_world"><scale value="0.1"/></transform></shape></shape>
  <shape type="instance"><ref id="group"/><transform name="to_world"><translate x="1.5"/></transform></shape>
  <shape type="instance"><ref id="group"/>
    <transform name="to_world"><matrix value="1 0 0 -1.5 0 1 0.2 0 0 0 1 0 0 0 0 1"/></transform></shape>
"""
_ROUND = """
  <shape type="sphere" id="ball"><point name="center" x="0" y="0.5" z="0"/><float name="radius" value="0.3"/></shape>
  <shape type="cylinder" id="tube"><point name="p0" value="-1, 0, 0"/><point name="p1" x="-1" y="1" z="0"/>
    <float name="radius" value="0.1"/></shape>
"""
_SPOTS = """
  <emitter type="spot"><rgb name="intensity" value="3, 2, 1"/><float name="cutoff_angle" value="40"/>
    <float name="beam_width" value="40"/>
    <texture type="bitmap" name="texture"><string name="filename" value="checks.png"/></texture>
    <transform name="to_world"><lookat origin="1, 3, 1" target="0, 0, 0" up="0, 0, 1"/></transform></emitter>
  <emitter type="spot"><float name="intensity" value="5"/>
    <transform name="to_world"><lookat origin="-1, 3, 0" target="0, 0, 0" up="0, 0, 1"/></transform></emitter>
"""
_POINT = """
  <emitter type="point"><point name="position" x="0.3" y="2.6" z="0"/><rgb name="intensity" value="3, 4, 5"/></emitter>
"""
_PHASES = {
    "tabphase": '<phase type="tabphase"><string name="values" value="0.5, 1, 1.5, 4"/></phase>',
    "schlick": '<phase type="schlick"><float name="k" value="0.4"/></phase>',
    "cornette_shanks": '<phase type="cornette_shanks"><float name="g" value="0.5"/></phase>',
    "included": '<include filename="phase/$phase.xml"/>',
}


def _medium(phase: str) -> str:
    return (
        '<medium type="homogeneous" id="fog"><float name="sigma_t" value="$sigma_t"/><float name="scale" value="1"/>'
        f'<rgb name="albedo" value="$albedo"/>{_PHASES[phase]}</medium>'
    )


def _space(phase: str, shapes: str, lights: str) -> str:
    """Fog that fills space."""
    eye = _EYE.format(medium='<ref id="fog"/>')
    return f'<scene version="3.0.0">{_FOG}{_medium(phase)}{eye}{lights}{shapes}</scene>'


def _bounded(phase: str, shapes: str) -> str:
    """Fog in a cube, under a sun."""
    holder = (
        '<shape type="cube" id="room"><bsdf type="null"/><ref name="interior" id="fog"/>'
        '<transform name="to_world"><scale value="3.5"/><translate y="1"/></transform></shape>'
    )
    sun = (
        '<emitter type="directional"><vector name="direction" x="0.3" y="-1" z="0.2"/>'
        '<rgb name="irradiance" value="1, 0.9, 0.8"/></emitter>'
    )
    eye = _EYE.format(medium="")
    return f'<scene version="3.0.0">{_FOG}{_medium(phase)}{eye}{sun}{_POINT}{holder}{shapes}</scene>'


def scenes() -> dict[str, str]:
    """Texts of good scenes by name."""
    return {
        "good": GOOD,
        "spots": _space("tabphase", _SHAPES, _SPOTS),
        "points": _space("schlick", _SHAPES, _POINT * 2),
        "sun": _bounded("cornette_shanks", _SHAPES),
        "sun and include": _bounded("included", "").replace(_FOG, _FOG + '<default name="phase" value="hg"/>'),
        "round": _space("cornette_shanks", _ROUND, _POINT),
        **{name: scene_path(name).read_text(encoding="utf-8") for name in shipped()},
    }


def plain_scene() -> str:
    """A scene with light and fog, to put a mesh into."""
    return _space("included", "", _POINT).replace(_FOG, _FOG + '<default name="phase" value="isotropic"/>')


def write_files(folder: Path) -> None:
    """Put beside the scenes what they name; every mesh is a box, for the sake of time."""
    (folder / "phase").mkdir(parents=True, exist_ok=True)
    for file in (FOLDER / "phase").glob("*.xml"):
        (folder / "phase" / file.name).write_bytes(file.read_bytes())
    named = {name for text in scenes().values() for name in re.findall(r'"([\w.-]+\.ply)"', text)}
    for name in named:
        (folder / name).write_bytes(ply_bytes(box()))
    (folder / "tent.obj").write_bytes(meshes()["tent.obj"])
    (folder / "empty.xml").write_text('<scene version="3.0.0"/>')
    pixels = np.zeros((4, 4, 3), np.uint8)
    pixels[::2, ::2] = 255
    mitsuba().Bitmap(pixels).write(str(folder / "checks.png"))


def box() -> Triangles:
    """A closed cube of 8 corners, its normals left to who reads it."""
    corners = np.array([(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], np.float32)
    quads = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    faces = [triangle for a, b, c, d in quads for triangle in ((a, b, c), (a, c, d))]
    return Triangles(corners, np.array(faces, np.uint32))


def meshes() -> dict[str, bytes]:
    """Small good mesh files by name, one of each format."""
    cube = box()
    length = np.linalg.norm(cube.vertices, axis=1, keepdims=True)
    full = np.hstack([cube.vertices, cube.vertices / length, cube.vertices[:, :2] / 2 + 0.5])
    header = (
        "ply\nformat {} 1.0\ncomment a box\nelement vertex 8\n"
        + "".join(f"property float {name}\n" for name in ("x", "y", "z", "nx", "ny", "nz", "u", "v"))
        + "element face 12\nproperty list uchar int vertex_indices\nend_header\n"
    )
    rows = [" ".join(f"{value:.6g}" for value in row) for row in full]
    rows += [f"3 {a} {b} {c}" for a, b, c in cube.faces]
    big = np.asarray(full, ">f4").tobytes() + b"".join(struct.pack(">B3i", 3, *face) for face in cube.faces)
    return {
        "ascii.ply": (header.format("ascii") + "\n".join(rows) + "\n").encode(),
        "little.ply": ply_bytes(cube),
        "big.ply": header.format("binary_big_endian").encode() + big,
        "tent.obj": b"# a tent\no tent\ng left\nv 0 1 0\nv -1 0 1\nv 1 0 1\nv 1 0 -1\nv -1 0 -1\nvt 0 0\nvt 1 0\n"
        b"vt 1 1\nvn 0 1 0\nvn 0 0 1\nusemtl cloth\ns off\nf 1/1/1 2/2/1 3/3/2\nf 1/1/1 3/2/1 4/3/2\ng right\n"
        b"f 1/1/1 4/2/1 5/3/2\nf 2/1/2 3/2/2 4/3/2 5/1/2\n",
        "plain.obj": b"v 0 1 0\nv -1 0 1\nv 1 0 1\nv 1 0 -1\nf 1 2 3\nf 1 3 4\n",
        "normals.obj": b"v 0 1 0\nv -1 0 1\nv 1 0 1\nvn 0 0 1\nf 1//1 2//1 3//1\n",
    }
