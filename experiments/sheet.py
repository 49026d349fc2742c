"""One picture per case: technique, reference, signed relative error, absolute error."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from experiments.flip import LUMINANCE
from experiments.metrics import Image, signed_relative_error
from scenes.replacing import replacing

# the error's colours run from -SCALE to +SCALE on every sheet, so that sheets can be compared
SCALE = 0.2
# radiance at this percentile of the reference is shown just below white
EXPOSURE_PERCENTILE = 99.0


def display(image: Image, reference: Image) -> NDArray[np.floating]:
    """Linear radiance as sRGB values for a screen, exposed for the reference."""
    from colour.models import cctf_encoding

    white = float(np.percentile(reference, EXPOSURE_PERCENTILE))
    white = white if white > 0 else 1.0
    return np.clip(cctf_encoding(np.clip(np.asarray(image) / white, 0, 1), function="sRGB"), 0, 1)


class Sheet:
    """Draws sheets of one size; the figure is laid out once and filled anew for each, which halves the time."""

    def __init__(self) -> None:
        from matplotlib.figure import Figure

        self._figure = Figure(figsize=(14.4, 4.2), dpi=100)
        grid = self._figure.add_gridspec(1, 7, width_ratios=(1, 1, 1, 0.04, 0.09, 1, 0.04))
        axes = [self._figure.add_subplot(grid[column]) for column in (0, 1, 2, 5)]
        percent = 100 * SCALE
        self._pictures = [
            axes[0].imshow(np.zeros((2, 2, 3))),
            axes[1].imshow(np.zeros((2, 2, 3))),
            axes[2].imshow(np.zeros((2, 2)), cmap="RdBu_r", vmin=-percent, vmax=percent),
            axes[3].imshow(np.zeros((2, 2)), cmap="magma", vmin=0, vmax=1),
        ]
        titles = ("technique", "reference", "signed relative error [%], red: too bright", "absolute error [radiance]")
        for axis, title in zip(axes, titles, strict=True):
            axis.set_title(title, fontsize=10)
            axis.set_axis_off()
        for picture, column, extend in ((self._pictures[2], 3, "both"), (self._pictures[3], 6, "max")):
            bar = self._figure.colorbar(picture, cax=self._figure.add_subplot(grid[column]), extend=extend)
            bar.ax.tick_params(labelsize=8)
        self._heading = self._figure.suptitle("", x=0.01, ha="left", fontsize=10)
        self._note = self._figure.text(0.01, 0.02, "", fontsize=8)
        self._figure.subplots_adjust(left=0.005, right=0.955, top=0.82, bottom=0.05, wspace=0.08)

    def write(self, path: Path, title: str, test: Image, reference: Image, below: str, note: str = "") -> None:
        """Write the four pictures of one layer to a PNG file.

        Parameters
        ----------
        title : what is compared
        below : a second line, such as `summary` gives
        test, reference : (H, W, 3)    linear Rec.709
        note : a line below, such as the stand-in meshes
        """
        # luminance, so that one number a pixel carries the sign
        test_y, reference_y = (np.asarray(image, np.float64) @ LUMINANCE for image in (test, reference))
        relative = signed_relative_error(test_y, reference_y) if (reference_y > 0).any() else np.zeros_like(reference_y)
        absolute = np.abs(test_y - reference_y)
        height, width = reference_y.shape
        shown = (display(test, reference), display(reference, reference), 100 * relative, absolute)
        for picture, image in zip(self._pictures, shown, strict=True):
            picture.set_data(image)
            picture.set_extent((-0.5, width - 0.5, height - 0.5, -0.5))
        # a lone pixel at a silhouette shall not decide the scale
        self._pictures[3].set_clim(0, float(np.percentile(absolute, 99.9)) or 1.0)
        self._heading.set_text(f"{title}\n{below}")
        self._note.set_text(note)
        with replacing(path) as beside:
            # the fastest compression: drawing takes long enough
            self._figure.savefig(beside, format="png", pil_kwargs={"compress_level": 1})


def summary(row: Mapping[str, Any]) -> str:
    """The metrics that a sheet shows, in one line."""
    if row["rel_50"] is None:
        return "the reference is black"
    return (
        f"relative error: median {row['rel_50']:.2%}, 95 % of pixels below {row['rel_95']:.2%}, "
        f"image mean {row['image_mean_rel']:+.3%};  HDR-FLIP {row['flip']:.4f}"
    )


@cache
def _sheet() -> Sheet:
    return Sheet()


def prepare_sheets() -> None:
    """Load what drawing needs, a second's work, before the first sheet is asked for."""
    import colour.models  # noqa: F401

    _sheet()


def write_sheet(path: Path, title: str, test: Image, reference: Image, below: str, note: str = "") -> None:
    """Draw a sheet with the process's own figure; see `Sheet.write`."""
    _sheet().write(path, title, test, reference, below, note)
