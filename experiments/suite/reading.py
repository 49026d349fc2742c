"""Reads a suite's file, changes it as `--set` says, and names the key and the line of what is wrong."""

from __future__ import annotations

import os
import tomllib
from collections.abc import Sequence
from contextlib import suppress
from copy import deepcopy
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from experiments.suite.schema import Product, Suite
from scenes.errors import InputError
from scenes.file_names import check_name
from scenes.messages import readable
from scenes.toml_places import Key, is_there, line_of

FOLDER = Path(__file__).parent.parent / "suites"
# digits: no list in a file has more than a million items
LONGEST_INDEX = 6


def shipped() -> list[str]:
    """Names of the shipped suites."""
    return sorted(path.stem for path in FOLDER.glob("*.toml"))


def load_suite(suite: str, changes: Sequence[str] = ()) -> tuple[str, Suite]:
    """Read a suite by name or path.

    Parameters
    ----------
    changes : texts "key=value", each as if the file had it: `size=[64, 64]`, `reference.rel_error=0.02`,
        `techniques.0.steps=32`; a key holds for every product, and one that begins with `products.0` for that alone

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
    except ValueError as error:
        # not TOML, not UTF-8, or a number of thousands of digits
        raise InputError(f"{path} is not a suite: {str(error).rstrip('.')}.") from None
    except RecursionError:
        raise InputError(f"{path} is not a suite: its values are nested too deeply.") from None
    except OSError as error:
        raise InputError(f"{path} cannot be read ({error.strerror}).") from None
    changed = [key for change in changes for key in _change(found, change)]
    try:
        folder = path.absolute().parent
        return path.stem, Suite.model_validate({**_with_products(found), "folder": folder}, context={"folder": folder})
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


def _change(found: dict[str, Any], change: str) -> list[Key]:
    """Set a key in each of the file's tables that it is to hold for, and return where."""
    name, equals, text = change.partition("=")
    if not (equals and name.strip()):
        raise InputError(f"--set {readable(change)} should be KEY=VALUE, such as --set size=[128,128].")
    try:
        value = tomllib.loads(f"value = {text}")["value"]
    except (ValueError, RecursionError):
        # a text without quotes
        value = text.strip()
    parts = name.strip().split(".")
    products = _tables(found)
    if len(parts) == 1:
        if parts[0] in Product.model_fields:
            # it is to hold for the whole suite, whatever products give themselves
            for product in products:
                product.pop(parts[0], None)
        return [_set(found, parts, value, change, "the suite")]
    if parts[0] == "products":
        _fill(found, products, parts)
        return [_set(found, parts, value, change, "the suite")]
    own = [number for number, product in enumerate(products) if parts[0] in product]
    # a table at the top of which every product has its own is nobody's
    keys = [] if products and len(own) == len(products) else [_set(found, parts, value, change, "the suite")]
    for number in own:
        called = f"the product '{readable(str(products[number].get('name', number)))}'"
        keys.append(("products", number, *_set(products[number], parts, deepcopy(value), change, called)))
    return keys


def _tables(found: dict[str, Any]) -> list[dict[str, Any]]:
    """The file's products; none where it has none, or no tables."""
    products = found.get("products", [])
    return products if isinstance(products, list) and all(isinstance(one, dict) for one in products) else []


def _fill(found: dict[str, Any], products: list[dict[str, Any]], parts: list[str]) -> None:
    """Give a product its own copy of the table at the top of which one key is to differ: products.0.settings.steps."""
    if len(parts) > 3 and parts[2] in found:
        with suppress(LookupError):
            products[_index(parts[1])].setdefault(parts[2], deepcopy(found[parts[2]]))


def _set(table: dict[str, Any], parts: list[str], value: Any, change: str, called: str) -> Key:
    """Set one key of a table, which is `called` so where it has no such place; tables on the way are made."""
    key: list[str | int] = []
    at: Any = table
    try:
        for part in parts[:-1]:
            key.append(_index(part) if isinstance(at, list) else part)
            at = at.setdefault(part, {}) if isinstance(at, dict) else at[key[-1]]
        key.append(_index(parts[-1]) if isinstance(at, list) else parts[-1])
        at[key[-1]] = value
    except (LookupError, TypeError):
        where = readable(".".join(parts))
        raise InputError(f"--set {readable(change)}: {called} has nothing at '{where}'.") from None
    return tuple(key)


def _index(part: str) -> int:
    """The place in a list that a part of a key names.

    Raises
    ------
    LookupError
        It names none.
    """
    # Python takes other scripts' digits, and refuses numbers of thousands of them
    if not (part.isascii() and part.isdecimal() and len(part) <= LONGEST_INDEX):
        raise LookupError(part)
    return int(part)


def _explained(error: ValidationError, path: Path, text: str, found: dict[str, Any], changed: list[Key]) -> str:
    """One sentence for the first thing that is wrong."""
    first = error.errors()[0]
    # ("products", 0, "techniques", 1, "steps"): where the file has no products, what follows
    location: Key = tuple(first["loc"])
    key = location[2:] if location[:1] == ("products",) and len(location) > 1 else location
    if "products" in found and location[:1] == ("products",) and is_there(found, location):
        key = location
    # what was one value in the file is a list of one to the schema
    while first["type"] != "missing" and len(key) > 1 and not is_there(found, key):
        key = key[:-1]
    # pydantic's preface to what a validator says
    message = first["msg"].removeprefix("Value error, ").rstrip(".")
    name = readable(".".join(map(str, key)))
    if not name:
        return f"{path}: {message}."
    if any(key[: len(one)] == one for one in changed):
        return f"{path}: the key '{name}', as --set has it: {message}."
    line = line_of(text, key)
    where = f" (line {line})" if line else ""
    return f"{path}{where}: the key '{name}': {message}."
