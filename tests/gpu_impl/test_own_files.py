"""Files of somebody's own: which may be taken, and what an include that is not there is said to be."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from registries import restored_registries

from gpu_impl import shader_source
from gpu_impl.own_files import OwnFiles
from gpu_impl.own_technique import OwnTechnique, load_technique, make_known
from gpu_impl.renderer import Renderer
from gpu_impl.shader_source import SHADERS, ShaderError, ShaderSource
from scenes.errors import InputError
from scenes.loader import load

TOML = 'name = "Mine"\nvisibility = "march.glsl"\nairlight = "riemann"\n'
WHOLE = "void visibility(Ray ray, Light light) { lit(0.0, ray.t_max, 1.0); }\n"


@pytest.fixture(autouse=True)
def _registries() -> Iterator[None]:
    with restored_registries():
        yield


@pytest.fixture
def mine(tmp_path: Path) -> Path:
    """A technique in a folder beside which there is a file that is none of its."""
    folder = tmp_path / "mine"
    folder.mkdir()
    (folder / "mine.toml").write_text(TOML)
    (folder / "march.glsl").write_text(WHOLE)
    (tmp_path / "secret.glsl").write_text("// a secret\n" + WHOLE)
    return folder / "mine.toml"


def drawn(technique: OwnTechnique) -> np.ndarray:
    with Renderer(load("empty", size=(8, 8))) as renderer:
        return renderer.render(technique).scattering


@pytest.mark.parametrize("include", ["../secret.glsl", "/secret.glsl", "link.glsl", "folder/secret.glsl"])
def test_files_outside_of_its_folder_are_refused(mine: Path, include: str) -> None:
    (mine.parent / "link.glsl").symlink_to(mine.parents[1] / "secret.glsl")
    (mine.parent / "folder").symlink_to(mine.parents[1])
    include = include.replace("/secret.glsl", f"{mine.parents[1]}/secret.glsl") if include[0] == "/" else include
    (mine.parent / "march.glsl").write_text(f'\n#include "{include}"\n')
    with pytest.raises(InputError, match=rf"march\.glsl:2: {include} is outside of .*/mine; a technique takes"):
        load_technique(mine)
    mine.write_text(TOML.replace("march.glsl", include))
    with pytest.raises(InputError, match=r"secret\.glsl is outside of|link\.glsl is outside of"):
        load_technique(mine)


def test_the_way_from_our_shaders_leads_nowhere_else(mine: Path, tmp_path: Path, monkeypatch) -> None:
    """A picture's texts are somebody else's too: nothing else is read for them, not even by the way from our folder."""
    shaders = tmp_path / "shaders"
    shaders.mkdir()
    monkeypatch.setattr(shader_source, "SHADERS", shaders)
    for include in ("../secret.glsl", str(tmp_path / "secret.glsl")):
        assert (shaders / include).is_file()
        texts = {"/a/b/mine.toml": TOML, "/a/b/march.glsl": f'#include "{include}"\n'}
        with pytest.raises(InputError, match=r"march\.glsl:1: there is no .*secret\.glsl"):
            make_known("/a/b/mine.toml", json.dumps(texts))


def test_files_below_its_folder_are_taken(mine: Path) -> None:
    (mine.parent / "parts").mkdir()
    (mine.parent / "parts" / "half.glsl").write_text('#include "../share.glsl"\n')
    (mine.parent / "share.glsl").write_text("#define SHARE 0.5\n")
    before = drawn(load_technique(mine))
    (mine.parent / "march.glsl").write_text('#include "parts/half.glsl"\n' + WHOLE.replace("1.0", "SHARE"))
    np.testing.assert_allclose(drawn(load_technique(mine)), 0.5 * before, rtol=1e-6)  # measured: 0


@pytest.mark.parametrize("comment", ["// march.glsl", "/* as ours */", " /**/ "])
def test_a_comment_may_stand_behind_an_include(mine: Path, comment: str) -> None:
    before = drawn(load_technique(mine))
    (mine.parent / "half.glsl").write_text("#define SHARE 0.5\n")
    (mine.parent / "march.glsl").write_text(f'# include "half.glsl" {comment}\n' + WHOLE.replace("1.0", "SHARE"))
    np.testing.assert_allclose(drawn(load_technique(mine)), 0.5 * before, rtol=1e-6)  # measured: 0
    (mine.parent / "half.glsl").unlink()
    with pytest.raises(InputError, match=r"march\.glsl:1: there is no half\.glsl"):
        load_technique(mine)


def test_a_copy_of_ours_under_its_own_name_is_told_who_goes_first(mine: Path) -> None:
    (mine.parent / "given.glsl").write_text((SHADERS / "visibility/given.glsl").read_text())
    mine.write_text(TOML.replace("march", "given"))
    with pytest.raises(InputError, match=r"given\.glsl:\d+: given\.glsl includes itself; a file beside goes before "):
        load_technique(mine)


@pytest.mark.parametrize("include", ["<polynomials>", "<nonsense>"])
def test_a_computed_include_that_is_not_there_is_named(mine: Path, include: str) -> None:
    (mine.parent / "march.glsl").write_text(f'\n\n#include "{include}"\n{WHOLE}')
    with pytest.raises(InputError, match=rf"^/.*/march\.glsl:3: there is no {include} here, but .*supply = ") as caught:
        drawn(load_technique(mine))
    assert "<phase>" in str(caught.value)
    assert "\n" not in str(caught.value)


def test_it_is_named_in_a_file_of_ours_too(mine: Path) -> None:
    (mine.parent / "march.glsl").write_text('#include "airlight/weng2010_polynomial.glsl"\n' + WHOLE)
    with pytest.raises(InputError, match=r"^airlight/.*\.glsl:\d+: there is no <polynomials> here"):
        drawn(load_technique(mine))
    with pytest.raises(ShaderError, match=r"^ray_in_fog\.glsl:\d+: there is no <lattice> here"):
        ShaderSource("scattering.frag.glsl")


def test_a_computed_include_may_be_empty() -> None:
    includes = {"<airlight>": "airlight/weng2010_polynomial.glsl", "<phase>": "phase/isotropic.glsl"}
    assert ShaderSource("<airlight>", {}, includes, {"<polynomials>": ""}).files


def test_what_a_compiler_says_without_the_word_is_said(mine: Path) -> None:
    name = OwnFiles(mine.parent).shader(mine.parent / "march.glsl")
    found = ShaderSource(name).failure(Exception("GLSL Compiler failed\n\nvertex_shader\n0:3: unexpected include\n"))
    assert isinstance(found, InputError)
    assert "does not compile: GLSL Compiler failed" in str(found)
    assert "unexpected include" in str(found)
    assert "\n" not in str(found)


def test_one_file_is_one_technique_by_whatever_way(mine: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (mine.parent / "my dir").mkdir()
    monkeypatch.chdir(mine.parent)
    assert load_technique(Path("my dir/../mine.toml")) == load_technique(Path("mine.toml")) == load_technique(mine)
