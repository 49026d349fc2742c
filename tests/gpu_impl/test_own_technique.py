"""Techniques of somebody's own: what they draw, what makes them other techniques, and what is wrong with them."""

from __future__ import annotations

import pickle
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from registries import restored_registries
from scene_files import point, sphere, write_scene

from gpu_impl.airlight_models import AIRLIGHT_MODELS
from gpu_impl.frame import Frame
from gpu_impl.own_technique import OwnTechnique, load_technique, make_known
from gpu_impl.renderer import Renderer
from gpu_impl.shader_source import SHADERS
from gpu_impl.techniques import find_technique
from scenes.errors import InputError
from scenes.model import Scene

TOML = """name = "Mine"
visibility = "march.glsl"
airlight = { file = "parts/haze.glsl", phases = ["isotropic"], any_light = false }

[settings]
steps = 20
"""
MARCH = """#include "shadow_lookup.glsl"
void visibility(Ray ray, Light light) {
    float dt = ray.t_max / float(STEPS);
    for (int i = 0; i < STEPS; ++i)
        if (!in_shadow(light, ray.o + (float(i) + 0.5) * dt * ray.d)) lit(float(i) * dt, dt, 1.0);
}
"""
# a point sample, and a factor from a file beside it
HAZE = """#include "../strength.glsl"
#include "light.glsl"
#include "<phase>"
const bool CLIP_TO_CONE = false;
vec3 airlight(Ray ray, Light light, float t0, float dt) {
    vec3 p = ray.o + (t0 + 0.5 * dt) * ray.d, l = light.position - p;
    float d2 = dot(l, l);
    return STRENGTH * light.intensity * angular(light, p) * sigma_s * phase(vec2(0.5)) * dt / d2
         * exp(-sigma_t * (t0 + 0.5 * dt + sqrt(d2)));
}
"""


@pytest.fixture(autouse=True)
def _registries() -> Iterator[None]:
    with restored_registries():
        yield


@pytest.fixture
def mine(tmp_path: Path) -> Path:
    """A technique whose picture is that of uniform_march+riemann in isotropic fog."""
    (tmp_path / "parts").mkdir()
    (tmp_path / "mine.toml").write_text(TOML)
    (tmp_path / "march.glsl").write_text(MARCH)
    (tmp_path / "parts" / "haze.glsl").write_text(HAZE)
    (tmp_path / "strength.glsl").write_text("#define STRENGTH 1.0\n")
    return tmp_path / "mine.toml"


@pytest.fixture(scope="module")
def scene(tmp_path_factory: pytest.TempPathFactory) -> Scene:
    return write_scene(tmp_path_factory.mktemp("scene"), shapes=sphere(0.2, 0.3, 0, 0.6), size=(40, 24))


def drawn(scene: Scene, technique: str | Path, **settings: object) -> Frame:
    with Renderer(scene) as renderer:
        return renderer.render(find_technique(str(technique), **settings))


def test_it_draws_what_its_files_say(mine: Path, scene: Scene) -> None:
    ours = drawn(scene, "uniform_march+riemann", steps=20)
    frame = drawn(scene, mine)
    # measured: 0, here and below
    np.testing.assert_allclose(frame.scattering, ours.scattering, rtol=2e-6)
    np.testing.assert_array_equal(frame.lit_intervals, ours.lit_intervals)
    assert frame.technique.name == "Mine"
    assert frame.technique.steps == 20
    assert (drawn(scene, mine, steps=40).scattering != frame.scattering).any()
    # one part of it and one of ours
    cell = find_technique(str(mine), airlight="quadrature")
    assert cell.name == f"{frame.technique.visibility}+quadrature"
    np.testing.assert_allclose(
        drawn(scene, cell.name, steps=20).scattering,
        drawn(scene, "uniform_march+quadrature", steps=20).scattering,
        rtol=2e-6,
    )


def test_a_changed_file_is_another_part_in_the_same_process(mine: Path, scene: Scene) -> None:
    before = drawn(scene, mine)
    # of a file that is included
    (mine.parent / "strength.glsl").write_text("#define STRENGTH 3.0\n")
    after = drawn(scene, mine)
    np.testing.assert_allclose(after.scattering, 3 * before.scattering, rtol=2e-6)  # measured: 5.4e-7
    assert after.technique.airlight != before.technique.airlight
    assert after.technique.visibility == before.technique.visibility
    # the one that was read before is still what it was
    with Renderer(scene) as renderer:
        np.testing.assert_array_equal(renderer.render(before.technique).scattering, before.scattering)
    # and one declaration more is another part too
    mine.write_text(TOML.replace(', phases = ["isotropic"]', ""))
    assert load_technique(mine).airlight != after.technique.airlight


