"""Meshes to test with, made by formulas."""

from __future__ import annotations

from pathlib import Path

import numpy as np


def torus(around: int = 24, across: int = 12, thickness: float = 0.4):
    """(V, 3) float64, (2 around across, 3) int64."""
    i, j = (k.ravel() for k in np.mgrid[:around, :across])
    a, b = 2 * np.pi * i / around, 2 * np.pi * j / across
    r = 1 + thickness * np.cos(b)
    vertices = np.stack([r * np.cos(a), r * np.sin(a), thickness * np.sin(b)], 1)

    def at(di, dj):
        return (i + di) % around * across + (j + dj) % across

    quads = np.stack([at(0, 0), at(1, 0), at(1, 1), at(0, 1)], 1)
    return vertices, quads[:, [[0, 1, 2], [0, 2, 3]]].reshape(-1, 3)


def box(n: int = 4):
    """A closed box of 12 n² triangles, whose vertices are shared."""
    s, t = (k.ravel() for k in np.mgrid[:n, :n])
    positions, faces = [], []
    for axis in range(3):
        for side in (0, n):
            corners = []
            for ds, dt in ((0, 0), (1, 0), (1, 1), (0, 1)):
                p = np.empty((n * n, 3), np.int64)
                p[:, axis], p[:, (axis + 1) % 3], p[:, (axis + 2) % 3] = side, s + ds, t + dt
                corners.append(p)
            quads = np.stack(corners if side else corners[::-1], 1)
            faces.append(quads[:, [[0, 1, 2], [0, 2, 3]]].reshape(-1, 3, 3))
    soup = np.concatenate(faces).reshape(-1, 3)
    positions, index = np.unique(soup, axis=0, return_inverse=True)
    return positions / n, index.reshape(-1, 3)


def terrain(n: int = 40, seed: int = 1):
    """A rough height field of 2 (n - 1)² triangles with a border."""
    x, y = np.mgrid[:n, :n] / n
    rng = np.random.default_rng(seed)
    height = sum(
        rng.normal(0, 0.4 / f) * np.sin(2 * np.pi * (f * x * rng.normal() + f * y * rng.normal())) for f in (1, 2, 4, 7)
    )
    vertices = np.stack([x, y, height], -1).reshape(-1, 3)
    k = (np.arange(n - 1)[:, None] * n + np.arange(n - 1)).ravel()
    quads = np.stack([k, k + n, k + n + 1, k + 1], 1)
    return vertices, quads[:, [[0, 1, 2], [0, 2, 3]]].reshape(-1, 3)


def made():
    """Meshes by their names."""
    return {
        "torus": torus(),
        "box": box(),
        "terrain": terrain(),
        "fine torus": torus(90, 40, 0.3),
        "two": join(torus(), box()),
    }


def join(first, second):
    (v, f), (w, g) = first, second
    return np.concatenate([v, w + 3]), np.concatenate([f, g + len(v)])


def read_obj(path: Path):
    """Positions and triangles; polygons become fans."""
    vertices, faces = [], []
    for line in path.read_text(errors="replace").splitlines():
        words = line.split()
        if not words:
            continue
        if words[0] == "v":
            vertices.append([float(w) for w in words[1:4]])
        elif words[0] == "f":
            corners = [int(w.split("/")[0]) for w in words[1:]]
            corners = [c - 1 if c > 0 else len(vertices) + c for c in corners]
            faces += [[corners[0], corners[k], corners[k + 1]] for k in range(1, len(corners) - 1)]
    return np.array(vertices), np.array(faces)
