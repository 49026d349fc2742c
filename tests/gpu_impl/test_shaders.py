"""Every shader file compiles, alone and in every combination, and a mistake in one is reported with its place."""

from __future__ import annotations

from pathlib import Path

import pytest

from analytic.phase import PHASES, Phase, phase
from gpu_impl import shader_source
from gpu_impl.airlight_models import AIRLIGHT_MODELS
from gpu_impl.context import shared_context
from gpu_impl.device import Device
from gpu_impl.lattices import LATTICES
from gpu_impl.passes.shadow_volume import VERTEX_BLOCKS
from gpu_impl.shader_source import SHADERS, ShaderError, ShaderSource, compile_compute, compile_program
from gpu_impl.visibilities import VISIBILITIES

FILES = sorted(path.relative_to(SHADERS).as_posix() for path in SHADERS.rglob("*.glsl"))
INCLUDES = [name for name in FILES if not name.endswith((".vert.glsl", ".frag.glsl", ".comp.glsl"))]
MAINS = [name for name in FILES if name not in INCLUDES]
FULLSCREEN = ShaderSource("fullscreen.vert.glsl")
# vertex shaders of the scattering pass, which has its combinations to itself
DRAWN = {strategy.vertex for strategy in VISIBILITIES.values()} - {"fullscreen.vert.glsl"}
FRAGMENTS = [name for name in MAINS if name.endswith(".frag.glsl") and name != "scattering.frag.glsl"]
COMPUTES = [name for name in MAINS if name.endswith(".comp.glsl")]


def vertex_of(fragment: str) -> str:
    """A pass's vertex shader has its fragment shader's name, or is that of a full screen."""
    own = fragment.replace(".frag.", ".vert.")
    return own if own in FILES else "fullscreen.vert.glsl"


# vertex and fragment shader of each pass
PASSES = [*((vertex_of(name), name) for name in FRAGMENTS), ("upsampling/edges.vert.glsl", "combination.frag.glsl")]
# what stands for the parts of a technique where any will do
PARTS = {
    "<airlight>": "airlight/riemann.glsl",
    "<lattice>": "lattice/grid.glsl",
    "<phase>": "phase/isotropic.glsl",
    "<upsampling>": "upsampling/bilateral.glsl",
}
RECONSTRUCTIONS = sorted({kind.reconstruction for kind in LATTICES.values() if kind.reconstruction})
RAY_AND_LIGHT = "Ray(vec3(0), vec3(0, 0, 1), 1.0), Light(vec3(1), vec3(0, 0, 1), vec3(1), 3.14, 3.14)"
LIT = "void lit(float t0, float dt, float w) { result += vec4(t0, dt, w, 1.0); }\n"
# what the contract leaves to the other parts, and a call, so that the linker keeps what is tested
STUBS = {
    "airlight": f"void main() {{ result = vec4(airlight({RAY_AND_LIGHT}, 0.0, 1.0), 0.0); }}",
    "visibility": f"{LIT}void main() {{ result = vec4(0.0); visibility({RAY_AND_LIGHT}); }}",
    "visibility/parts": f"{LIT}void main() {{ result = vec4(0.0); }}",
    "phase": "void main() { result = vec4(phase(vec2(0.25, 0.75)), phase_scale(), 0.0, 0.0); }",
    "upsampling": "void main() { result = upsampled(ivec2(0)); }",
    "lattice": "void main() { result = vec4(position_of(ivec2(0)), 0.0, 0.0); }",
    "reconstruction": "void main() { result = upsampled(ivec2(0)); }",
    "": "void main() { result = vec4(1.0); }",
}


