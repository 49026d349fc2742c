"""Reads a suite's file, changes it as `--set` says, and names the key and the line of what is wrong."""

from __future__ import annotations

import os
import tomllib
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from experiments.suite.schema import Product, Suite
from scenes.errors import InputError
from scenes.file_names import check_name
from scenes.messages import readable

FOLDER = Path(__file__).parent.parent / "suites"
Key = tuple[str | int, ...]


def shipped() -> list[str]:
    """Names of the shipped suites."""
    return sorted(path.stem for path in FOLDER.glob("*.toml"))


def load_suite(suite: str, changes: Sequence[str] = ()) -> tuple[str, Suite]:
    """Read a suite by name or path.

    Parameters
    ----------
    changes : texts "key=value", each as if the file had it: `size=[64, 64]`, `reference.rel_error=0.02`,
        `techniques.0.steps=32`; with products, a key at the top goes to each of them

    Returns
    -------
    name, suite

    Raises
    ------
    InputError
        The file is missing, is not TOML, or holds a key or a value that a suite does not take; the message has the key
        and the line.
    """
    check_name(suite)
    path = Path(suite) if os.path.isfile(suite) else FOLDER / f"{suite}.toml"
    if not os.path.isfile(path):
        raise InputError(f"There is no suite '{suite}': give the path of a TOML file or one of {', '.join(shipped())}.")
    try:
        text = path.read_text(encoding="utf-8")
        found = tomllib.loads(text)
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise InputError(f"{path} is not a suite: {error}.") from None
    except RecursionError:
        raise InputError(f"{path} is not a suite: its values are nested too deeply.") from None
    except OSError as error:
        raise InputError(f"{path} cannot be read ({error.strerror}).") from None
    changed = [_change(found, change) for change in changes]
    try:
        return path.stem, Suite.model_validate({**_with_products(found), "folder": path.absolute().parent})
    except ValidationError as error:
        raise InputError(_explained(error, path, text, found, changed)) from None


def _with_products(found: dict[str, Any]) -> dict[str, Any]:
    """The file's tables as `Suite` has them: what stands at the top goes to each product that has no such key."""
    shared = {key: value for key, value in found.items() if key not in ("products", "study")}
    products = found.get("products", [{}])
    study = {"study": found["study"]} if "study" in found else {}
    if not isinstance(products, list) or not all(isinstance(product, dict) for product in products):
        return {"products": products, **study}
    return {"products": [shared | product for product in products], **study}


def _change(found: dict[str, Any], change: str) -> Key:
    """Set one key of the file's tables, and return it."""
    name, equals, text = change.partition("=")
    if not (equals and name.strip()):
        raise InputError(f"--set {readable(change)} should be KEY=VALUE, such as --set size=[128,128].")
    try:
        value = tomllib.loads(f"value = {text}")["value"]
    except (tomllib.TOMLDecodeError, RecursionError):
        # a text without quotes
        value = text.strip()
    key: Key = tuple(int(part) if part.isdigit() else part for part in name.strip().split("."))
    if len(key) == 1 and key[0] in Product.model_fields:
        # it is to hold for the whole suite, whatever products give themselves
        for product in found.get("products", []):
            if isinstance(product, dict):
                product.pop(key[0], None)
    at: Any = found
    for part, after in zip(key, (*key[1:], ""), strict=True):
        last = after == "" and part == key[-1]
        try:
            if isinstance(at, dict) and not last:
                at = at.setdefault(part, {})
            elif last:
                at[part] = value
            else:
                at = at[part]
        except (LookupError, TypeError):
            raise InputError(f"--set {readable(change)}: the suite has nothing at '{name}'.") from None
    return key


def _explained(error: ValidationError, path: Path, text: str, found: dict[str, Any], changed: list[Key]) -> str:
    """One sentence for the first thing that is wrong."""
    first = error.errors()[0]
    # ("products", 0, "techniques", 1, "steps"): where the file has no products, what follows
    location: Key = tuple(first["loc"])
    key = location[2:] if location[:1] == ("products",) and len(location) > 1 else location
    if "products" in found and location[:1] == ("products",) and _there(found, location):
        key = location
    # what was one value in the file is a list of one to the schema
    while first["type"] != "missing" and len(key) > 1 and not _there(found, key):
        key = key[:-1]
    # pydantic's preface to what a validator says
    message = first["msg"].removeprefix("Value error, ").rstrip(".")
    name = ".".join(map(str, key))
    if not name:
        return f"{path}: {message}."
    if any(key[: len(one)] == one for one in changed):
        return f"{path}: the key '{name}', as --set has it: {message}."
    line = _line(text, key)
    where = f" (line {line})" if line else ""
    return f"{path}{where}: the key '{name}': {message}."


def _there(found: Any, key: Key) -> bool:
    """Whether the file's tables have such a key."""
    at = found
    for part in key:
        # a text has parts too, but no keys
        if not isinstance(at, dict | list):
            return False
        try:
            at = at[part]  # type: ignore[index]
        except (LookupError, TypeError):
            return False
    return True


def _line(text: str, key: Key) -> int | None:
    """The line on which a key stands: the first with which the file, cut off behind it, would have it.

    TOML's reader keeps no places. A value over several lines makes all cuts inside it unreadable, so its first line is
    the one after the last readable cut.
    """
    while key:
        before = 0
        lines = text.splitlines(keepends=True)
        for number in range(1, len(lines) + 1):
            try:
                cut = tomllib.loads("".join(lines[:number]))
            except tomllib.TOMLDecodeError:
                continue
            if _there(cut, key):
                return before + 1
            before = number
        # a key that is missing: the table that lacks it
        key = key[:-1]
    return None
