"""A node of Mitsuba's parse that remembers what was read of it, so that no part of a scene is ignored in silence."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from scenes.errors import InputError
from scenes.mitsuba_setup import mitsuba

REQUIRED: Any = object()


class Node:
    """One plugin of a parsed scene.

    Parameters
    ----------
    state : mitsuba.parser.ParserState   after `transform_all`
    index : int                          which of `state.nodes`
    """

    def __init__(self, state: Any, index: int) -> None:
        self.state = state
        self.props = state.nodes[index].props
        self.plugin: str = self.props.plugin_name()
        self.kind: str = str(state.nodes[index].type).rsplit(".", 1)[-1]
        self.unread = list(self.props.keys())
        self._raw = state.nodes[index]

    @property
    def where(self) -> str:
        """The place in the file: "a.xml (line 13, col 3)"."""
        import mitsuba.parser as parser

        return parser.file_location(self.state, self._raw)

    def refuse(self, why: str) -> InputError:
        """Make the error that names this node's place and plugin; the caller raises it."""
        return InputError(f"{self.where}: {self.kind.lower()} plugin '{self.plugin}' {why}")

    def take(self, name: str, default: Any = REQUIRED) -> Any:
        """Read a property as Mitsuba stored it."""
        if name not in self.unread:
            if default is REQUIRED:
                raise self.refuse(f"needs the property '{name}'.")
            return default
        self.unread.remove(name)
        return self.props[name]

    def number(self, name: str, default: Any = REQUIRED) -> float:
        """Read a finite number."""
        value = self.take(name, default)
        if isinstance(value, bool) or not isinstance(value, int | float) or not np.isfinite(value):
            raise self.refuse(f"has '{name}' = {value}, which should be a finite number.")
        return float(value)

    def color(self, name: str, default: Any = REQUIRED) -> NDArray[np.float64]:
        """Read a linear Rec.709 colour, (3,), from an <rgb>, a <float> or a uniform <spectrum>."""
        mi = mitsuba()
        value = self.take(name, default)
        if isinstance(value, mi.Spectrum) and value.is_uniform():
            value = value.values[0]
        if isinstance(value, mi.Properties.ResolvedReference):
            raise self.refuse(f"has a texture as '{name}', which is not supported yet; give an <rgb>.")
        try:
            rgb = np.broadcast_to(np.asarray(value, dtype=np.float64), 3)
        except (TypeError, ValueError):
            raise self.refuse(f"has '{name}' = {value}, which should be an <rgb> or a uniform <spectrum>.") from None
        if not np.isfinite(rgb).all() or (rgb < 0).any():
            raise self.refuse(f"has '{name}' = {rgb.tolist()}, which should be finite and not negative.")
        return rgb

    def point(self, name: str, default: Any = REQUIRED) -> NDArray[np.float64]:
        """Read a point or vector, (3,)."""
        value = np.asarray(self.take(name, default), dtype=np.float64)
        if value.shape != (3,) or not np.isfinite(value).all():
            raise self.refuse(f"has '{name}' = {value.tolist()}, which should be a finite point.")
        return value

    def transform(self, name: str = "to_world") -> NDArray[np.float64]:
        """Read a transform, (4, 4); the identity where the scene gives none."""
        value = self.take(name, None)
        if value is None:
            return np.eye(4)
        matrix = np.array(value.matrix, dtype=np.float64)
        if not np.isfinite(matrix).all() or abs(np.linalg.det(matrix[:3, :3])) < 1e-30:
            raise self.refuse(f"has a '{name}' that is not finite or cannot be inverted.")
        if not np.allclose(matrix[3], [0, 0, 0, 1]):
            raise self.refuse(f"has a '{name}' that is not affine.")
        return matrix

    def children(self, *kinds: str) -> list[Node]:
        """Take the nested plugins of the given kinds ("BSDF", "Film", ...), referenced ones included."""
        import mitsuba as mi

        found = []
        for name in list(self.unread):
            value = self.props[name]
            if not isinstance(value, mi.Properties.ResolvedReference):
                continue
            child = Node(self.state, value.index())
            # a nested texture or medium with a name plays a part of its own: it is not taken by its kind
            if child.kind in kinds and name.startswith("_arg_"):
                self.unread.remove(name)
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
        self.unread = [name for name in self.unread if name not in names]

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
