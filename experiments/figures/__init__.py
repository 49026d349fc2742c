"""The figures and the table of Weng 2010, drawn anew. A new one is a function and a line here."""

from __future__ import annotations

from experiments.figures.artefacts import aliasing, slices, too_dark
from experiments.figures.entry import PaperFigure
from experiments.figures.interlaced import dark_and_light
from experiments.figures.models import models_compared
from experiments.figures.projection import general_scene, light_projections, single_scattering
from experiments.figures.results import final_results_1, final_results_2, media_and_scene, phase_functions
from experiments.figures.shadow_region import (
    lit_regions,
    samples_in_region,
    sampling_situations,
    shadow_region,
    shadow_volume,
    three_parts,
    types_of_a_sample,
)
from experiments.figures.table_5_1 import frame_rates
from scenes.errors import InputError
from scenes.messages import readable

# number, the thesis's caption, its page, and what draws it
FIGURES = {
    number: PaperFigure(number, caption, page, draw)
    for number, caption, page, draw in (
        ("1.1", "The region between d_2 and d_3 is too dark", 2, too_dark),
        ("1.2", "Ray marching produce aliasing", 2, aliasing),
        ("1.4", "(Left) Only render participating media effects, (Right) a general scene", 4, media_and_scene),
        ("1.5", "Shadow region", 5, shadow_region),
        ("1.6", "d_1 ~ d_2, d_3 ~ d_4: in shadows; d_2 ~ d_3: not in shadows", 5, samples_in_region),
        ("2.1", "The result of Dobashi et al. [8]", 7, slices),
        ("2.3", "Visualization of the absolute error mapped to hue (from blue to red)", 10, models_compared),
        ("4.1", "Region R_1: Shadow Region, ...", 19, types_of_a_sample),
        ("4.2", "We do not sample in this situation, ...", 20, general_scene),
        ("4.3", "P_1 point: previous sample, P_2 point: Current sample", 22, sampling_situations),
        ("4.4", "L_1 line: the part of the eye to the frontmost shadow polygon, ...", 22, three_parts),
        ("4.5", "The orange segment represents lit region of a ray, ...", 23, lit_regions),
        ("4.6", "We shot a ray from the eye X_a to the surface point X_b, ...", 23, single_scattering),
        ("4.7", "P_1: the intersection point of the frontmost shadow polygon, ...", 24, shadow_volume),
        ("4.8", "Light's projection onto a ray", 31, light_projections),
        ("5.1", "Final Results (Left) Donut & dragon (Right) Dragon", 35, final_results_1),
        ("5.2", "Final results (Left) YeahRight (Right) Many objects", 36, final_results_2),
        ("5.3", "(Left) Anisotropic phase function (Right) Isotropic phase function", 37, phase_functions),
        ("5.4", "dark and light regions are interlaced", 38, dark_and_light),
        ("table-5.1", "frame rates with various scenes", 38, frame_rates),
    )
}
LEFT_OUT = {
    "1.3": "a diagram of the passes, which gpu_impl/README.md lists",
    "2.2": "the result of Biri et al. [11]: a technique of other people, which airlight does not have yet",
    **dict.fromkeys(("3.1", "3.2", "3.3", "3.4", "3.5", "3.6"), "a diagram without a scene or a number"),
    **dict.fromkeys(("4.9", "4.10", "4.11"), "a formula; `airlight audit` measures it"),
}


def find_figure(number: str) -> PaperFigure:
    """What draws a figure, by its number.

    Raises
    ------
    InputError
        It is left out, or there is none of that number.
    """
    if number in FIGURES:
        return FIGURES[number]
    what = f"There is no figure '{readable(number)}'"
    if number in LEFT_OUT:
        what = f"Figure {number} is left out, {LEFT_OUT[number]}"
    raise InputError(f"{what}: use one of {', '.join(FIGURES)}.")
