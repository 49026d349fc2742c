"""Ways to spoil a scene file: its tree, its values and, in byte_mutations, its bytes. Chance comes from the caller."""

from __future__ import annotations

import copy
import xml.etree.ElementTree as ET
from collections.abc import Callable
from random import Random

from byte_mutations import BYTE_CHANGES
from pools import INCLUDES, NAMES, PLUGINS, SIZES, TAGS, TRANSFORMS, VALUES


def spoil(text: str, rng: Random) -> bytes:
    """Change a scene file in one to four places, often so that it may stay good; one time in five, its bytes."""
    root = ET.fromstring(text)
    changes = GENTLE_CHANGES if rng.random() < 0.5 else TREE_CHANGES
    for _ in range(rng.choice((1, 1, 1, 1, 2, 2, 3, 4))):
        rng.choice(changes)(root, rng)
    spoilt = ET.tostring(root, encoding="unicode")
    if rng.random() < 0.2:
        return rng.choice(BYTE_CHANGES)(spoilt if rng.random() < 0.3 else text, rng)
    return spoilt.encode("utf-8", "surrogatepass")


# --- the tree --------------------------------------------------------------------------------------------------------


def _any(root: ET.Element, rng: Random, wanted: Callable[[ET.Element], bool] = lambda element: True) -> ET.Element:
    found = [element for element in root.iter() if wanted(element)]
    return rng.choice(found) if found else root


def _parent_and_place(root: ET.Element, rng: Random) -> tuple[ET.Element, int]:
    parent = _any(root, rng, lambda element: len(element) > 0)
    return parent, rng.randrange(len(parent)) if len(parent) else 0


def _delete(root: ET.Element, rng: Random) -> None:
    parent, place = _parent_and_place(root, rng)
    del parent[place : place + 1]


def _duplicate(root: ET.Element, rng: Random) -> None:
    parent, place = _parent_and_place(root, rng)
    for _ in range(rng.choice((1, 1, 1, 2, 5))):
        for element in parent[place : place + 1]:
            twin = copy.deepcopy(element)
            if rng.random() < 0.7:
                for inner in twin.iter():
                    inner.attrib.pop("id", None) if inner.tag != "ref" else None
            parent.insert(rng.randrange(len(parent) + 1), twin)


def _swap(root: ET.Element, rng: Random) -> None:
    (one, i), (other, j) = _parent_and_place(root, rng), _parent_and_place(root, rng)
    if i < len(one) and j < len(other):
        first, second = copy.deepcopy(one[i]), copy.deepcopy(other[j])
        one[i] = second
        if j < len(other):
            other[j] = first


def _move(root: ET.Element, rng: Random) -> None:
    parent, place = _parent_and_place(root, rng)
    for element in parent[place : place + 1]:
        moved = copy.deepcopy(element)
        parent.remove(element)
        _any(root, rng).append(moved)


def _shuffle(root: ET.Element, rng: Random) -> None:
    rng.shuffle(children := list(root))
    root[:] = children


def _set(attribute: str, choices: tuple[str, ...]) -> Callable[[ET.Element, Random], None]:
    def change(root: ET.Element, rng: Random) -> None:
        _any(root, rng, lambda element: attribute in element.attrib).set(attribute, rng.choice(choices))

    return change


def _value(root: ET.Element, rng: Random) -> None:
    """Put an odd value in place of a value, a coordinate, or one of several numbers."""
    element = _any(root, rng, lambda found: bool({"value", "x", "origin", "angle"} & set(found.attrib)))
    keys = [key for key in element.attrib if key != "name"]
    if not keys:
        return
    key, odd = rng.choice(keys), rng.choice(VALUES)
    parts = element.attrib[key].replace(",", " ").split()
    if len(parts) > 1 and rng.random() < 0.6:
        parts[rng.randrange(len(parts))] = odd
        odd = ", ".join(parts)
    element.set(key, odd)


def _number(root: ET.Element, rng: Random) -> None:
    """Scale one number by a power of ten, or turn its sign: many of these stay good."""
    element = _any(
        root, rng, lambda found: "value" in found.attrib and found.tag in ("float", "integer", "rgb", "scale")
    )
    try:
        number = float(element.attrib["value"])
    except (KeyError, ValueError):
        return
    element.set("value", f"{number * rng.choice((-1, 0.1, 0.5, 2, 10, 1e3, 1e6, 1e-3, 1e-6)):.9g}")


def _tag(root: ET.Element, rng: Random) -> None:
    _any(root, rng).tag = rng.choice(TAGS)


def _drop_attribute(root: ET.Element, rng: Random) -> None:
    element = _any(root, rng, lambda found: bool(found.attrib))
    if element.attrib:
        del element.attrib[rng.choice(list(element.attrib))]