# what a pass defines for a cube map, coloured fog that fills space and a light without a picture
PLAIN = {
    "LIGHT_LEG": 1,
    "SOFT_SHADOWS": 0,
    "DOWNSAMPLED": 1,
    "SPLIT": 1,
    "TILES": 6,
    "GREY": 0,
    "STEPS": 4,
    "DIRECTIONAL": 0,
    "WHOLE_LEG": 1,
    "FOG_PLANES": 0,
    "FOG_BALL": 0,
    "SPOT": 0,
    "SPOT_TEXTURE": 0,
    "SPECULAR": 0,
    "GROUP": 64,
    "DEPTH_ONLY": 0,
    "PICTURE": 0,
    "CULL": 0,
    "SHADOW_GIVEN": 0,
    "AIRLIGHT_AT_CORNERS": 0,
    "IN_STEPS": 0,
    **{name: value for strategy in VISIBILITIES.values() for name, value in strategy.defines.items()},
}
VARIANTS = [
    PLAIN,
    PLAIN | {"TILES": 1, "SOFT_SHADOWS": 1, "GREY": 1, "SPOT": 2, "SPOT_TEXTURE": 1, "PICTURE": 1, "CULL": 1},
    PLAIN | {"SOFT_SHADOWS": 1, "SHADOW_BUFFER": 2, "FOG_PLANES": 6, "WHOLE_LEG": 0},
    PLAIN | {"TILES": 1, "SPOT": 1, "FOG_BALL": 1, "WHOLE_LEG": 0, "SPECULAR": 1},
    PLAIN | {"TILES": 1, "DIRECTIONAL": 1, "GREY": 1, "FOG_PLANES": 64, "WHOLE_LEG": 0},
]
# what is asked about the ray of one's own cell can be told by rays
OF_RAYS = [*VARIANTS, PLAIN | {"SHADOW_GIVEN": 1}]


EXAMPLES = [
    phase("isotropic"),
    phase("rayleigh"),
    phase("hg", g=0.6),
    phase("schlick", k=0.6),
    phase("cornette_shanks", g=0.6),
    phase("tabulated", values=(1.0, 2.0, 4.0)),
]


def assembled(main: str, **settings) -> ShaderSource:
    # what any of the models has computed for it: some share a name, none needs more than there is for it
    computed = {name: text for model in AIRLIGHT_MODELS.values() for name, text in model.generated(EXAMPLES[0]).items()}
    generated = {"<main>": main, **computed, **settings.pop("generated", {})}
    return ShaderSource("<main>", settings.pop("defines", PLAIN), PARTS, generated)


def compiled(source: ShaderSource, vertex: ShaderSource = FULLSCREEN) -> None:
    compile_program(shared_context(), vertex, source).release()


@pytest.mark.parametrize("name", INCLUDES)
def test_an_include_compiles_on_its_own(name: str) -> None:
    folder = Path(name).parent.as_posix().removeprefix(".")
    # parts of a model are not models
    if folder.startswith("airlight") and name not in {model.source for model in AIRLIGHT_MODELS.values()}:
        folder = ""
    if name in RECONSTRUCTIONS:
        folder = "reconstruction"
    if folder not in STUBS or (folder == "lattice" and name not in {kind.source for kind in LATTICES.values()}):
        folder = ""
    # a part of the quadrature asks for what comes before it there
    before = '#include "<phase>"\n#include "<gauss-legendre>"\n' if name == "airlight/part_of_the_leg.glsl" else ""
    for variant in OF_RAYS:
        defines = variant
        main = f'out vec4 result;\n{before}#include "{name}"\n{STUBS[folder]}\n'
        # a drawn strategy is handed what its own vertex shader finds
        strategy = next((one for one in VISIBILITIES.values() if one.source == name), None)
        vertex = strategy.vertex if strategy else FULLSCREEN.files[0]
        if strategy and strategy.given:
            defines = variant | {"SHADOW_GIVEN": 1}
        compiled(assembled(main, defines=defines), ShaderSource(vertex, defines, PARTS))


