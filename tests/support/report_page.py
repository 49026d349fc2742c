"""A report's HTML, read back as a browser would read it."""

from __future__ import annotations

import base64
import json
import zlib
from html.parser import HTMLParser
from pathlib import Path

import numpy as np


class Page(HTMLParser):
    """Tags with their attributes, texts of the table's cells, and scripts by their id."""

    def __init__(self, path: Path) -> None:
        super().__init__()
        self.tags: list[tuple[str, dict[str, str | None]]] = []
        self.rows: list[list[str]] = []
        self.scripts: dict[str, str] = {}
        self.text = ""
        self._open: list[str] = []
        self._script, self._results = "", False
        self.feed(path.read_text(encoding="utf-8"))
        self.close()
        assert not self._open, f"never closed: {self._open}"

    def handle_starttag(self, tag: str, attributes: list[tuple[str, str | None]]) -> None:
        self.tags.append((tag, dict(attributes)))
        if tag in ("meta", "link", "input", "img", "br"):
            return
        self._open.append(tag)
        if tag == "table":
            self._results = dict(attributes).get("id") == "results"
        if tag == "script":
            self._script = dict(attributes).get("id") or f"script {len(self.scripts)}"
            self.scripts[self._script] = ""
        if self._results and "tbody" in self._open:
            if tag == "tr":
                self.rows.append([])
            elif tag in ("td", "th"):
                self.rows[-1].append("")

    def handle_endtag(self, tag: str) -> None:
        assert self._open.pop() == tag

    def handle_data(self, text: str) -> None:
        if self._open and self._open[-1] == "script":
            self.scripts[self._script] += text
        elif self._open[-1:] != ["style"]:
            self.text += text
            if self._results and "tbody" in self._open and {"td", "th"} & set(self._open):
                self.rows[-1][-1] += text

    def picture(self, name: str, layer: str) -> np.ndarray:
        """What a case shows, decoded by what halves.py says and nothing of its code: (C, H, W)."""
        case = next(case for case in json.loads(self.scripts["pictures"])["cases"] if case["name"] == name)
        halves = case[layer]
        coded = zlib.decompress(base64.b64decode(self.scripts[f"block-{halves['block']}"]))
        low, high = np.frombuffer(coded, np.uint8).astype(np.int64).reshape(2, halves["channels"], case["height"], -1)
        bits = np.cumsum(low + 256 * high, axis=-1) % 65536
        return bits.astype(np.uint16).view(np.float16).astype(np.float64) * 2.0 ** halves["exponent"]
