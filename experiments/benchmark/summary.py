"""The numbers of a benchmark: flat for a CSV file, and as lines of a table and sentences for people."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

from experiments.benchmark.efficiency import quartiles
from experiments.benchmark.measurement import Measurement
from reference.goal import FEWEST_PASSES

Numbers = dict[str, Any]

# what the median over the pixels of volpath's seconds over ours must be, and what it is hoped to be
MUST, WISH = 100, 1000


def numbers(measured: Measurement) -> Numbers:
    """All numbers of one scene; of quartiles and median the names end in _25, _50 and _75."""
    scene = measured.scene
    (ours, theirs), (ours_run, theirs_run) = measured.by_variance(), measured.as_run()
    spreads = {
        "ours_seconds": ours,
        "volpath_seconds": theirs,
        "ratio": theirs / ours,
        "ours_as_run_seconds": ours_run,
        "volpath_as_run_seconds": theirs_run,
        "as_run_ratio": theirs_run / ours_run,
    }
    shadow_rays, fixed, fog = measured.time_shares()
    every, edge, smooth = measured.exponents()
    return {
        "triangles": sum(len(mesh.faces) for mesh in scene.meshes),
        "rel_error": measured.goal.rel_error,
        "percentile": measured.goal.percentile,
        "lit_pixels": ours.size,
        **{
            f"{name}_{percent}": value
            for name, values in spreads.items()
            for percent, value in zip((25, 50, 75), quartiles(values), strict=True)
        },
        "seconds_to_goal": measured.seconds_to_goal(),
        "plan_seconds": measured.plan_seconds,
        "pass_seconds": measured.ours.typical_seconds,
        "pass_samples": measured.samples,
        "volpath_pass_seconds": measured.theirs.typical_seconds,
        "volpath_pass_samples": measured.volpath_samples,
        "passes": FEWEST_PASSES,
        "compile_seconds": measured.compile_seconds[0],
        "volpath_compile_seconds": measured.compile_seconds[1],
        "peak_memory_gb": measured.peak_memory,
        "time_of_shadow_rays": shadow_rays,
        "time_of_any_pass": fixed,
        "time_of_fog": fog,
        "edge_pixels": float(measured.edges().mean()),
        "exponent": every,
        "edge_exponent": edge,
        "smooth_exponent": smooth,
    }


def _short(value: float) -> str:
    return f"{value:,.0f}" if value >= 1000 else f"{value:.3g}"


def _spread(name: str) -> Callable[[Numbers], str]:
    def cell(of: Numbers) -> str:
        low, middle, high = (_short(of[f"{name}_{percent}"]) for percent in (25, 50, 75))
        return f"{middle} [{low}, {high}]"

    return cell


LINES: dict[str, Callable[[Numbers], str]] = {
    "triangles": lambda of: f"{of['triangles']:,}",
    "pixels with airlight": lambda of: f"{of['lit_pixels']:,}",
    "volpath, by variance x time [s]": _spread("volpath_seconds"),
    "ours, by variance x time [s]": _spread("ours_seconds"),
    "ratio, pixel by pixel": _spread("ratio"),
    "volpath, as run [s]": _spread("volpath_as_run_seconds"),
    "ours, as run [s]": _spread("ours_as_run_seconds"),
    "ratio as run, pixel by pixel": _spread("as_run_ratio"),
    "ours to the goal's percentile [s]": lambda of: f"{of['seconds_to_goal']:.1f}",
    "our plan [s]": lambda of: f"{of['plan_seconds']:.2f}",
    "a pass of ours [s]": lambda of: f"{of['pass_seconds']:.3f}",
    "samples of a pixel in it": lambda of: f"{of['pass_samples']:.1f}",
    "a pass of volpath [s]": lambda of: f"{of['volpath_pass_seconds']:.3f}",
    "samples of a pixel in it, volpath": lambda of: f"{of['volpath_pass_samples']}",
    "compilation, ours and volpath [s]": lambda of: f"{of['compile_seconds']:.2f}, {of['volpath_compile_seconds']:.2f}",
    "peak memory so far [GB]": lambda of: f"{of['peak_memory_gb']:.2f}",
    "time in shadow rays": lambda of: f"{of['time_of_shadow_rays']:.0%}",
    "time in what any pass costs": lambda of: f"{of['time_of_any_pass']:.0%}",
    "time in sampling and fog": lambda of: f"{of['time_of_fog']:.0%}",
    "pixels limited by shadow edges": lambda of: f"{of['edge_pixels']:.0%}",
    "error against strata, median pixel": lambda of: f"N^{of['exponent']:.2f}",
    "error against strata, at edges": lambda of: f"N^{of['edge_exponent']:.2f}",
    "error against strata, elsewhere": lambda of: f"N^{of['smooth_exponent']:.2f}",
}


def heading(measured: Measurement) -> str:
    """What a column is about; a star for stand-in meshes."""
    camera = measured.scene.camera
    return f"{measured.scene.name}{'*' * bool(measured.scene.stand_ins)}, {camera.width} x {camera.height}"


def verdict(measured: Measurement) -> str:
    """Say in a sentence whether both ratios are what they must be, and in another what limits them."""
    of = numbers(measured)
    ratio, as_run = of["ratio_50"], of["as_run_ratio_50"]
    least = min(ratio, as_run)
    if least < MUST:
        judged = f"not the {MUST} that both must be"
    else:
        judged = f"both must be {MUST}, and the goal of {WISH:,} is {'' if least >= WISH else 'not '}reached"
    time = {"time_of_shadow_rays": "shadow rays", "time_of_fog": "sampling and fog", "time_of_any_pass": "any pass"}
    shares = ", ".join(f"{what} {of[name]:.0%}" for name, what in time.items())
    return (
        f"{measured.scene.name}: {_short(ratio)} times by variance x time, {_short(as_run)} as run; {judged}. What "
        f"limits it: edges of shadows set the error of {of['edge_pixels']:.0%} of the pixels, where it falls as "
        f"strata^{of['edge_exponent']:.2f}, elsewhere as strata^{of['smooth_exponent']:.2f}; of the time take {shares}."
    )


def method(measurements: Sequence[Measurement]) -> str:
    """What the numbers mean, in sentences."""
    goal, samples = measurements[0].goal, measurements[0].volpath_samples * FEWEST_PASSES
    text = (
        f"Errors are relative to the airlight by ours, of each pixel's worst channel, and come from {FEWEST_PASSES} "
        f"passes of each ({samples:,} samples a pixel of volpath); volpath's seconds are extrapolated as N^-1/2, "
        "and are 0 where it met no light. It has black surfaces, so that it estimates the airlight alone too. By "
        "variance x time: the inverse of the field's efficiency, with fractions of a pass. As run: whole passes of all "
        f"pixels, at least {FEWEST_PASSES}, for fewer give no error bar, and our plan before them. The goal's "
        f"percentile is the {goal.percentile:g}th of pixels and channels, at which `airlight reference` stops. Time in "
        "shadow rays: what a pass without them does not take; what any pass costs: a pass of one stratum. Limited by "
        "shadow edges: without shadows the variance is less than a quarter. Error against strata: a pass of 1 to 256, "
        "a power law by least squares. Compilation: next to 0 where Dr.Jit's cache on disk had the kernels."
    )
    stand_ins = {name for measured in measurements for name in measured.scene.stand_ins}
    return text + (f" * Procedural stand-ins serve for {', '.join(sorted(stand_ins))}." if stand_ins else "")