@pytest.mark.parametrize(("vertex", "fragment"), PASSES)
@pytest.mark.parametrize("defines", VARIANTS, ids=str)
def test_a_pass_compiles(vertex: str, fragment: str, defines: dict[str, int]) -> None:
    for reconstruction in RECONSTRUCTIONS if fragment == "reconstruction.frag.glsl" else ["none"]:
        source = ShaderSource(fragment, defines, PARTS | {"<reconstruction>": reconstruction})
        compile_program(shared_context(), ShaderSource(vertex, defines, PARTS), source).release()


@pytest.mark.parametrize("name", COMPUTES)
@pytest.mark.parametrize("defines", VARIANTS, ids=str)
def test_a_compute_pass_compiles(name: str, defines: dict[str, int]) -> None:
    compile_compute(shared_context(), ShaderSource(name, defines, PARTS)).release()


def test_a_mistake_in_a_compute_shader_is_reported_with_its_place() -> None:
    source = ShaderSource("<main>", generated={"<main>": "void main() {\n    no_such_name = 1.0;\n}"})
    with pytest.raises(ShaderError, match=r"<main>:2\b"):
        compile_compute(shared_context(), source)


def test_the_polygons_declare_no_more_storage_blocks_than_they_say() -> None:
    # std430 blocks count whether they are read or not
    text = ShaderSource("shadow_volume/polygon.vert.glsl", PLAIN).text
    assert text.count("layout(std430") == VERTEX_BLOCKS


def test_every_file_is_covered() -> None:
    assert {name for pair in PASSES for name in pair} | DRAWN | {"scattering.frag.glsl", *COMPUTES} == set(MAINS)
    registered = {model.source for model in AIRLIGHT_MODELS.values()} | {v.source for v in VISIBILITIES.values()}
    registered |= {kind.source for kind in LATTICES.values()} | set(RECONSTRUCTIONS)
    assert registered <= set(INCLUDES)
    assert {f"phase/{name}.glsl" for name in PHASES} <= set(INCLUDES)
    assert {function.name for function in EXAMPLES} == set(PHASES)


TAKEN = [
    pytest.param(name, function, id=f"{name} {function.name}")
    for name, model in AIRLIGHT_MODELS.items()
    for function in EXAMPLES
    if model.phases is None or function.name in model.phases
]


def compiled_cell(visibility: str, airlight: str, function: Phase, variants: list[dict[str, int]]) -> None:
    model, strategy, device = AIRLIGHT_MODELS[airlight], VISIBILITIES[visibility], Device(shared_context())
    for variant in variants:
        if variant["SHADOW_GIVEN"] == 1 and not (strategy.asks_points or strategy.given):
            continue
        defines = variant | ({"SHADOW_GIVEN": 1} if strategy.given else {})
        program = device.program(
            "scattering.frag.glsl",
            strategy.vertex,
            defines=defines
            | strategy.defines
            | {"AIRLIGHT_AT_CORNERS": int(strategy.airlight_at_corners)}
            | {"IN_STEPS": int(strategy.in_steps)},
            includes=PARTS
            | {
                "<airlight>": model.source,
                "<visibility>": strategy.source,
                "<phase>": f"phase/{function.name}.glsl",
            },
            generated=model.generated(function),
        )
        # the driver asked the strategy, and the strategy the model
        assert "sigma_s" in program
        # one that says that the map's resolution is no part of its error does not read it, nor does a control
        if not strategy.reads_shadow_map or defines["SHADOW_GIVEN"] == 1:
            assert not {"shadow_map", "ShadowTexels"} & set(program)
    device.release()


@pytest.mark.parametrize(("airlight", "function"), TAKEN)
def test_every_model_compiles_with_its_phase_functions(airlight: str, function: Phase) -> None:
    # a model for lights in the fog meets no other
    variants = OF_RAYS if AIRLIGHT_MODELS[airlight].any_light else [v for v in OF_RAYS if v["WHOLE_LEG"] == 1]
    compiled_cell("lit_intervals", airlight, function, variants)


