"""What would end Mitsuba's parser is refused before it starts; whatever else it reads, it is let read."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest
from spoilt_scenes import GOOD, PAINT, SPOT

from scenes.catalogue import scene_path, shipped
from scenes.errors import InputError
from scenes.mitsuba_setup import parser_config
from scenes.xml_guard import MOST_LEVELS, check_xml

HEAD, TAIL = '<scene version="3.0.0">', "</scene>"


def nested(levels: int, inner: str = "") -> str:
    """So many elements within each other."""
    return '<bsdf type="twosided">' * levels + inner + "</bsdf>" * levels


def chain(links: int) -> str:
    """BSDFs that each refer to the next, and the last to none."""
    bsdfs = [f'<bsdf type="mask" id="b{link}"><ref id="b{link + 1}"/></bsdf>' for link in range(links - 1)]
    return "".join(bsdfs) + f'<bsdf type="diffuse" id="b{links - 1}"/>'


def write(folder: Path, text: str, name: str = "scene.xml", encoding: str = "utf-8") -> Path:
    path = folder / name
    path.write_text(text, encoding=encoding)
    return path


def refusal(path: Path, **parameters: str) -> str:
    with pytest.raises(InputError) as caught:
        check_xml(path, parameters)
    sentence = str(caught.value)
    assert sentence.endswith(".")
    assert "\n" not in sentence
    return sentence


def mitsuba_reads(path: Path) -> int:
    """How many nodes Mitsuba's parser makes of a file."""
    import mitsuba.parser as parser

    return len(parser.parse_file(parser_config(), str(path)).nodes)


@pytest.mark.parametrize("name", shipped())
def test_the_shipped_scenes_pass(name: str) -> None:
    check_xml(scene_path(name), {"phase": "hg", "g": "0.3"})


# --- depth -----------------------------------------------------------------------------------------------------------


def test_elements_nest_to_the_limit_and_no_deeper(tmp_path: Path) -> None:
    path = write(tmp_path, HEAD + nested(MOST_LEVELS - 1) + TAIL)
    check_xml(path, {})
    assert mitsuba_reads(path) == MOST_LEVELS
    path = write(tmp_path, HEAD + "\n" + nested(MOST_LEVELS) + TAIL)
    assert refusal(path).startswith(f"{path} (line 2): elements nest deeper than {MOST_LEVELS} levels")


def test_many_elements_side_by_side_are_not_deep(tmp_path: Path) -> None:
    check_xml(write(tmp_path, HEAD + '<bsdf type="diffuse"/><bsdf type="diffuse"></bsdf>' * 5000 + TAIL), {})


def test_what_the_guard_refuses_would_have_ended_the_process(tmp_path: Path) -> None:
    """The reason for the guard: 8,000 levels were enough."""
    path = write(tmp_path, HEAD + nested(100_000) + TAIL)
    refusal(path)
    code = (
        "import resource; resource.setrlimit(resource.RLIMIT_CORE, (0, 0))\n"
        "from scenes.mitsuba_setup import parser_config; config = parser_config()\n"
        f"import mitsuba.parser; mitsuba.parser.parse_file(config, {str(path)!r})"
    )
    assert subprocess.run([sys.executable, "-c", code], capture_output=True, timeout=60).returncode < 0


def test_depth_adds_up_through_includes(tmp_path: Path) -> None:
    write(tmp_path, HEAD + nested(60) + TAIL, "inner.xml")
    path = write(tmp_path, HEAD + nested(30, '<include filename="inner.xml"/>') + TAIL)
    check_xml(path, {})
    path = write(tmp_path, HEAD + nested(60, '<include filename="inner.xml"/>') + TAIL)
    assert refusal(path).startswith(f"{tmp_path / 'inner.xml'} (line 1): elements nest deeper")


