"""Islands of uvs, and the room that those which stay leave to others. Needs numpy alone."""

from __future__ import annotations

import numpy as np

SAME_UV = 1e-4  # uvs that are nearer than this are one, as Blender has it (STD_UV_CONNECT_LIMIT)
CELLS = 512  # a side of the page, for the search for room


def next_corners(sizes):
    """For each corner of polygons of these sizes, one after the other, the next of its polygon."""
    following = np.arange(1, sizes.sum() + 1)
    ends = np.cumsum(sizes)
    following[ends - 1] = ends - sizes
    return following


def components(count, first, second):
    """The lowest of the elements 0 .. count - 1 that each is connected to by pairs of them."""
    label = np.arange(count)
    while True:
        low = np.minimum(label[first], label[second])
        if np.array_equal(label[first], label[second]):
            return label
        np.minimum.at(label, label[first], low)
        np.minimum.at(label, label[second], low)
        while not np.array_equal(label, label[label]):
            label = label[label]


def find_islands(corners, sizes, uvs):
    """Faces that share an edge in space and in uv are one island.

    Args:
        corners: (C,) the vertex of each corner, face after face.
        sizes: (F,) corners of each face.
        uvs: (C, 2).

    Returns:
        (C,) for each corner the first that has the same vertex and uv around it; (F,) for each face the first of its
        island.
    """
    following = next_corners(sizes)
    forwards = corners < corners[following]
    low = np.where(forwards, np.arange(len(corners)), following)  # the corners at both ends of each edge
    high = np.where(forwards, following, np.arange(len(corners)))
    order = np.lexsort((uvs[high, 1], uvs[high, 0], uvs[low, 1], uvs[low, 0], corners[high], corners[low]))
    a, b = order[:-1], order[1:]
    joined = (corners[low[a]] == corners[low[b]]) & (corners[high[a]] == corners[high[b]])
    for end in (low, high):
        joined &= (np.abs(uvs[end[a]] - uvs[end[b]]) <= SAME_UV).all(1)
    a, b = a[joined], b[joined]
    face = np.repeat(np.arange(len(sizes)), sizes)
    same = components(len(corners), np.concatenate([low[a], high[a]]), np.concatenate([low[b], high[b]]))
    return same, components(len(sizes), face[a], face[b])


def faces_with(island, sizes, marked):
    """(F,): whether any corner of the face's island is marked."""
    face = np.repeat(np.arange(len(sizes)), sizes)
    found = np.zeros(len(sizes), bool)
    found[island[face[marked]]] = True
    return found[island]


def occupied_cells(triangles):
    """(CELLS, CELLS), row 0 below: whether a triangle of (T, 3, 2) uvs touches the cell of the unit square."""
    cells = np.zeros((CELLS, CELLS), bool)
    scaled = triangles.astype(np.float64) * CELLS
    # A triangle on the line between two cells touches both.
    low = np.floor(np.nextafter(scaled.min(1), -np.inf)).astype(np.int64)
    high = np.floor(scaled.max(1)).astype(np.int64)
    inside = ((high >= 0) & (low < CELLS)).all(1)
    scaled, low, high = scaled[inside], np.clip(low[inside], 0, CELLS - 1), np.clip(high[inside], 0, CELLS - 1)
    small = (high - low <= 1).all(1)
    for x in (low, high):
        for y in (low, high):
            cells[y[small, 1], x[small, 0]] = True
    for corners, (x0, y0), (x1, y1) in zip(scaled[~small], low[~small], high[~small]):
        x, y = np.arange(x0, x1 + 1), np.arange(y0, y1 + 1)[:, None]
        cells[y0 : y1 + 1, x0 : x1 + 1] |= _touched(corners, x, y)
    return cells


def _touched(corners, x, y):
    """Whether no side of the triangle has the whole cell on its far side."""
    u, v = corners[1] - corners[0], corners[2] - corners[0]
    if u[0] * v[1] < u[1] * v[0]:
        corners = corners[::-1]
    touched = np.ones((len(y), len(x)), bool)
    for (px, py), (qx, qy) in zip(corners, np.roll(corners, -1, 0)):
        nx, ny = py - qy, qx - px  # inwards
        touched &= nx * (x + (nx > 0) - px) + ny * (y + (ny > 0) - py) >= 0
    return touched


def largest_room(cells, width, height):
    """The largest free rectangle with these proportions: (scale, x, y), in sides of the page.

    `width` and `height` are sides at scale 1. The scale is 0 where there is none, and 1 at most.
    """
    sums = np.zeros((CELLS + 1, CELLS + 1), np.int64)
    sums[1:, 1:] = cells.cumsum(0).cumsum(1)

    def place(scale):
        w, h = (max(1, int(np.ceil(side * scale * CELLS - 1e-9))) for side in (width, height))
        if w > CELLS or h > CELLS:
            return None
        taken = sums[h:, w:] - sums[:-h, w:] - sums[h:, :-w] + sums[:-h, :-w]
        at = int(np.argmin(taken))
        y, x = divmod(at, taken.shape[1])
        return (x / CELLS, y / CELLS) if taken[y, x] == 0 else None

    if (at := place(1)) is not None:
        return (1.0, *at)
    best, low, high = (0.0, 0.0, 0.0), 0.0, 1.0
    for _ in range(12):  # finer than cells are
        middle = (low + high) / 2
        at = place(middle)
        if at is None:
            high = middle
        else:
            low, best = middle, (middle, *at)
    return best