@pytest.mark.parametrize("visibility", VISIBILITIES)
@pytest.mark.parametrize("airlight", AIRLIGHT_MODELS)
def test_every_visibility_compiles_with_every_model(visibility: str, airlight: str) -> None:
    # neither knows the other, so that names are all they can quarrel about: one model sees all variants, the others one
    compiled_cell(visibility, airlight, EXAMPLES[0], OF_RAYS if airlight == "riemann" else VARIANTS[1:2])


@pytest.mark.parametrize("include", INCLUDES)
def test_a_mistake_in_an_include_is_reported_with_its_file_and_line(
    include: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    for name in FILES:
        (tmp_path / name).parent.mkdir(exist_ok=True, parents=True)
        (tmp_path / name).write_text((SHADERS / name).read_text(encoding="utf-8"), encoding="utf-8")
    lines = (SHADERS / include).read_text(encoding="utf-8").splitlines()
    # at the end, so behind whatever the file includes itself
    mistake = [*lines, "float planted() {", "    return no_such_name;", "}"]
    (tmp_path / include).write_text("\n".join(mistake), encoding="utf-8")
    monkeypatch.setattr(shader_source, "SHADERS", tmp_path)
    source = assembled(f'out vec4 result;\n#include "{include}"\nvoid main() {{ result = vec4(0.0); }}')
    with pytest.raises(ShaderError, match=rf"{include}:{len(lines) + 2}\b") as caught:
        compiled(source)
    assert "no_such_name" in str(caught.value)


def test_lines_are_counted_on_behind_an_include() -> None:
    source = assembled(
        'out vec4 result;\n#include "<inner>"\nvoid main() {\n    result = no_such_name;\n}',
        generated={"<inner>": "float inner() {\n    return 1.0;\n}"},
    )
    with pytest.raises(ShaderError, match=r"<main>:4\b"):
        compiled(source)


def test_a_mistake_in_a_vertex_shader_names_the_vertex_shader() -> None:
    vertex = ShaderSource("<main>", generated={"<main>": "void main() {\n    gl_Position = no_such_name;\n}"})
    with pytest.raises(ShaderError, match=r"<main>:2\b"):
        compile_program(shared_context(), vertex, assembled("out vec4 result;\nvoid main() { result = vec4(0.0); }"))


def test_a_missing_definition_is_an_error() -> None:
    # a strategy without a driver: `lit` is declared by the contract and defined by nobody
    main = f'out vec4 result;\n#include "visibility/uniform_march.glsl"\nvoid main() {{ visibility({RAY_AND_LIGHT}); }}'
    with pytest.raises(ShaderError, match="lit"):
        compiled(assembled(main))


def test_a_file_is_included_once() -> None:
    twice = '#include "<inner>"\n' * 2
    source = assembled(
        f'out vec4 result;\n{twice}#include "<other>"\nvoid main() {{ result = vec4(inner()); }}',
        generated={"<inner>": "float inner() { return 1.0; }", "<other>": '#include "<inner>"\n'},
    )
    assert source.text.count("float inner()") == 1
    compiled(source)


def test_files_that_include_each_other_end() -> None:
    source = assembled(
        'out vec4 result;\n#include "<a>"\nvoid main() { result = vec4(b()); }',
        generated={
            "<a>": '#include "<b>"\nfloat a() { return 1.0; }',
            "<b>": '#include "<a>"\nfloat b() { return 2.0; }',
        },
    )
    compiled(source)


def test_definitions_come_before_everything_else() -> None:
    main = "out vec4 result;\n#if STEPS != 7\n#error STEPS\n#endif\nvoid main() { result = vec4(0.0); }"
    compiled(assembled(main, defines={"STEPS": 7}))
    with pytest.raises(ShaderError, match=r"<main>:3\b"):
        compiled(assembled(main, defines={"STEPS": 8}))


def test_an_include_that_does_not_exist_is_named() -> None:
    with pytest.raises(FileNotFoundError, match="nowhere"):
        assembled('#include "nowhere.glsl"\n')
