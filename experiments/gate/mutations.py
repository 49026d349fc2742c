"""Wrong mathematics and wrong shaders, made on purpose: what the gate must notice, or it is worth nothing.

Each mutation is the least that a person could get wrong, as an edit of GLSL. Some have to be noticed; the subtler ones
tell how sharp the gate is, and one of them that goes unnoticed is told, and no failure.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from experiments.gate.changed_shaders import Edit, changed_shaders
from experiments.gate.limits import Limits
from experiments.gate.measuring import measure_cases
from experiments.gate.verdicts import Verdict, judge
from experiments.suite import Case


@dataclass(frozen=True)
class Mutation:
    """One way to spoil the shaders.

    Attributes
    ----------
    name, meaning : str
    edits : tuple of Edit
    must : bool              whether the gate must notice it
    """

    name: str
    meaning: str
    edits: tuple[Edit, ...]
    must: bool = True


def _subtle(name: str, meaning: str, *edits: Edit) -> Mutation:
    return Mutation(name, meaning, edits, must=False)


INTERVALS = "visibility/parts/intervals.glsl"
MUTATIONS = (
    Mutation(
        "flipped g",
        "the Henyey-Greenstein lobe points backward",
        (Edit("phase/hg.glsl", "half_angle.y : half_angle.x", "half_angle.x : half_angle.y"),),
    ),
    Mutation(
        "dropped transmittance, eye",
        "the quadrature without the way from the piece's beginning to the eye",
        (Edit("airlight/quadrature.glsl", "exp(-extinction * (t0 + p.h * r_a))", "exp(-extinction * (p.h * r_a))"),),
    ),
    Mutation(
        "dropped transmittance, light",
        "point samples without the way from the light",
        (Edit("airlight/riemann.glsl", "exp(-sigma_t * (t + leg))", "exp(-sigma_t * t)"),),
    ),
    Mutation(
        "dropped transmittance, surface",
        "surfaces without fog between them and the eye",
        (Edit("combination.frag.glsl", "transmittance(leg.y - leg.x)", "transmittance(0.0)"),),
    ),
    Mutation(
        "shifted light",
        "by 1 % of its distance, for the models and not for the shadows",
        (
            Edit(
                "light.glsl",
                "light.position - ray.o;\n    // The cross",
                "light.position - ray.o;\n    to_light.y += 0.01 * length(to_light);\n    // The cross",
            ),
        ),
    ),
    Mutation(
        "half-step shift",
        "lit intervals begin and end at samples, not halfway between them",
        (Edit(INTERVALS, "(region.x + 0.5 * dt)", "(region.x + 1.0 * dt)"),),
    ),
    Mutation(
        "swapped front and final",
        "the first shadow polygon taken for the last",
        (Edit("shadow_region.glsl", "vec2(found.x, -found.y)", "vec2(-found.y, found.x)"),),
    ),
    Mutation(
        "unnormalised Rayleigh",
        "3/4 (1 + cos^2), as chapter 5 of the thesis prints it",
        (Edit("phase/rayleigh.glsl", "0.0596831036594608", "0.75"),),
    ),
    Mutation(
        "bilinear for bilateral",
        "every cell of the lattice is interpolated, whatever its corners see",
        (Edit("upsampling/bilateral.glsl", "if (agree(there))", "if (true)"),),
    ),
    Mutation(
        "grey samples",
        "point samples in fog that takes of each colour what it takes of red",
        (Edit("airlight/riemann.glsl", "exp(-sigma_t * (t + leg))", "exp(-sigma_t.xxx * (t + leg))"),),
    ),
    Mutation(
        "grey models",
        "models that work on a channel at a time get the red one's coefficient for green",
        (Edit("contract.glsl", "dt, sigma_t.y).y", "dt, sigma_t.x).y"),),
    ),
    Mutation(
        "red for blue",
        "the lights' colours the other way round, for point samples",
        (Edit("airlight/riemann.glsl", "light.intensity *", "light.intensity.bgr *"),),
    ),
    Mutation(
        "half a sun",
        "point samples of parallel light at half its strength",
        (Edit("airlight/riemann.glsl", "(DIRECTIONAL == 1 ? 1.0 : d2)", "(DIRECTIONAL == 1 ? 2.0 : d2)"),),
    ),
    Mutation(
        "unweighted cut",
        "a shifted march's cut step counts for what is left of it",
        (Edit("visibility/parts/march.glsl", "1.0 / part", "1.0"),),
    ),
    _subtle("g + 5 %", "of 0.6", Edit("phase/hg.glsl", "uniform float g;", "uniform float g;\n#define g (1.05 * g)")),
    _subtle(
        "sigma_t + 2 %",
        "in every pass, at the same sigma_s",
        Edit("contract.glsl", "uniform vec3 sigma_t;", "uniform vec3 sigma_t;\n#define sigma_t (1.02 * sigma_t)"),
    ),
    _subtle(
        "sigma_t + 0.1 %",
        "the same, twenty times smaller",
        Edit("contract.glsl", "uniform vec3 sigma_t;", "uniform vec3 sigma_t;\n#define sigma_t (1.001 * sigma_t)"),
    ),
    _subtle(
        "bias behind surfaces",
        "fog is lit for 1 % of the distance from the light too far, which shows behind thin surfaces alone",
        Edit("shadow_lookup.glsl", "> nearest_surface(light, point)", "> 1.01 * nearest_surface(light, point)"),
    ),
    _subtle(
        "bias before surfaces",
        "fog is dark for the last 1 % of the distance to what the light meets",
        Edit("shadow_lookup.glsl", "> nearest_surface(light, point)", "> 0.99 * nearest_surface(light, point)"),
    ),
    _subtle(
        "no bias on surfaces",
        "slanted surfaces shade themselves",
        Edit("surface_shadow.glsl", "slack * min(0.25 * slope, 0.5)", "0.0"),
    ),
    _subtle(
        "one sample more",
        "each lit interval is a sample too long",
        Edit(INTERVALS, "float(i - begin) * dt", "float(i - begin + 1) * dt"),
    ),
    _subtle(
        "last interval lost",
        "what is lit behind the shadow region, where light goes on there",
        Edit(INTERVALS, " + (i == steps ? behind : 0.0)", ""),
    ),
    _subtle(
        "half a texel",
        "the shadow map looked up half a texel beside",
        Edit("shadow_lookup.glsl", "* float(tile_size)), ivec2(", "* float(tile_size) + 0.5), ivec2("),
    ),
    _subtle(
        "pixel corners",
        "rays through the corners of pixels, surfaces through their centres",
        Edit("camera_ray.glsl", "vec3(on_view_plane(position), 1.0)", "vec3(on_view_plane(position - 0.5), 1.0)"),
    ),
    _subtle(
        "cone 1 % narrower",
        "a spot's half-angle, where pieces are cut at its cone",
        Edit("light.glsl", "sin(light.cutoff_angle)", "sin(0.99 * light.cutoff_angle)"),
    ),
    _subtle(
        "last node lost",
        "the quadrature without the last of its nodes",
        Edit("airlight/quadrature.glsl", "i < RULE_NODES;", "i < RULE_NODES - 1;"),
    ),
    _subtle(
        "wide bilateral",
        "neighbours count at ten times the difference in distance",
        Edit("upsampling/bilateral.glsl", "DISTANCE_SIGMA = 0.02", "DISTANCE_SIGMA = 0.2"),
    ),
)


@dataclass(frozen=True)
class Outcome:
    """What the gate said of a mutation.

    Attributes
    ----------
    mutation : Mutation
    failed : tuple of Verdict    those that noticed it, the farthest beyond its limit first
    """

    mutation: Mutation
    failed: tuple[Verdict, ...]

    @property
    def noticed(self) -> bool:
        """Whether the gate would have stopped it."""
        return bool(self.failed)


def try_mutation(mutation: Mutation, cases: Sequence[Case], limits: Limits) -> Outcome:
    """Measure cases with spoilt shaders.

    Raises
    ------
    InputError
        A text that the mutation changes is not in its shader.
    """
    with changed_shaders(mutation.edits):
        values = measure_cases(cases)
    failed = [verdict for verdict in judge(values, limits) if not verdict.passes]
    return Outcome(mutation, tuple(sorted(failed, key=lambda verdict: -verdict.badness)))
