"""What README.md counts is what the registries have."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

import analytic
from gpu_impl.airlight_models import AIRLIGHT_MODELS
from gpu_impl.lattices import LATTICES
from gpu_impl.own_files import OWN
from gpu_impl.techniques import CHOICES, TECHNIQUES, UPSAMPLINGS
from gpu_impl.visibilities import VISIBILITIES

WORDS = " ".join((Path(__file__).parents[2] / "README.md").read_text().split())


def counted(names: Iterable[str]) -> tuple[int, int]:
    """Families, which stand before a colon, and names."""
    own = [name for name in names if OWN not in name]
    return len({name.partition(":")[0] for name in own}), len(own)


def test_readme_counts_what_the_registries_have() -> None:
    (kinds, strategies), (families, models), (others, twins) = map(
        counted, (VISIBILITIES, AIRLIGHT_MODELS, analytic.MODELS)
    )
    assert f"{kinds} families of visibility strategies under {strategies} names" in WORDS
    assert f"{families} of airlight models under {models} (in `analytic` {others} under {twins})" in WORDS
    assert len(UPSAMPLINGS) == 3
    assert "three upsamplings" in WORDS
    assert [name for name in LATTICES if OWN not in name] == ["grid", "epipolar"]
    assert CHOICES["downsample"] == (1, 2, 4, 8)
    for name in ("Nishita1987", "Dobashi2002", "James2003", "Wyman2008", "Chen2011"):
        assert name in TECHNIQUES
        assert f"{name[:-4]} {name[-4:]}" in WORDS
    every_light = [name for name, model in AIRLIGHT_MODELS.items() if model.any_light and ":" not in name]
    assert {name for name in every_light if OWN not in name} == {"quadrature", "riemann", "depth_fog"}
    assert "`quadrature`, `riemann` and `depth_fog` take all lights" in WORDS
