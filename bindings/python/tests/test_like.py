"""What stays of an earlier result."""

import math

import numpy as np
import pytest

import libatlas
from libatlas import ChartOrigin
from meshes import box, terrain, torus


def bits(array):
    return np.ascontiguousarray(array).view(np.uint32)


def test_charts_stay_and_the_edit_is_named():
    vertices, faces = torus(40, 24)
    before = libatlas.unwrap(vertices, faces)
    assert len(before.charts.origins) == 0
    stays = np.arange(len(faces)) != 700
    now = libatlas.unwrap(vertices, faces[stays], like=libatlas.earlier_uvs(vertices, before))
    assert (bits(now.corner_uvs) == bits(before.corner_uvs[stays])).all()
    assert (now.pages == before.pages).all()
    edited = now.triangle_chart[700]  # its neighbour
    expected = np.full(len(now.charts), ChartOrigin.KEPT)
    expected[edited] = ChartOrigin.REPAIRED
    assert now.charts.origins.tolist() == expected.tolist()


def test_what_is_new_takes_free_room():
    vertices, faces = torus(40, 24)
    before = libatlas.unwrap(vertices, faces, page_size=512)
    small, more = box(2)
    both = np.concatenate([vertices, 0.1 * small + 5]), np.concatenate([faces, more + len(vertices)])
    now = libatlas.unwrap(*both, page_size=512, like=libatlas.earlier_uvs(vertices, before))
    assert (bits(now.corner_uvs[: len(faces)]) == bits(before.corner_uvs)).all()
    made = now.charts.origins == ChartOrigin.MADE
    assert made.any() and set(now.triangle_chart[len(faces) :]) == set(np.flatnonzero(made))


def test_several_meshes_and_polygons():
    quads, square = np.array([[0, 1, 2, 3], [1, 4, 5, 2]]), np.array([[0, 0], [1, 0], [1, 1], [0, 1], [2, 0], [2, 1]])
    meshes = [torus(), box(2), torus(), (np.column_stack([square, np.zeros(6)]), quads)]  # on each other
    atlas = libatlas.Atlas()
    for vertices, faces in meshes:
        atlas.add(vertices, faces)
    before = atlas.unwrap(pages=2, page_size=256)
    now = atlas.unwrap(pages=2, page_size=256, like=libatlas.earlier_uvs([v for v, _ in meshes], before))
    for first, second in zip(before, now):
        assert (bits(first.corner_uvs) == bits(second.corner_uvs)).all()
    assert (now.charts.origins == ChartOrigin.KEPT).all()
    with pytest.raises(libatlas.InputError, match="1 meshes for 4"):
        libatlas.earlier_uvs([meshes[0][0]], before)


def test_uvs_of_another_program():
    vertices, faces = terrain(8)
    uvs = (0.5 * vertices[:, :2]).astype(np.float32)  # of a flat projection
    flat = vertices * [1, 1, 0]
    corners = np.arange(faces.size).reshape(-1, 3)
    for given, uv_faces in ((uvs, None), (uvs[faces.ravel()], corners)):
        like = libatlas.EarlierUvs(flat, faces, given, [[512, 512]], uv_faces=uv_faces)
        now = libatlas.unwrap(flat, faces, like=like)
        assert (now.corner_uvs == uvs[faces]).all() and now.charts.origins.tolist() == [ChartOrigin.KEPT]
    with pytest.warns(libatlas.RepairWarning, match="nothing of the earlier uvs stays"):
        now = libatlas.unwrap(100 * flat, faces, like=like)
    assert len(now.charts.origins) == 0


@pytest.mark.parametrize(
    ("change", "error", "message"),
    [
        (
            dict(vertices=lambda v: np.where(np.arange(len(v))[:, None] == 5, math.nan, v)),
            libatlas.InputError,
            "position 5 is not finite",
        ),
        (dict(faces=lambda f: f + 1), libatlas.InputError, "triangle .*names none of"),
        (dict(faces=lambda f: f[:, :2]), libatlas.InputError, r"like: faces: shape"),
        (dict(uvs=lambda u: u[1:]), libatlas.InputError, r"like: uvs: shape"),
        (dict(uv_faces=lambda _: [[0, 1, 2]]), libatlas.InputError, r"like: uv_faces: shape"),
        (dict(triangle_page=lambda _: [0]), libatlas.InputError, r"like: triangle_page: shape"),
        (dict(pages=lambda _: np.zeros((0, 2), int)), libatlas.InputError, "no page"),
        (dict(pages=lambda _: [[512, 0]]), libatlas.InputError, "page 0 is 512 x 0"),
        (dict(tolerance=lambda _: math.nan), libatlas.OptionError, "tolerance"),
    ],
)
def test_messages_name_the_element(change, error, message):
    vertices, faces = box(2)
    given = dict(vertices=vertices, faces=faces, uvs=vertices[:, :2], pages=[[512, 512]], uv_faces=None)
    for name, changed in change.items():
        given[name] = changed(given.get(name))
    with pytest.raises(error, match=message):
        libatlas.unwrap(vertices, faces, like=libatlas.EarlierUvs(**given))


def test_like_takes_nothing_else():
    vertices, faces = box(2)
    with pytest.raises(TypeError, match="like: .* no EarlierUvs"):
        libatlas.unwrap(vertices, faces, like=libatlas.unwrap(vertices, faces))
    libatlas.unwrap(vertices, faces, like=None)