def test_a_supply_brings_what_a_registered_part_is_given(mine: Path, scene: Scene, tmp_path: Path) -> None:
    (tmp_path / "between.glsl").write_text((SHADERS / "visibility/lit_intervals.glsl").read_text())
    (tmp_path / "nodes.glsl").write_text((SHADERS / "airlight/quadrature.glsl").read_text())
    mine.write_text(
        'name = "Mine"\nvisibility = { file = "between.glsl", supply = "lit_intervals" }\n'
        'airlight = { file = "nodes.glsl", supply = "quadrature" }\n'
    )
    ours = drawn(scene, "lit_intervals+quadrature", steps=64)
    np.testing.assert_array_equal(drawn(scene, mine, steps=64).scattering, ours.scattering)
    # its polygons are on the image's pixels
    with pytest.raises(InputError, match="lattice epipolar"):
        find_technique(str(mine), lattice="epipolar")


def test_a_lattice_of_ones_own(mine: Path, scene: Scene, tmp_path: Path) -> None:
    (tmp_path / "corner.glsl").write_text(
        "uniform int downsample;\nvec2 position_of(ivec2 cell) { return vec2(cell * downsample) + 0.5; }\n"
    )
    (tmp_path / "blocks.glsl").write_text(
        "uniform sampler2D scattering;\nuniform int downsample;\n"
        "vec4 upsampled(ivec2 pixel) { return texelFetch(scattering, pixel / downsample, 0); }\n"
    )
    mine.write_text(
        TOML.replace('"march.glsl"', '"march.glsl"\nlattice = { file = "corner.glsl", reconstruction = "blocks.glsl" }')
    )
    every = drawn(scene, mine).scattering
    coarse = drawn(scene, mine, downsample=4).scattering
    expected = every[::4, ::4].repeat(4, axis=0).repeat(4, axis=1)
    np.testing.assert_allclose(coarse, expected, rtol=2e-6)  # measured: 0
    assert (coarse != every).mean() > 0.5


def test_it_travels_without_its_files(mine: Path, scene: Scene, tmp_path: Path) -> None:
    frame = drawn(scene, mine)
    np.save(tmp_path / "before.npy", frame.scattering)
    (tmp_path / "technique").write_bytes(pickle.dumps(frame.technique))
    for path in (mine, tmp_path / "march.glsl", tmp_path / "strength.glsl"):
        path.unlink()
    assert pickle.loads((tmp_path / "technique").read_bytes()) == frame.technique
    # in a process that has never seen it
    program = f"""
import pickle, numpy
from pathlib import Path
from gpu_impl.renderer import Renderer
from scenes.loader import load
technique = pickle.loads(Path({str(tmp_path / "technique")!r}).read_bytes())
with Renderer(load({str(scene.path)!r}, size=(40, 24))) as renderer:
    found = renderer.render(technique).scattering
assert technique.name == "Mine" and (found == numpy.load({str(tmp_path / "before.npy")!r})).all()
"""
    subprocess.run([sys.executable, "-c", program], check=True, cwd=Path(__file__).parents[2], timeout=120)


@pytest.mark.parametrize("texts", ["", "[]", "{}", '{"/a.toml": 3}', '{"/a.toml": "name = 3"}'])
def test_texts_of_no_technique_are_refused(texts: str) -> None:
    with pytest.raises((InputError, ValueError)):
        make_known("/a.toml", texts)


def test_what_a_model_does_not_take_is_refused(mine: Path, tmp_path: Path) -> None:
    foggy = write_scene(tmp_path, phase="<phase type='rayleigh'/>", size=(8, 8))
    technique = load_technique(mine)
    assert isinstance(technique, OwnTechnique)
    with pytest.raises(InputError, match=f"{technique.airlight} takes the phase function isotropic"):
        technique.check_scene(foggy)
    assert AIRLIGHT_MODELS[technique.airlight].any_light is False


