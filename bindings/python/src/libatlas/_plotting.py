"""Pictures of atlases, if matplotlib is installed."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from libatlas._results import UnwrappedAtlas, UnwrappedMesh
from libatlas.errors import InputError


def chart_colours(count: int) -> npt.NDArray[np.float64]:
    """(count, 3): a colour for each chart, whose neighbours in number differ (0..1)."""
    hue = np.arange(count) * 0.6180339887 % 1
    light = 0.72 + 0.2 * (np.arange(count) % 3 - 1)
    wheel = np.abs((hue[:, None] * 6 + np.array([0, 4, 2])) % 6 - 3) - 1
    colours: npt.NDArray[np.float64] = np.clip(wheel, 0, 1) * 0.55 * light[:, None] + 0.4 * light[:, None]
    return colours


def plot(unwrapped: UnwrappedMesh | UnwrappedAtlas, *, page: int = 0, axes: Any | None = None) -> Any:
    """Draws the charts of a page, each in a colour of its own. Needs matplotlib.

    Args:
        unwrapped: a mesh, or an atlas with all its meshes.
        page: the number of the page.
        axes: matplotlib's Axes to draw into; a new figure if it is None.

    Returns:
        The Axes.

    Raises:
        ImportError: matplotlib is not installed.
        InputError: there is no such page.
    """
    from matplotlib import pyplot
    from matplotlib.collections import PolyCollection

    meshes = list(unwrapped) if isinstance(unwrapped, UnwrappedAtlas) else [unwrapped]
    pages = unwrapped.pages
    if not 0 <= page < len(pages):
        raise InputError(f"page {page}: there are {len(pages)} (counted from 0)")
    if axes is None:
        axes = pyplot.figure().add_subplot()
    colours = chart_colours(len(unwrapped.charts))
    for mesh in meshes:
        here = mesh.triangle_page == page
        corners = mesh.uvs[mesh.faces[here]] * pages[page]
        colour = colours[mesh.triangle_chart[here]]
        axes.add_collection(PolyCollection(corners, facecolors=colour, edgecolors=colour, linewidths=0.2))
    axes.set_xlim(0, pages[page, 0])
    axes.set_ylim(0, pages[page, 1])
    axes.set_aspect("equal")
    axes.set_xlabel("texels")
    return axes
