"""Every shader file compiles, alone and in every combination, and a mistake in one is reported with its place."""

from __future__ import annotations

from pathlib import Path

import pytest

from analytic.phase import PHASES
from gpu_impl import shader_source
from gpu_impl.airlight_models import AIRLIGHT_MODELS
from gpu_impl.context import shared_context
from gpu_impl.device import Device
from gpu_impl.shader_source import SHADERS, ShaderError, ShaderSource, compile_program
from gpu_impl.visibilities import VISIBILITIES

FILES = sorted(path.relative_to(SHADERS).as_posix() for path in SHADERS.rglob("*.glsl"))
INCLUDES = [name for name in FILES if not name.endswith((".vert.glsl", ".frag.glsl"))]
FULLSCREEN = ShaderSource("fullscreen.vert.glsl")
# vertex and fragment shader of each pass; the scattering pass has the combinations below to itself
PASSES = [
    ("geometry.vert.glsl", "geometry.frag.glsl"),
    ("shadow_map.vert.glsl", "shadow_map.frag.glsl"),
    ("fullscreen.vert.glsl", "surface.frag.glsl"),
    ("fullscreen.vert.glsl", "combination.frag.glsl"),
]
RAY_AND_LIGHT = "Ray(vec3(0), vec3(0, 0, 1), 1.0), Light(vec3(1), vec3(0, 0, 1), vec3(1), 3.14, 3.14, false)"
# what the contract leaves to the other parts, and a call, so that the linker keeps what is tested
STUBS = {
    "airlight": f"void main() {{ result = vec4(airlight({RAY_AND_LIGHT}, 0.0, 1.0), 0.0); }}",
    "visibility": "void lit(float t0, float dt, float w) { result += vec4(t0, dt, w, 1.0); }\n"
    f"void main() {{ result = vec4(0.0); visibility({RAY_AND_LIGHT}); }}",
    "phase": "void main() { result = vec4(phase(vec2(0.25, 0.75)), phase_scale(), 0.0, 0.0); }",
    "upsampling": "void main() { result = upsampled(ivec2(0)); }",
    "": "void main() { result = vec4(1.0); }",
}


# what a pass defines for a cube map, coloured fog that fills space and a light without a picture
PLAIN = {
    "LIGHT_LEG": 1,
    "DOWNSAMPLED": 1,
    "SPLIT": 1,
    "TILES": 6,
    "GREY": 0,
    "STEPS": 4,
    "WHOLE_LEG": 1,
    "FOG_PLANES": 0,
    "FOG_BALL": 0,
    "SPOT_TEXTURE": 0,
}
VARIANTS = [
    PLAIN,
    PLAIN | {"TILES": 1, "GREY": 1, "SPOT_TEXTURE": 1},
    PLAIN | {"FOG_PLANES": 6, "WHOLE_LEG": 0},
    PLAIN | {"TILES": 1, "FOG_BALL": 1, "WHOLE_LEG": 0},
    PLAIN | {"GREY": 1, "FOG_PLANES": 64, "SPOT_TEXTURE": 1, "WHOLE_LEG": 0},
]


def assembled(main: str, **settings) -> ShaderSource:
    generated = {"<main>": main, **AIRLIGHT_MODELS["quadrature"].generated, **settings.pop("generated", {})}
    includes = {"<phase>": "phase/isotropic.glsl"}
    return ShaderSource("<main>", settings.pop("defines", PLAIN), includes, generated)


def compiled(source: ShaderSource) -> None:
    compile_program(shared_context(), FULLSCREEN, source).release()


@pytest.mark.parametrize("name", INCLUDES)
def test_an_include_compiles_on_its_own(name: str) -> None:
    folder = Path(name).parent.as_posix().removeprefix(".")
    # parts of a model are not models
    if name in ("airlight/exponential_integral.glsl", "airlight/part_of_the_leg.glsl", "upsampling/lattice.glsl"):
        folder = ""
    # a part of the quadrature asks for what comes before it there
    before = '#include "<phase>"\n#include "<gauss-legendre>"\n' if name == "airlight/part_of_the_leg.glsl" else ""
    for defines in VARIANTS:
        main = f'out vec4 result;\n{before}#include "{name}"\n{STUBS[folder]}\n'
        compiled(assembled(main, defines=defines))


@pytest.mark.parametrize(("vertex", "fragment"), PASSES)
@pytest.mark.parametrize("defines", VARIANTS, ids=str)
def test_a_pass_compiles(vertex: str, fragment: str, defines: dict[str, int]) -> None:
    source = ShaderSource(fragment, defines, {"<upsampling>": "upsampling/bilateral.glsl"})
    compile_program(shared_context(), ShaderSource(vertex), source).release()


def test_every_file_is_covered() -> None:
    mains = {name for pair in PASSES for name in pair} | {"scattering.frag.glsl"}
    assert mains | set(INCLUDES) == set(FILES)
    registered = {model.source for model in AIRLIGHT_MODELS.values()} | {v.source for v in VISIBILITIES.values()}
    assert registered <= set(INCLUDES)
    assert {f"phase/{name}.glsl" for name in PHASES} <= set(INCLUDES)


@pytest.mark.parametrize("visibility", VISIBILITIES)
@pytest.mark.parametrize("airlight", AIRLIGHT_MODELS)
@pytest.mark.parametrize("phase", PHASES)
def test_every_combination_compiles(visibility: str, airlight: str, phase: str) -> None:
    device = Device(shared_context())
    for defines in VARIANTS:
        program = device.program(
            "scattering.frag.glsl",
            defines=defines,
            includes={
                "<airlight>": AIRLIGHT_MODELS[airlight].source,
                "<visibility>": VISIBILITIES[visibility].source,
                "<phase>": f"phase/{phase}.glsl",
            },
            generated=AIRLIGHT_MODELS[airlight].generated,
        )
        # the driver asked the strategy, and the strategy the model
        assert "sigma_s" in program
        assert "shadow_map" in program
    device.release()


@pytest.mark.parametrize("include", INCLUDES)
def test_a_mistake_in_an_include_is_reported_with_its_file_and_line(
    include: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    for name in FILES:
        (tmp_path / name).parent.mkdir(exist_ok=True)
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
