"""Figures 1.5, 1.6, 4.1 and 4.3 to 4.5 and 4.7: the shadow region of a ray, and the samples and lit pieces in it."""

from __future__ import annotations

import numpy as np

from experiments.figures.choices import many_shadows, one_shadow, two_shadows
from experiments.figures.diagram import DARK, LIT, POLYGON, REGION, RayDiagram, beside_picture
from experiments.figures.entry import Drawn
from experiments.figures.plane import Array
from experiments.figures.rays import SAMPLES, DrawnRay
from experiments.figures.stage import Stage

# rays of the fan that Figure 1.5 is shaded by
FAN = 800
# colours of the ends of lit pieces, in their order along the ray (Okabe and Ito)
END_COLOURS = ("#0072b2", "#009e73", "#cc79a7", "#d55e00", "#56b4e9", "#000000")
SITUATIONS = ("dark to lit", "lit to lit", "lit to dark", "dark to dark")


def shadow_region(stage: Stage) -> Drawn:
    """Figure 1.5: between the first and the last shadow polygon of every ray of the plane."""
    ray = two_shadows(stage)
    figure, axes = beside_picture(stage, ray)
    drawing = RayDiagram(axes, ray)
    x0, x1, _, y1 = drawing.window
    reach = float(np.hypot(x1 - x0, y1)) * 2
    begin, end = region_of_fan(ray, reach)
    axes.fill(*np.vstack([begin, end[::-1]]).T, color=REGION, alpha=0.45, lw=0, zorder=1)
    middle = 0.5 * (begin + end)[len(begin) // 2]
    axes.annotate(
        "shadow region", middle, (20, 55), textcoords="offset points", fontsize=9, arrowprops={"arrowstyle": "-"}
    )
    return Drawn(
        figure,
        f"The plane through the light and the ray of one pixel, cut out of the scene: black where it cuts surfaces, "
        f"yellow where the light reaches, dashed its {len(ray.plane.shadow_lines(reach))} shadow polygons. Blue: from "
        f"the first to the last shadow polygon of each of the {len(begin)} rays, of {FAN} through the eye, that meet "
        "one.",
    )


def region_of_fan(ray: DrawnRay, reach: float) -> tuple[Array, Array]:
    """Where the first and the last shadow polygon of the plane's other rays lie, (n, 2) each, in turn.

    Rays through the eye between the lowest and the highest end of a shadow polygon; none behind the surface it meets.
    """
    lines = ray.plane.shadow_lines(reach)
    turns = np.arctan2(lines[..., 1], lines[..., 0])
    begin, end = [], []
    for turn in np.linspace(turns.min(), turns.max(), FAN):
        way = np.array([np.cos(turn), np.sin(turn)])
        met = _along(way, lines)
        surface = _along(way, ray.plane.cuts).min(initial=np.inf)
        met = met[met < surface * (1 + 1e-9)]
        if len(met):
            begin.append(met.min() * way)
            end.append(met.max() * way)
    return np.array(begin), np.array(end)


def _along(way: Array, pieces: Array) -> Array:
    """Distances from the eye at which a ray meets straight pieces, (k,)."""
    beside = pieces @ np.array([-way[1], way[0]])
    crossed = beside[:, 0] * beside[:, 1] < 0
    pieces, beside = pieces[crossed], beside[crossed]
    share = (beside[:, 0] / (beside[:, 0] - beside[:, 1]))[:, None]
    found = (pieces[:, 0] + share * (pieces[:, 1] - pieces[:, 0])) @ way
    return np.asarray(found[found > 0])


def samples_in_region(stage: Stage) -> Drawn:
    """Figure 1.6: what Algorithm 4.1 asks the shadow map for."""
    ray = two_shadows(stage)
    figure, axes = beside_picture(stage, ray)
    begin, end = ray.front, ray.final
    wide = end - begin
    drawing = RayDiagram(axes, ray, (begin - 0.5 * wide, end + 0.4 * wide, -0.35 * wide, 0.55 * wide))
    drawing.region()
    drawing.samples()
    _name_ends(drawing)
    return Drawn(figure, f"{_places(ray)} {_kinds(ray)}")


def types_of_a_sample(stage: Stage) -> Drawn:
    """Figure 4.1."""
    ray = two_shadows(stage)
    figure, axes = beside_picture(stage, ray)
    drawing = RayDiagram(axes, ray)
    drawing.region("$R_1$")
    drawing.samples()
    _name_ends(drawing)
    kinds = (
        ("type 3: in the region, lit", LIT),
        ("type 2: in the region, dark", DARK),
        ("type 1: outside; the repaired algorithm takes none", "0.5"),
    )
    for row, (text, colour) in enumerate(kinds):
        axes.text(0.02, 0.9 - 0.07 * row, text, color=colour, transform=axes.transAxes, fontsize=8, weight="bold")
    return Drawn(figure, f"{_places(ray)} {_kinds(ray)}")


def sampling_situations(stage: Stage) -> Drawn:
    """Figure 4.3: neighbouring samples of one ray in each of the four situations."""
    from matplotlib.figure import Figure

    ray = two_shadows(stage)
    figure = Figure(figsize=(8, 5.2), layout="constrained")
    panels = figure.subplots(2, 2).ravel()
    for axes, situation, letter in zip(panels, SITUATIONS, "abcd", strict=True):
        before, after = (what == "lit" for what in situation.split(" to "))
        first = int(np.flatnonzero((ray.is_lit[:-1] == before) & (ray.is_lit[1:] == after))[0])
        step = float(ray.samples[1] - ray.samples[0])
        middle = float(ray.samples[first : first + 2].mean())
        window = (middle - 1.4 * step, middle + 1.4 * step, -0.6 * step, 0.75 * step)
        drawing = RayDiagram(axes, ray, window)
        drawing.samples()
        for at, name in zip(ray.samples[first : first + 2], ("$P_1$", "$P_2$"), strict=True):
            drawing.place(at, name, row=3, colour=LIT if ray.is_lit[first + (name == "$P_2$")] else DARK)
        if before != after:
            axes.axvline(middle, color=POLYGON, lw=0.8, ls=":")
        axes.set_title(f"({letter}) {situation}", fontsize=9)
    off = [float(np.min(np.abs(ray.lit - middle))) for middle in _borders(ray)]
    return Drawn(
        figure,
        f"Samples of the ray of Figure 4.1, {SAMPLES} in its shadow region, {step:.3g} apart. Dotted: halfway between "
        f"the two, where the repaired algorithm lets a lit piece begin and end. Ray casting has the borders up to "
        f"{max(off):.3g} from there, at most half a step; as printed, with the ends at the samples, they are up to "
        f"{_printed_error(ray):.3g} off.",
    )


def three_parts(stage: Stage) -> Drawn:
    """Figure 4.4."""
    ray = two_shadows(stage)
    figure, axes = beside_picture(stage, ray)
    drawing = RayDiagram(axes, ray)
    drawing.region()
    for begin, end, name in ((0, ray.front, "$L_1$"), (ray.front, ray.final, "$L_2$"), (ray.final, ray.end, "$L_3$")):
        drawing.length(begin, end, name)
    return Drawn(
        figure,
        f"$L_1$ is {ray.front:.4f} long, $L_2$ {ray.final - ray.front:.4f}, $L_3$ {ray.end - ray.final:.4f}; the "
        "spot's "
        f"cone, which the thesis does not draw, is entered at {ray.reached[0]:.4f}.".replace("$", ""),
    )


def lit_regions(stage: Stage) -> Drawn:
    """Figure 4.5: the lit pieces of a ray that passes several shadows."""
    ray = many_shadows(stage, "many_objects", 4)
    figure, axes = beside_picture(stage, ray)
    drawing = RayDiagram(axes, ray)
    drawing.lit()
    for piece, colour in zip(ray.lit, END_COLOURS, strict=False):
        axes.plot(piece, (0, 0), "o", color=colour, ms=6, zorder=9)
    pieces = ", ".join(f"{begin:.3f} to {end:.3f}" for begin, end in ray.lit)
    return Drawn(figure, f"{len(ray.lit)} lit pieces, by ray casting: {pieces}.")


def shadow_volume(stage: Stage) -> Drawn:
    """Figure 4.7: front, final and surface distance."""
    ray = one_shadow(stage)
    figure, axes = beside_picture(stage, ray)
    drawing = RayDiagram(axes, ray)
    drawing.region()
    for row, (at, place, name) in enumerate(
        (
            (ray.front, "$P_1$", "front distance"),
            (ray.final, "$P_2$", "final distance"),
            (ray.end, "$P_3$", "surface distance"),
        )
    ):
        drawing.place(at, place, POLYGON if row < 2 else "black", row=-1)
        drawing.length(0, at, name, row=1 + row)
    cast = ray.dark[0]
    off = max(abs(ray.front - cast[0]), abs(ray.final - cast[1]))
    return Drawn(
        figure,
        f"Front distance {ray.front:.5f}, final distance {ray.final:.5f}, surface distance {ray.end:.5f}, as OpenGL "
        f"draws them; ray casting has the shadow's ends within {off:.1g} of the first two.",
    )


def _name_ends(drawing: RayDiagram) -> None:
    for number, at in enumerate(drawing.ray.dark.ravel(), start=1):
        drawing.place(at, f"$d_{number}$", POLYGON)


def _places(ray: DrawnRay) -> str:
    ends = ", ".join(f"d{number} = {at:.4f}" for number, at in enumerate(ray.dark.ravel(), start=1))
    return (
        f"By ray casting {ends}; the shadow polygons that OpenGL draws have d1 = {ray.front:.4f} and "
        f"d{ray.dark.size} = {ray.final:.4f}."
    )


def _kinds(ray: DrawnRay) -> str:
    return f"Of {SAMPLES} samples in the shadow region {ray.is_lit.sum()} are lit."


def _borders(ray: DrawnRay) -> list[float]:
    """Halfway between neighbouring samples of different kind."""
    changes = np.flatnonzero(np.diff(ray.is_lit))
    return [float(ray.samples[at : at + 2].mean()) for at in changes]


def _printed_error(ray: DrawnRay) -> float:
    """Most by which Algorithm 4.1 as printed misplaces a border: it takes the second sample of the two."""
    changes = np.flatnonzero(np.diff(ray.is_lit))
    return max(float(np.min(np.abs(ray.lit - ray.samples[at + 1]))) for at in changes)
