"""Fog that a shape holds, in the reference: against closed forms, against `volpath`, and bodies that are not convex."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from slab import COLOURED, GREY, THICK, VIEWS, slab_scattering, slab_scene, slab_surface

from reference.agreement.comparison import compare
from reference.agreement.measured import witness
from reference.convergence import converge
from reference.estimators import Equiangular, Volpath
from reference.fog_path import bounded_path
from reference.goal import Goal
from reference.integrator import mi
from scenes.loader import load

SHORT = Goal(rel_error=0.999)


@pytest.mark.parametrize("sigma_t", [GREY, COLOURED, THICK], ids=["grey", "coloured", "thick"])
@pytest.mark.parametrize("view", VIEWS)
def test_a_slab_under_the_sun(view: str, sigma_t: str, tmp_path: Path) -> None:
    scene = slab_scene(tmp_path, VIEWS[view], sigma_t)
    truth = slab_scattering(scene)
    estimate = converge(Equiangular(scene), SHORT)
    # float32 places a boundary to 1e-6 of some units, which thick fog makes 3e-5 of the light
    rounding = (1e-4 if sigma_t == THICK else 2e-6) * truth
    z = (estimate.mean["scattering"] - truth) / np.hypot(estimate.standard_error["scattering"], rounding)
    # Student's t with 31 degrees of freedom, 2,304 values; largest measured 4.9
    assert np.abs(z).max() < 6.5
    mean = truth.mean((0, 1))
    error = np.hypot(estimate.image_error["scattering"], rounding.mean((0, 1)))
    assert (np.abs(estimate.image_mean["scattering"] - mean) < 4 * error).all()
    assert (error / mean).max() < 5e-3
    np.testing.assert_allclose(estimate.mean["surface"], slab_surface(scene), rtol=2e-4, atol=1e-12)


@pytest.mark.parametrize(("view", "far"), [("from within, downward", 2.2), ("from within, upward into the light", 1.3)])
def test_a_far_plane_in_a_slab(view: str, far: float, tmp_path: Path) -> None:
    """Some rays end in the fog, and some behind it."""
    whole = slab_scattering(slab_scene(tmp_path, VIEWS[view]))
    scene = slab_scene(tmp_path, VIEWS[view], far=far)
    truth = slab_scattering(scene)
    assert 0.1 < (truth < 0.99 * whole).mean() < 0.9
    estimate = converge(Equiangular(scene), SHORT)
    error = np.hypot(estimate.standard_error["scattering"], 2e-6 * truth)
    # as above
    assert np.abs((estimate.mean["scattering"] - truth) / error).max() < 6.5
    assert (estimate.image_error["scattering"] < 5e-3 * truth.mean((0, 1))).all()


@pytest.mark.parametrize("name", ["sun_in_a_box", "lamp_outside"])
def test_volpath_agrees(name: str, others: Path) -> None:
    scene = load(others / f"{name}.xml", size=(48, 36))
    ours, theirs = converge(Equiangular(scene), SHORT), converge(Volpath(scene), Goal(0.05, sample_limit=1024))
    test = compare(witness("ours", ours, surface=ours.mean["surface"]), witness("volpath", theirs)).verdicts[2]
    # measured with four times the samples: 0.24 %
    assert test.power < 2e-2
    assert test.agrees


def test_a_body_with_a_hollow() -> None:
    """Two nested shells: fog between them. The integrator takes any closed body, and bodies in bodies."""
    inner = {"type": "sphere", "radius": 1.0, "flip_normals": True}
    outer = {"type": "sphere", "radius": 2.0}
    block = {"type": "rectangle", "to_world": mi.ScalarTransform4f().translate([0, 0, -1.5])}
    medium = {"type": "homogeneous", "sigma_t": 1.0}
    shells = {
        name: shape | {"bsdf": {"type": "null"}, "interior": medium}
        for name, shape in {"inner": inner, "outer": outer}.items()
    }
    scene = mi.load_dict({"type": "scene", **shells, "block": block})
    ray = mi.Ray3f(mi.Point3f([0.0, 0.0, 5.0], 0.0, [1.5, 3.5, 1.5]), mi.Vector3f(0, 0, -1))
    path = bounded_path(scene, ray, True)
    # from within the shell through the hollow to the block in the shell behind; the same from outside; past it all
    assert np.array(path.blocked).tolist() == [True, True, False]
    assert np.array(path.t_end)[:2] == pytest.approx([3.0, 5.0], abs=1e-5)
    assert np.array(path.fog_length) == pytest.approx([0.5 + 0.5, 1.0 + 0.5, 0.0], abs=1e-4)
    assert np.array(path.ends_in_fog)[:2].all()
