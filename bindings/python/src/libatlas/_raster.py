"""Which texels triangles cover."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
import numpy.typing as npt

_ROWS_AT_ONCE = 1 << 18  # bounds the memory that is taken


def covered_texels(
    corners: npt.NDArray[Any], width: int, height: int
) -> Iterator[tuple[npt.NDArray[np.int64], npt.NDArray[np.int64], npt.NDArray[np.int64]]]:
    """Yields arrays (triangle, x, y) of the texels of a page whose centres lie in triangles.

    Args:
        corners: (F, 3, 2) in texels; texel (x, y) covers x..x + 1, y..y + 1.
        width, height: of the page.
    """
    c = np.asarray(corners, np.float64) - 0.5  # centres are whole numbers then
    first = np.clip(np.ceil(c[:, :, 1].min(1)), 0, height).astype(np.int64)
    rows = np.maximum(np.clip(np.floor(c[:, :, 1].max(1)) + 1, 0, height).astype(np.int64) - first, 0)
    ends = np.cumsum(rows)
    begin = 0
    while begin < len(c):
        done = ends[begin - 1] if begin else 0
        end = max(int(np.searchsorted(ends, done + _ROWS_AT_ONCE, side="right")), begin + 1)
        triangle, y = _expand(first[begin:end], rows[begin:end])
        triangle += begin
        low, high = _spans(c[triangle], y)
        left = np.clip(np.ceil(low), 0, width).astype(np.int64)
        right = np.clip(np.floor(high) + 1, 0, width).astype(np.int64)
        row, x = _expand(left, np.maximum(right - left, 0))
        yield triangle[row], x, y[row]
        begin = end


def _expand(
    first: npt.NDArray[np.int64], count: npt.NDArray[np.int64]
) -> tuple[npt.NDArray[np.int64], npt.NDArray[np.int64]]:
    """All pairs (i, first[i] + k) with 0 <= k < count[i]."""
    owner = np.repeat(np.arange(len(count)), count)
    start = np.cumsum(count) - count
    return owner, np.arange(len(owner)) - start[owner] + first[owner]


def _spans(
    c: npt.NDArray[np.float64], y: npt.NDArray[np.int64]
) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.float64]]:
    """Where row y enters and leaves each triangle; the first is larger if it misses it."""
    low, high = np.full(len(y), np.inf), np.full(len(y), -np.inf)
    for k in range(3):
        a, b = c[:, k], c[:, (k + 1) % 3]
        rise = b[:, 1] - a[:, 1]
        crosses = (np.minimum(a[:, 1], b[:, 1]) <= y) & (y <= np.maximum(a[:, 1], b[:, 1])) & (rise != 0)
        at = a[:, 0] + (b[:, 0] - a[:, 0]) * ((y - a[:, 1]) / np.where(rise == 0, 1, rise))
        low = np.where(crosses, np.minimum(low, at), low)
        high = np.where(crosses, np.maximum(high, at), high)
    empty = low > high
    return np.where(empty, 1, low), np.where(empty, 0, high)
