"""Without a usable LLVM the reference comes from the C++ `volpath` in `scalar_rgb`, through the command line."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import OpenEXR
import pytest

from experiments.exr import read_exr
from reference.convergence import converge
from reference.estimators import Equiangular
from reference.goal import Goal
from scenes.loader import load

SIDE = 24
# Rays through the centres of a finer image average over pixels as a box filter does. Pictures on surfaces take a fine
# one: the mean blue of `wallpaper` is 1 % too large at 4 times the size, 0.2 % too small at 8 times.
FINER, FINER_SURFACE = 4, 16

# run by the other variant: what one parse is instantiated to is shared, so what the fallback darkens must be put back
PUT_BACK = """
import numpy as np
from reference.estimators import FilmVolpath, mi
from scenes.loader import load
estimator = FilmVolpath(load("sphere", size=(8, 8)))
def values():
    parameters = mi.traverse(estimator._scene)
    return {key: str(parameters[key]) for key in parameters.keys() if "albedo" in key or "reflectance" in key}
before = values()
assert len(before) == 3, before
first = estimator.one_pass(0)
assert values() == before, (before, values())
again = estimator.one_pass(0)
assert all((first[layer] == again[layer]).all() for layer in first)
assert not np.array_equal(first["surface"], estimator.one_pass(1)["surface"])
assert mi.variant() == "scalar_rgb"
"""

# a film's random numbers are all different ones, in each layer and in each pass: a picture of what the paths draw first
STREAMS = """
import numpy as np
from reference.estimators import FilmVolpath, mi
from scenes.loader import load
class FirstNumber(mi.SamplingIntegrator):
    def sample(self, scene, sampler, ray, medium=None, active=True):
        return mi.Color3f(sampler.next_1d()), True, []
mi.register_integrator("first_number", FirstNumber)
for size in ((3, 5), (20, 12), (33, 7)):
    estimator = FilmVolpath(load("empty", size=size))
    estimator._integrator, estimator.SAMPLES = mi.load_dict({"type": "first_number"}), 1
    passes = [estimator.one_pass(seed) for seed in range(4)]
    numbers = np.array([images[layer][..., 0] for images in passes for layer in estimator.layers])
    # float32 has some 2^24: measured 1; with seeds one after the other 0.825, 0.825 and 0.784
    print(size, len(np.unique(numbers)) / numbers.size)
    assert len(np.unique(numbers)) > 0.999 * numbers.size, size
"""


def scalar(command: list[str], cache: Path) -> subprocess.CompletedProcess[str]:
    environment = os.environ | {
        "AIRLIGHT_MITSUBA_VARIANT": "scalar_rgb",
        "XDG_CACHE_HOME": str(cache),
        # one line a message, however wide the terminal
        "COLUMNS": "400",
    }
    return subprocess.run(
        [sys.executable, *command], env=environment, capture_output=True, text=True, timeout=60, check=False
    )


@pytest.mark.parametrize("name", ["sphere", "sun_in_a_box", "in_parts", "wallpaper"])
def test_the_fallback(name: str, others: Path, tmp_path: Path) -> None:
    """A shipped scene, a bounded medium under the sun, Phong surfaces, and pictures on surfaces before a near plane."""
    scene = name if name == "sphere" else str(others / f"{name}.xml")
    if name == "wallpaper":
        scene = str(others / "wallpaper_close.xml")
        far = '<float name="far_clip" value="50"/>'
        Path(scene).write_text(
            (others / "wallpaper.xml").read_text().replace(far, f'{far}<float name="near_clip" value="3.5"/>')
        )
        assert load(scene).camera.near == 3.5
    out = tmp_path / "scalar.exr"
    main = ["-c", "from experiments.cli import main; main()"]
    options = ["--size", str(SIDE), str(SIDE), "--rel-error", "0.2", "--time-limit", "40", "--out", str(out)]
    run = scalar([*main, "reference", scene, *options], tmp_path)
    assert run.returncode == 0, run.stderr
    assert "scalar_rgb" in run.stdout + run.stderr
    assert "averaged over pixels" in run.stdout + run.stderr

    layers, _ = read_exr(out)
    header = OpenEXR.File(str(out)).header()
    assert header["airlight:variant"] == "scalar_rgb"
    assert header["airlight:pixel_filter"] == "box"
    fine, finest = (Equiangular(load(scene, size=(SIDE * finer,) * 2)) for finer in (FINER, FINER_SURFACE))
    truth = {
        "scattering": converge(fine, Goal(0.1)).image_mean["scattering"],
        "surface": finest.fixed()["surface"].mean((0, 1)),
    }
    for layer in ("scattering", "surface"):
        # a film's pixels are independent of each other
        error = np.sqrt((layers[f"standard_error.{layer}"].astype(float) ** 2).sum((0, 1))) / SIDE**2
        mean = truth[layer]
        # measured 0.7 % and 0.6 %, beside which the finer image's own error is nothing
        assert (error / mean).max() < 0.02
        assert np.abs((layers[layer].mean((0, 1)) - mean) / error).max() < 4


def test_the_fallback_puts_back_what_it_darkens(tmp_path: Path) -> None:
    run = scalar(["-c", PUT_BACK], tmp_path)
    assert run.returncode == 0, run.stderr


def test_no_two_passes_share_random_numbers(tmp_path: Path) -> None:
    run = scalar(["-c", STREAMS], tmp_path)
    assert run.returncode == 0, run.stdout + run.stderr


@pytest.mark.parametrize("variant", ["scalar_spectral", "nonsense"])
def test_a_variant_that_cannot_serve_is_one_sentence(variant: str, tmp_path: Path, monkeypatch) -> None:
    monkeypatch.setenv("AIRLIGHT_MITSUBA_VARIANT", variant)
    command = [
        sys.executable,
        "-c",
        "from experiments.cli import main; main()",
        "reference",
        "sphere",
        "--out",
        "x.exr",
    ]
    run = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, timeout=60, check=False)
    assert run.returncode == 2
    assert f"AIRLIGHT_MITSUBA_VARIANT is '{variant}'" in run.stderr
    assert "Traceback" not in run.stderr