@pytest.mark.parametrize(
    ("before", "include", "parameters"),
    [
        ("", "deep.xml", {}),
        ("", "$name.xml", {"name": "deep"}),
        ("", "./$name.xml", {"name": "deep", "nam": "shallow"}),
        ('<default name="name" value="deep"/>', "$name.xml", {}),
        ('<default name="a" value="de"/><default name="name" value="${a}ep"/>'.replace("{a}", "a"), "$name.xml", {}),
        ('<default name="name" value="shallow"/>', "$name.xml", {"name": "deep"}),
        ('<path value="folder"/>', "below.xml", {}),
        ("", "folder/below.xml", {}),
        ("", "folder/through.xml", {}),
        ("", "a&amp;b.xml", {}),
    ],
)
def test_included_files_are_found_as_mitsuba_finds_them(
    tmp_path: Path, before: str, include: str, parameters: dict[str, str]
) -> None:
    deep = HEAD + nested(MOST_LEVELS) + TAIL
    (tmp_path / "folder").mkdir()
    for name in ("deep.xml", "folder/below.xml", "a&b.xml"):
        write(tmp_path, deep, name)
    write(tmp_path, HEAD + TAIL, "shallow.xml")
    # relative to the file that includes, and only then to those around it
    write(tmp_path, HEAD + '<include filename="below.xml"/>' + TAIL, "folder/through.xml")
    path = write(tmp_path, f'{HEAD}{before}<include filename="{include}"/>{TAIL}')
    assert "elements nest deeper" in refusal(path, **parameters)


def test_an_absolute_include_is_followed(tmp_path: Path) -> None:
    deep = write(tmp_path, HEAD + nested(MOST_LEVELS) + TAIL, "deep.xml")
    assert str(deep) in refusal(write(tmp_path, f'{HEAD}<include filename="{deep}"/>{TAIL}'))


@pytest.mark.parametrize("include", ["none.xml", "", "/", "n" * 300, "$nothing.xml", "scene.xml"])
def test_includes_that_lead_nowhere_are_left_to_mitsuba(tmp_path: Path, include: str) -> None:
    check_xml(write(tmp_path, f'{HEAD}<include filename="{include}"/>{TAIL}'), {})


def test_chains_of_references_have_a_limit_too(tmp_path: Path) -> None:
    path = write(tmp_path, HEAD + chain(MOST_LEVELS - 1) + TAIL)
    check_xml(path, {})
    assert mitsuba_reads(path) == MOST_LEVELS
    for links in (MOST_LEVELS + 1, 60_000):
        assert "references follow one another" in refusal(write(tmp_path, HEAD + chain(links) + TAIL))


def test_a_long_circle_of_references_is_refused_and_a_short_one_left_to_mitsuba(tmp_path: Path) -> None:
    for links, good in ((5, True), (1000, False)):
        circle = chain(links).replace(f'id="b{links - 1}"/>', f'id="b{links - 1}"><ref id="b0"/></bsdf>')
        path = write(tmp_path, HEAD + circle + TAIL)
        if good:
            check_xml(path, {})
        else:
            assert "references follow one another" in refusal(path)


def test_many_references_to_one_object_are_no_chain(tmp_path: Path) -> None:
    shapes = '<shape type="sphere"><ref id="b0"/></shape>' * 2000
    check_xml(write(tmp_path, HEAD + chain(2) + shapes + TAIL), {})


# --- size ------------------------------------------------------------------------------------------------------------


def test_parameters_that_double_each_other_are_refused(tmp_path: Path) -> None:
    defaults = "".join(f'<default name="a{i + 1}" value="$a{i}$a{i}"/>' for i in range(60))
    path = write(tmp_path, f'{HEAD}<default name="a0" value="fog"/>{defaults}{TAIL}')
    assert "more than 1 MB; shorten them" in refusal(path)


def test_many_long_values_are_refused(tmp_path: Path) -> None:
    path = write(tmp_path, HEAD + '<string name="a" value="$long"/>' * 200 + TAIL)
    assert "grows beyond 64 MB" in refusal(path, long="fog" * 200_000)