def _add_attribute(root: ET.Element, rng: Random) -> None:
    _any(root, rng).set(
        rng.choice(("name", "id", "type", "value", "x", "version", "filename", "fog")), rng.choice(VALUES)
    )


def _add_property(root: ET.Element, rng: Random) -> None:
    parent = _any(root, rng, lambda element: "type" in element.attrib)
    attributes = {"name": rng.choice(NAMES), "value": rng.choice(VALUES)}
    ET.SubElement(
        parent, rng.choice(("float", "integer", "string", "boolean", "rgb", "spectrum", "vector")), attributes
    )


def _add_plugin(root: ET.Element, rng: Random) -> None:
    parent = _any(root, rng, lambda element: "type" in element.attrib or element.tag == "scene")
    ET.SubElement(parent, rng.choice(TAGS[13:28]), {"type": rng.choice(PLUGINS)})


def _transform(root: ET.Element, rng: Random) -> None:
    place = _any(root, rng, lambda element: element.tag == "transform")
    if place is root:
        parent = _any(root, rng, lambda element: "type" in element.attrib)
        place = ET.SubElement(parent, "transform", {"name": "to_world"})
    place.insert(rng.randrange(len(place) + 1), ET.fromstring(rng.choice(TRANSFORMS)))


def _reference(root: ET.Element, rng: Random) -> None:
    """Let a reference name something else, or add one: to itself, in a circle, to the wrong kind."""
    ids = [element.attrib["id"] for element in root.iter() if "id" in element.attrib] or ["a"]
    target = rng.choice([*ids, "none", ""])
    if rng.random() < 0.5:
        _any(root, rng, lambda element: element.tag == "ref").set("id", target)
    else:
        parent = _any(root, rng, lambda element: "type" in element.attrib)
        ET.SubElement(parent, "ref", {"id": target} | ({"name": rng.choice(NAMES)} if rng.random() < 0.5 else {}))


def _rename_id(root: ET.Element, rng: Random) -> None:
    ids = [element.attrib["id"] for element in root.iter() if "id" in element.attrib] or ["a"]
    _any(root, rng, lambda element: "id" in element.attrib).set("id", rng.choice([*ids, *VALUES]))


def _include(root: ET.Element, rng: Random) -> None:
    parent = _any(root, rng, lambda element: len(element) > 0)
    for _ in range(rng.choice((1, 1, 2, 4))):
        parent.insert(0, ET.Element("include", {"filename": rng.choice(INCLUDES)}))


def _nest(root: ET.Element, rng: Random) -> None:
    """Put an element into copies of itself."""
    element = _any(root, rng, lambda found: "type" in found.attrib)
    attributes = {key: value for key, value in element.attrib.items() if key != "id"}
    inner = ET.Element(element.tag, attributes)
    inner[:] = list(element)
    element[:] = []
    place = element
    # Python's own writer of XML recurses
    for _ in range(rng.choice((1, 1, 2, 5, 30, 98, 99, 100, 150))):
        place = ET.SubElement(place, element.tag, attributes)
    place.append(inner)


def _size(root: ET.Element, rng: Random) -> None:
    sizes = [element for element in root.iter() if element.get("name") in ("width", "height")]
    for element in sizes if rng.random() < 0.5 else sizes[:1]:
        element.set("value", rng.choice(SIZES))


def _default(root: ET.Element, rng: Random) -> None:
    found = _any(root, rng, lambda element: element.tag == "default")
    if found is root or rng.random() < 0.3:
        root.insert(
            0, ET.Element("default", {"name": rng.choice(NAMES), "value": rng.choice(("$x", "1", "$sigma_t", ""))})
        )
    else:
        found.set("value", rng.choice((*VALUES, "$sigma_t", "$albedo", "rayleigh", "hg", "isotropic")))


def _doubling(root: ET.Element, rng: Random) -> None:
    for power in reversed(range(rng.choice((3, 30)))):
        root.insert(0, ET.Element("default", {"name": f"d{power + 1}", "value": f"$d{power}$d{power}"}))
    root.insert(0, ET.Element("default", {"name": "d0", "value": "fog"}))


TREE_CHANGES: tuple[Callable[[ET.Element, Random], None], ...] = (
    *(_delete, _duplicate, _swap, _move, _shuffle, _value, _value, _value, _value, _number, _number, _number, _number),
    *(_set("type", PLUGINS), _set("type", PLUGINS), _set("name", NAMES), _set("name", NAMES), _set("version", VALUES)),
    *(_tag, _drop_attribute, _add_attribute, _add_property, _add_property, _add_plugin, _add_plugin, _transform),
    *(_transform, _transform, _reference, _reference, _rename_id, _include, _nest, _size, _default, _doubling),
)
GENTLE_CHANGES = (_number, _number, _number, _transform, _shuffle, _delete, _duplicate, _swap, _size, _reference)
