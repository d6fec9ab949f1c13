"""Polygons: no seam runs inside one, and results have the shape of what was given."""

import numpy as np
import pytest

import libatlas
from meshes import box, torus


def quads():
    """The torus's quads, from its pairs of triangles."""
    vertices, faces = torus()
    pairs = faces.reshape(-1, 2, 3)
    return vertices, np.stack([pairs[:, 0, 0], pairs[:, 0, 1], pairs[:, 0, 2], pairs[:, 1, 2]], 1)


def prism(sides=7):
    """A closed prism: two polygons and quads, as lists."""
    angle = 2 * np.pi * np.arange(sides) / sides
    ring = np.stack([np.cos(angle), np.sin(angle)], 1)
    vertices = np.concatenate([np.c_[ring, np.zeros(sides)], np.c_[ring, np.ones(sides)]])
    faces = [list(range(sides))[::-1], list(range(sides, 2 * sides))]
    faces += [[i, (i + 1) % sides, sides + (i + 1) % sides, sides + i] for i in range(sides)]
    return vertices, faces


def test_quads():
    vertices, faces = quads()
    result = libatlas.unwrap(vertices, faces)
    assert result.corners.shape == result.seams.shape == faces.shape
    assert result.corner_uvs.shape == (*faces.shape, 2)
    assert np.array_equal(result.vmapping[result.corners], faces)
    assert result.faces.shape == (2 * len(faces), 3) and len(result.cut_polygons) == 0
    assert np.array_equal(result.triangle_polygon, np.arange(len(faces)).repeat(2))
    for triangle, polygon in zip(result.faces, result.triangle_polygon):
        assert set(triangle) <= set(result.corners[polygon])
    # Both triangles of a quad lie in one chart.
    chart = result.triangle_chart.reshape(-1, 2)
    assert np.array_equal(chart[:, 0], chart[:, 1])


def test_polygons_of_any_size():
    vertices, faces = prism()
    result = libatlas.unwrap(vertices, faces)
    flat, sizes = np.concatenate(faces), [len(face) for face in faces]
    assert result.corners.shape == result.seams.shape == (len(flat),) and result.corner_uvs.shape == (len(flat), 2)
    assert np.array_equal(result.vmapping[result.corners], flat)
    assert len(result.faces) == sum(size - 2 for size in sizes)
    assert np.array_equal(np.bincount(result.triangle_polygon), [size - 2 for size in sizes])
    same = libatlas.unwrap(vertices, flat, polygon_sizes=sizes)
    assert same.uvs.tobytes() == result.uvs.tobytes() and np.array_equal(same.corners, result.corners)
    # Both caps are regular in uv as they are in space.
    for first in (0, 7):
        ring = result.corner_uvs[first : first + 7] * result.pages[0]
        side = np.linalg.norm(ring - np.roll(ring, 1, 0), axis=1)
        assert side.max() / side.min() < 1.01


def test_attributes_of_polygons():
    vertices, faces = prism()
    sizes = [len(face) for face in faces]
    free = libatlas.unwrap(vertices, faces)
    materials = libatlas.unwrap(vertices, faces, materials=np.arange(len(faces)))
    assert len(materials.charts) == len(faces) > len(free.charts)
    marked = [[True] * size for size in sizes]
    for seams in (marked, np.ones(sum(sizes), bool)):
        result = libatlas.unwrap(vertices, faces, seams=seams)
        assert result.seams.all() and len(result.charts) == len(faces)
    density = libatlas.unwrap(vertices, faces, triangle_density=[4.0] + [1.0] * (len(faces) - 1))
    large, small = (np.ptp(density.corner_uvs[i : i + 7], 0).max() for i in (0, 7))
    assert large / small == pytest.approx(4, rel=0.1)
    kept = libatlas.unwrap(vertices, faces, uvs=free.uvs, uv_faces=free.corners, keep_uvs=True)
    assert kept.charts.kept.all() and len(kept.charts) == len(free.charts)


def test_triangles_are_polygons_of_three():
    vertices, faces = box()
    result = libatlas.unwrap(vertices, faces)
    assert result.corners is result.faces and len(result.cut_polygons) == 0
    assert np.array_equal(result.triangle_polygon, np.arange(len(faces)))
    flat = libatlas.unwrap(vertices, faces.ravel(), polygon_sizes=np.full(len(faces), 3))
    assert flat.corner_uvs.reshape(-1, 3, 2).tobytes() == result.corner_uvs.tobytes()


def test_cut_polygons_are_named():
    # A quad folded along its diagonal by nearly half a turn cannot lie flat in one piece.
    vertices = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0.95, 0.05, 0.1]]
    result = libatlas.unwrap(vertices, [[0, 1, 2, 3]], max_stretch=1.01)
    assert result.cut_polygons.tolist() in ([], [0])
    assert len(result.cut_polygons) == len(result.charts) - 1


@pytest.mark.parametrize(
    ("faces", "sizes", "message"),
    [
        ([0, 1, 2, 3], [5], "polygon"),
        ([0, 1, 2, 3], [4, 1], "polygon"),
        ([0, 1, 2, 3], None, "shape"),
        ([[0, 1], [1, 2]], None, "corners"),
        ([[0, 1, 2], [0]], None, "corners"),
        ([[0, 1, 2, 9]], None, "9"),
        ([[0, 1, 2, 3]], [4], "shape"),
    ],
)
def test_errors(faces, sizes, message):
    with pytest.raises(libatlas.InputError, match=message):
        libatlas.unwrap(np.random.default_rng(0).random((5, 3)), faces, polygon_sizes=sizes)
    with pytest.raises(libatlas.InputError, match="seams: shape"):
        libatlas.unwrap(*quads(), seams=np.zeros((3, 4), bool))