def test_a_huge_file_is_refused_unread(tmp_path: Path) -> None:
    path = tmp_path / "huge.xml"
    with open(path, "wb") as file:
        file.truncate(1 << 40)
    assert "grows beyond 64 MB" in refusal(path)


def test_includes_that_branch_are_refused(tmp_path: Path) -> None:
    path = write(tmp_path, HEAD + '<include filename="scene.xml"/>' * 3 + TAIL)
    assert "includes more than 10000 files" in refusal(path)


@pytest.mark.parametrize("element", ["include", "spectrum name='a'"])
def test_a_pipe_is_not_waited_for(tmp_path: Path, element: str) -> None:
    os.mkfifo(tmp_path / "pipe")
    assert "device or a pipe" in refusal(write(tmp_path, f'{HEAD}<{element} filename="pipe"/>{TAIL}'))


@pytest.mark.parametrize("path", ["/proc/self/mem", "/dev/null", "/nowhere"])
def test_what_cannot_be_read_is_left_to_mitsuba(path: str) -> None:
    check_xml(Path(path), {})


# --- what is fine stays fine -----------------------------------------------------------------------------------------

MANY = MOST_LEVELS + 20
HARMLESS = {
    "comments": f"<!-- {nested(MANY)[: 22 * MANY]} -->",
    "comments with quotes": "<!-- don't -->" * MANY,
    "character data": f"<![CDATA[{'<a>' * MANY}]]>",
    "processing instructions": "<?a <b> ?>" * MANY,
    "text": "a > b " * MANY,
    "greater-than in an attribute": '<string name="a" value="x > y"/>' * MANY,
    "tags in an attribute": '<string name="a" value="<a><b>"/>' * MANY,
    "slashes in an attribute": '<string name="a" value="a/b/"></string>' * MANY,
    "single quotes around double ones": """<string name='a' value='"'></string>""" * MANY,
    "double quotes around single ones": """<string name="a" value="'"></string>""" * MANY,
    "spaces everywhere": '<bsdf  type = "diffuse"\n\t/><bsdf\ntype="diffuse" >\n</bsdf >' * MANY,
    "escaped parameter": r'<string name="a" value="\$b"/>' * MANY,
}


@pytest.mark.parametrize("case", HARMLESS)
@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16", "utf-16-le", "utf-32", "utf-32-be"])
def test_odd_but_shallow_xml_passes(tmp_path: Path, case: str, encoding: str) -> None:
    text = HARMLESS[case]
    # a name may be used once
    for number in range(MANY):
        text = text.replace('name="a"', f'name="a{number}"', 1).replace("name='a'", f"name='a{number}'", 1)
    path = write(tmp_path, GOOD.replace(SPOT, text + SPOT), encoding=encoding)
    check_xml(path, {})
    assert mitsuba_reads(path) >= 7


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16", "utf-16-be", "utf-32-le", "utf-32"])
def test_depth_is_seen_in_every_encoding(tmp_path: Path, encoding: str) -> None:
    text = f'<?xml version="1.0"?><!DOCTYPE scene [<!ENTITY a "<b>">]><!-- fog -->{HEAD}{nested(MANY)}{TAIL}'
    path = write(tmp_path, text, encoding=encoding)
    assert mitsuba_reads(path) == MANY + 1
    assert "elements nest deeper" in refusal(path)


@pytest.mark.parametrize("text", ["", "fog", "<", "<<<<", "<scene", "</scene>", "<scene>" * 50, "\0<scene>", "<!-- "])
def test_what_is_no_xml_is_left_to_mitsuba(tmp_path: Path, text: str) -> None:
    check_xml(write(tmp_path, text), {})


def test_a_good_scene_with_depth_in_its_paint_is_refused(tmp_path: Path) -> None:
    assert "elements nest deeper" in refusal(write(tmp_path, GOOD.replace(PAINT, nested(1500, PAINT))))
