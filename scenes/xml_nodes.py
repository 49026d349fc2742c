"""A node of Mitsuba's parse that remembers what was read of it, so that no part of a scene is ignored in silence."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import numpy as np
from numpy.typing import NDArray

from scenes.errors import InputError
from scenes.messages import readable
from scenes.mitsuba_setup import mitsuba

REQUIRED: Any = object()
# Mitsuba computes in float32: what it cannot hold would be infinite there
LARGEST = float(np.finfo(np.float32).max)


class Node:
    """One plugin of a parsed scene.

    Parameters
    ----------
    state : mitsuba.parser.ParserState   after `transform_all`
    index : int                          which of `state.nodes`
    """

    def __init__(self, state: Any, index: int) -> None:
        self.state = state
        self.index = index
        self.props = state.nodes[index].props
        self.plugin: str = self.props.plugin_name()
        self.kind: str = str(state.nodes[index].type).rsplit(".", 1)[-1]
        # in the order of the file
        self.unread = dict.fromkeys(self.props.keys())
        self._raw = state.nodes[index]

    @property
    def where(self) -> str:
        """The place in the file: "a.xml (line 13, col 3)"."""
        import mitsuba.parser as parser

        return parser.file_location(self.state, self._raw)

    def refuse(self, why: str) -> InputError:
        """Make the error that names this node's place and plugin; the caller raises it."""
        return InputError(f"{self.where}: {self.kind.lower()} plugin '{readable(self.plugin)}' {readable(why)}")

    @contextmanager
    def located(self) -> Iterator[None]:
        """Put this node's place before the text of an error that does not know it."""
        try:
            yield
        except InputError as error:
            raise InputError(f"{self.where}: {error}") from None

    def take(self, name: str, default: Any = REQUIRED) -> Any:
        """Read a property as Mitsuba stored it."""
        if name not in self.unread:
            if default is REQUIRED:
                raise self.refuse(f"needs the property '{name}'.")
            return default
        del self.unread[name]
        return self.props[name]

    def number(self, name: str, default: Any = REQUIRED) -> float:
        """Read a finite number."""
        value = self.take(name, default)
        if isinstance(value, bool) or not isinstance(value, int | float) or not abs(value) <= LARGEST:
            raise self.refuse(f"has '{name}' = {value}, which should be a finite number.")
        return float(value)

    def integer(self, name: str, default: Any = REQUIRED) -> int:
        """Read a whole number."""
        value = self.take(name, default)
        if isinstance(value, bool) or not isinstance(value, int):
            raise self.refuse(f"has '{name}' = {value}, which should be an <integer>.")
        return value

    def flag(self, name: str, default: bool = False) -> bool:
        """Read a truth value."""
        value = self.take(name, default)
        if not isinstance(value, bool):
            raise self.refuse(f"has '{name}' = {value}, which should be a <boolean>.")
        return value

    def text(self, name: str, default: Any = REQUIRED) -> str:
        """Read a text that is not empty."""
        value = self.take(name, default)
        if not (isinstance(value, str) and value):
            raise self.refuse(f"has '{name}' = '{value}', which should be a <string>.")
        return value

    def color(self, name: str, default: Any = REQUIRED) -> NDArray[np.float64]:
        """Read a linear Rec.709 colour, (3,), from an <rgb>, a <float> or, except for light, a uniform <spectrum>."""
        mi = mitsuba()
        value = self.take(name, default)
        if isinstance(value, mi.Properties.ResolvedReference):
            raise self.refuse(f"has a texture or a volume as '{name}', where only an <rgb> or a <float> is supported.")
        # A parsed spectrum's class has no name in the module. As the emission of a light, Mitsuba takes a uniform one
        # for power per wavelength, and that is not white.
        if hasattr(value, "is_uniform") and value.is_uniform() and self.kind != "Emitter":
            value = value.values[0]
        if isinstance(value, bool) or not isinstance(value, int | float | mi.ScalarColor3d):
            raise self.refuse(f"has '{name}' = {value}, which should be an <rgb> or a <float>.")
        rgb = np.broadcast_to(np.asarray(value, dtype=np.float64), 3)
        if not (rgb <= LARGEST).all() or (rgb < 0).any():
            raise self.refuse(f"has '{name}' = {rgb.tolist()}, which should be finite and not negative.")
        return rgb

    def point(self, name: str, default: Any = REQUIRED) -> NDArray[np.float64]:
        """Read a point or vector, (3,)."""
        value = self.take(name, default)
        if np.shape(value) != (3,) or isinstance(value, mitsuba().ScalarColor3d):
            raise self.refuse(f"has '{name}' = {value}, which should be a <point>.")
        point = np.asarray(value, dtype=np.float64)
        if not (abs(point) <= LARGEST).all():
            raise self.refuse(f"has '{name}' = {point.tolist()}, which should be a finite point.")
        return point

    def transform(self, name: str = "to_world") -> NDArray[np.float64]:
        """Read a transform, (4, 4); the identity where the scene gives none."""
        value = self.take(name, None)
        if value is None:
            return np.eye(4)
        if not isinstance(value, mitsuba().ScalarAffineTransform4d):
            raise self.refuse(f"has '{name}' = {value}, which should be a <transform>.")
        matrix = np.array(value.matrix, dtype=np.float64)
        if not (abs(matrix) <= LARGEST).all() or abs(np.linalg.det(matrix[:3, :3])) < 1e-30:
            raise self.refuse(f"has a '{name}' that is not finite or cannot be inverted.")
        # Mitsuba's <rotate> takes its axis as it stands, and then turns points one way and normals another
        if not np.allclose(np.array(value.inverse_transpose) @ matrix.T, np.eye(4), atol=1e-4):
            raise self.refuse(f"has a '{name}' with a rotation about an axis that is not of unit length; normalise it.")
        return matrix

    def place(self, to_world: NDArray[np.float64]) -> None:
        """Put another transform in the place of `to_world`, (4, 4), whether the scene gives one or not."""
        self.props["to_world"] = mitsuba().ScalarAffineTransform4d(np.asarray(to_world, dtype=np.float64))
        self.unread["to_world"] = None

    def nested(self, name: str) -> Node | None:
        """Take the plugin that stands as this property, or None where it is a plain value or not there."""
        import mitsuba as mi

        if name not in self.unread or not isinstance(self.props[name], mi.Properties.ResolvedReference):
            return None
        return Node(self.state, self.take(name).index())

    def children(self, *kinds: str) -> list[Node]:
        """Take the nested plugins of the given kinds ("BSDF", "Film", ...), referenced ones included."""
        import mitsuba as mi

        found = []
        for name in list(self.unread):
            value = self.props[name]
            if not isinstance(value, mi.Properties.ResolvedReference):
                continue
            child = Node(self.state, value.index())
            # Mitsuba goes by the kind too: a name such as <film name="film"> has no bearing
            if child.kind in kinds:
                del self.unread[name]
                found.append(child)
        return found

    def child(self, kind: str) -> Node | None:
        """Take the one nested plugin of this kind, or None."""
        found = self.children(kind)
        if len(found) > 1:
            raise found[1].refuse(f"is a second {kind.lower()} where one is expected.")
        return found[0] if found else None

    def ignore(self, *names: str) -> None:
        """Mark properties as read that have no bearing on what airlight computes."""
        for name in names:
            self.unread.pop(name, None)

    def finish(self) -> None:
        """Refuse whatever nobody read.

        Raises
        ------
        InputError
            A property or a nested plugin is left over.
        """
        import mitsuba as mi

        for name in self.unread:
            value = self.props[name]
            if isinstance(value, mi.Properties.ResolvedReference):
                child = Node(self.state, value.index())
                raise child.refuse(f"inside '{self.plugin}' is outside what airlight supports.")
            raise self.refuse(f"has a property '{name}' that airlight does not know; remove it or correct its name.")


def is_similarity(matrix: NDArray[np.float64]) -> bool:
    """Whether a transform, (4, 4), turns, mirrors, moves and scales evenly, and does no more."""
    gram = matrix[:3, :3].T @ matrix[:3, :3]
    return bool(np.allclose(gram / (np.trace(gram) / 3), np.eye(3), atol=1e-4))
