"""Mitsuba's own parse of a scene file, or one sentence why there is none."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

from scenes.errors import InputError
from scenes.messages import one_sentence
from scenes.mitsuba_setup import mitsuba, parser_config
from scenes.xml_guard import check_xml
from scenes.xml_nodes import Node

# plugins that read a file
READ_FILES = ("ply", "obj", "bitmap")


def parse(path: Path, parameters: dict[str, str]) -> Any:
    """Parse a scene file.

    Parameters
    ----------
    parameters : values for the file's `$name` parameters

    Returns
    -------
    mitsuba.parser.ParserState   after `transform_all`; files that a folder named by <path> holds have their full path

    Raises
    ------
    InputError
        The file cannot be parsed, or Mitsuba would leave part of it out without a word.
    """
    check_xml(path, parameters)
    config = parser_config()
    import mitsuba.parser as parser

    # <path> elements add folders to Mitsuba's list, which would serve every later scene of this process too
    resolver = mitsuba().file_resolver()
    before = [str(folder) for folder in resolver]
    try:
        state = parser.parse_file(config, str(path), **parameters)
        parser.transform_all(config, state)
        named = list(resolver)
        _find_in(named[: len(named) - len(before)], state)
        # text of another encoding passes the parser, and breaks whoever reads it
        for node in state.nodes:
            _ = node.props.id(), node.props.plugin_name(), list(node.props.items())
    except UnicodeDecodeError:
        raise InputError(f"{path} is not UTF-8; save it as UTF-8.") from None
    except (RuntimeError, ValueError) as error:
        raise InputError(one_sentence(path, str(error))) from None
    finally:
        resolver.clear()
        for folder in before:
            resolver.append(folder)
    _check_all_reached(state)
    return state


def _find_in(folders: list[Any], state: Any) -> None:
    """Spell out the path of each file that is found in one of the folders that the scene names by <path>."""
    for node in state.nodes:
        name = node.props["filename"] if node.props.plugin_name() in READ_FILES and "filename" in node.props else None
        if isinstance(name, str) and not Path(name).is_absolute():
            found = [path for path in (Path(str(folder), name) for folder in folders) if os.path.isfile(path)]
            if found:
                node.props["filename"] = str(found[0].absolute())


def reached(state: Any) -> dict[int, Any]:
    """Nodes of the parse that the scene holds, by their index."""
    found: dict[int, Any] = {}
    waiting = [0]
    while waiting:
        index = waiting.pop()
        if index not in found:
            found[index] = node = state.nodes[index]
            values = (value for _, value in node.props.items())
            waiting += [value.index() for value in values if isinstance(value, mitsuba().Properties.ResolvedReference)]
    return found


def _check_all_reached(state: Any) -> None:
    """Refuse a nested plugin that a later one of the same name replaced: Mitsuba's parser says nothing."""
    held = reached(state)
    for index in range(len(state.nodes)):
        if index not in held:
            raise Node(state, index).refuse("is replaced by a later one of the same name beside it; leave one out.")


def drop(node: Node, kind: str) -> None:
    """Take the nested plugins of a kind out of the parse, so that Mitsuba does not make what airlight replaces."""
    for name in list(node.props.keys()):
        value = node.props[name]
        if isinstance(value, mitsuba().Properties.ResolvedReference) and Node(node.state, value.index()).kind == kind:
            del node.props[name]
