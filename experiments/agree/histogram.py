"""The figure of `airlight agree`: the pixels' scores beside the Gaussian that they would follow."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from reference.agreement.comparison import Comparison
from scenes.replacing import replacing

# scores beyond it count in the outermost bars
LARGEST = 8.0
BARS = 64


def draw_histogram(path: Path, comparisons: Sequence[Comparison], below: str) -> None:
    """Draw one panel a pair, of all its cases, logarithmic: agreement is decided in the tails.

    Parameters
    ----------
    comparisons : of any number of cases
    below : str    under the figure: what made it
    """
    from matplotlib.figure import Figure

    edges = np.linspace(-LARGEST, LARGEST, BARS + 1)
    names = list(dict.fromkeys(comparison.name for comparison in comparisons))
    figure = Figure(figsize=(4.2 * len(names), 3.8), dpi=110, layout="constrained")
    panels = figure.subplots(1, len(names), sharey=True, squeeze=False)[0]
    highest = 1
    for panel, name in zip(panels, names, strict=True):
        verdicts = [comparison.verdicts[0] for comparison in comparisons if comparison.name == name]
        scores = np.concatenate([verdict.scores[~np.isnan(verdict.scores)] for verdict in verdicts])
        counts, _ = np.histogram(np.clip(scores, -LARGEST, LARGEST), edges)
        panel.stairs(counts, edges, fill=True, color="#2a5db0", alpha=0.75, label="pixels and channels")
        z = np.linspace(-LARGEST, LARGEST, 401)
        width = edges[1] - edges[0]
        gaussian = scores.size * width * np.exp(-0.5 * z**2) / np.sqrt(2 * np.pi)
        panel.semilogy(z, gaussian, color="#222222", lw=1.2, label="N(0, 1)")
        critical = max(verdict.critical for verdict in verdicts)
        for side in (-1, 1):
            label = ("largest critical" if len(verdicts) > 1 else "critical") if side > 0 else None
            panel.axvline(side * critical, color="#c0392b", lw=1.0, ls="--", label=label)
        highest = max(highest, counts.max())
        panel.set_xlim(-LARGEST, LARGEST)
        panel.set_title(name, fontsize=10)
        panel.set_xlabel(f"z: mean {scores.mean():+.3f}, deviation {scores.std():.3f}", fontsize=8)
    panels[0].set_ylim(0.5, 3 * highest)
    panels[0].set_ylabel("pixels and channels")
    panels[0].legend(loc="upper left", fontsize=7, frameon=False)
    figure.supxlabel(below, fontsize=7, color="0.35")
    with replacing(path) as beside:
        figure.savefig(beside, format="png")