@pytest.mark.parametrize(
    ("changed", "said"),
    [
        (("steps = 20", "steps = 20.5"), r"mine.toml (line 6): the key 'settings.steps': steps is 20.5; use a whole"),
        (("steps = 20", "step = 20"), r"mine.toml (line 5): the key 'settings': there is no setting 'step'; use steps"),
        (("steps = 20", 'lattice = "grid"'), "there is no setting 'lattice'"),
        (('"march.glsl"', '"marsch"'), "(line 2): the key 'visibility': there is no 'marsch'; use one of unif"),
        (('"isotropic"', '"iso"'), "(line 3): the key 'airlight.phases.0': there is no 'iso'; use one of iso"),
        (("any_light = false", "any_light = 0"), "mine.toml (line 3): the key 'airlight.any_light': Input should be"),
        (("any_light", "light"), "mine.toml (line 3): the key 'airlight.light': Extra inputs are not permitted."),
        (('"march.glsl"', '{ supply = "exact" }'), "mine.toml (line 2): the key 'visibility.file': Field required."),
        (('"march.glsl"', '{ file = "march.glsl", supply = "x" }'), "(line 2): the key 'visibility.supply': there is"),
        (('"Mine"', '"Weng2010"'), "mine.toml (line 1): the key 'name': airlight has a technique Weng2010; call yours"),
        (('"Mine"', '"a+b"'), "mine.toml (line 1): the key 'name': use 1 to 60 letters, digi"),
        (('"Mine"', '"a/b"'), "mine.toml (line 1): the key 'name': use 1 to 60 letters, digits, spaces, points"),
        (('name = "Mine"\n', ""), "mine.toml: the key 'name': Field required."),
        (('name = "Mine"', "name = Mine"), "mine.toml is not TOML: Invalid value (at line 1, column 8)."),
        (('"march.glsl"', '"none.glsl"'), "none.glsl cannot be read (No such file or directory)."),
        (('"march.glsl"', '3'), "mine.toml (line 2): the key 'visibility': give the name of a registered part, or "),
        (('"march.glsl"', '["a.glsl"]'), "mine.toml (line 2): the key 'visibility': give the name of a registered"),
        (("airlight =", "airlihgt ="), "mine.toml (line 3): the key 'airlihgt': Extra inputs are not permitted."),
        (("visibility =", "visbility ="), "mine.toml (line 2): the key 'visbility': Extra inputs are not permitted."),
        (('"march.glsl"', '"march.glsl"\nlattice = "corner.glsl"'), "(line 3): the key 'lattice.reconstruction': Fie"),
    ],
)  # fmt: skip
def test_what_is_wrong_with_the_file_is_said_in_one_sentence(mine: Path, changed: tuple[str, str], said: str) -> None:
    assert changed[0] in TOML
    mine.write_text(TOML.replace(*changed))
    with pytest.raises(InputError) as caught:
        load_technique(mine)
    assert said in str(caught.value)
    assert str(mine.parent) in str(caught.value)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("file", "text", "said"),
    [
        ("march.glsl", MARCH.replace("float dt =", "float dt ="), ""),
        ("march.glsl", MARCH.replace("lit(", "litt("), r"^/.*/march\.glsl:5.*: error: .*litt"),
        ("march.glsl", MARCH.replace("float(STEPS);", "float(STEPS)"), r"^/.*/march\.glsl:4.*: error: .*syntax"),
        ("strength.glsl", "\n\n#define STRENGTH nothing\n", r"^/.*/haze\.glsl:8.*: error: .*"),
        (
            "march.glsl",
            "void visible(Ray ray, Light light) {}\n",
            r"^The shader with .*march\.glsl does not compile: .*visibility",
        ),
    ],
)
def test_a_shader_that_does_not_compile_is_named_with_its_line(
    mine: Path, scene: Scene, file: str, text: str, said: str
) -> None:
    (mine.parent / file).write_text(text)
    if not said:
        assert drawn(scene, mine).scattering.any()
        return
    with pytest.raises(InputError, match=said) as caught:
        drawn(scene, mine)
    assert "\n" not in str(caught.value)


def test_includes_that_cannot_be_are_refused_with_their_line(mine: Path) -> None:
    march = mine.parent / "march.glsl"
    for text, said in (
        ('\n#include "lihgt.glsl"\n', r"march\.glsl:2: there is no lihgt\.glsl, neither beside this file nor among"),
        ('#include "march.glsl"\n', r"march\.glsl:1: march\.glsl includes itself"),
        ('#include "parts/haze.glsl"\n', r"strength\.glsl:1: march\.glsl includes itself"),
    ):
        march.write_text(text)
        if "haze" in text:
            (mine.parent / "strength.glsl").write_text('#include "march.glsl"\n')
        with pytest.raises(InputError, match=said):
            load_technique(mine)
    march.write_bytes(b"\xff\xfe")
    with pytest.raises(InputError, match=r"march\.glsl is not UTF-8"):
        load_technique(mine)


def test_a_file_beside_goes_before_one_of_ours(mine: Path, scene: Scene) -> None:
    before = drawn(scene, mine).scattering
    # the one that both of its parts and the driver include: the technique's is its own
    (mine.parent / "parts" / "light.glsl").write_text(
        '#include "contract.glsl"\nfloat angular(Light a, vec3 b) { return 1.0; }\n'
    )
    with pytest.raises(InputError, match=r"parts/light\.glsl:2.*angular"):
        drawn(scene, mine)
    (mine.parent / "parts" / "light.glsl").unlink()
    np.testing.assert_array_equal(drawn(scene, mine).scattering, before)


def test_an_unknown_name_mentions_files() -> None:
    with pytest.raises(InputError, match="or the path of a TOML file"):
        find_technique("Mine")
    with pytest.raises(InputError, match=r"none\.toml cannot be read"):
        find_technique("none.toml")


def test_a_point_light_alone(mine: Path, tmp_path: Path) -> None:
    """Twice the intensity is twice the picture, whoever wrote the GLSL."""
    one, two = (
        write_scene(tmp_path, emitters=point(0.3, 1, 0, f"<float name='intensity' value='{value}'/>"), size=(12, 8))
        for value in (5, 10)
    )
    np.testing.assert_allclose(drawn(two, mine).scattering, 2 * drawn(one, mine).scattering, rtol=1e-6)
