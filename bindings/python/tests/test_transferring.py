"""Textures show the values at vertices."""

import numpy as np
import pytest

import libatlas
from libatlas._raster import covered_texels
from meshes import box, terrain, torus


def looked_up(texture, result, page=0, count=4000):
    """Bilinear lookups at random points of triangles: what is seen, and the weights of the corners."""
    rng = np.random.default_rng(8)
    triangle = rng.integers(len(result.faces), size=count)
    weights = rng.dirichlet([1, 1, 1], count)
    uv = (result.corner_uvs[triangle].astype(float) * weights[:, :, None]).sum(1)
    at = uv * result.pages[page] - 0.5
    low = np.floor(at).astype(int)
    (x, y), (s, t) = low.T, (at - low).T
    height, width = texture.shape[:2]

    def texel(i, j):
        return texture[np.clip(y + j, 0, height - 1), np.clip(x + i, 0, width - 1)].astype(float).T

    lower, upper = ((1 - s) * texel(0, j) + s * texel(1, j) for j in (0, 1))
    return ((1 - t) * lower + t * upper).T, triangle, weights


def wanted(result, values, triangle, weights):
    corners = values[result.vmapping][result.faces[triangle]].astype(float)
    return np.einsum("tk,tk...->t...", weights, corners)


def test_a_smooth_colour_is_reproduced_everywhere():
    vertices, faces = torus(60, 30)
    colours = (0.5 + 0.4 * np.sin(2 * vertices)).astype(np.float32)
    result = libatlas.unwrap(vertices, faces, page_size=256)
    texture = libatlas.transfer(result, colours)
    assert texture.shape == (result.pages[0, 1], result.pages[0, 0], 3) and texture.dtype == np.float32
    seen, triangle, weights = looked_up(texture, result)
    error = np.abs(seen - wanted(result, colours, triangle, weights))
    assert error.max() < 0.02 and np.sqrt((error**2).mean()) < 0.002


def test_values_of_one_texel_detail_are_fitted_better_than_by_sampling_centres():
    vertices, faces = terrain(120)
    values = np.random.default_rng(1).random(len(vertices)).astype(np.float32)
    result = libatlas.unwrap(vertices, faces, page_size=128)
    texture = libatlas.transfer(result, values)
    assert texture.ndim == 2 and 0 <= texture.min() and texture.max() <= 1
    centres = np.full(texture.shape, 0.5)
    corners = result.corner_uvs * result.pages[0]
    for t, x, y in covered_texels(corners, *result.pages[0]):
        a, b, c = (corners[t, k].astype(float) for k in range(3))
        area = (b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0]
        p = np.stack([x + 0.5, y + 0.5], 1) - a
        v = (p[:, 0] * (c - a)[:, 1] - p[:, 1] * (c - a)[:, 0]) / area
        w = ((b - a)[:, 0] * p[:, 1] - (b - a)[:, 1] * p[:, 0]) / area
        of = values[result.vmapping[result.faces[t]]]
        centres[y, x] = of[:, 0] * (1 - v - w) + of[:, 1] * v + of[:, 2] * w
    errors = []
    for tried in (texture, centres):
        seen, triangle, weights = looked_up(tried, result)
        errors.append(np.sqrt(((seen - wanted(result, values, triangle, weights)) ** 2).mean()))
    assert errors[0] < 0.9 * errors[1]


def test_bytes_channels_and_gutters():
    vertices, faces = box()
    result = libatlas.unwrap(vertices, faces, page_size=128)
    one = np.full((len(vertices), 4), [10, 200, 30, 255], np.uint8)
    texture = libatlas.transfer(result, one)
    assert texture.shape[2] == 4 and texture.dtype == np.uint8
    assert (texture == one[0]).all()  # gutters and all else as well
    five = libatlas.transfer(result, np.arange(len(vertices) * 5).reshape(-1, 5) % 7)
    assert five.shape[2] == 5 and five.dtype == np.float32
    alone = libatlas.transfer(result, np.arange(len(vertices) * 5).reshape(-1, 5)[:, 3] % 7)
    assert np.abs(five[:, :, 3] - alone).max() < 1e-5


def test_several_meshes_and_pages():
    meshes = [torus(), box()]
    atlas = libatlas.Atlas()
    for mesh in meshes:
        atlas.add(*mesh)
    result = atlas.unwrap(page_size=128, pages=8, texels_per_unit=60)
    values = [np.full(len(vertices), number + 1.0) for number, (vertices, _) in enumerate(meshes)]
    for page in range(len(result.pages)):
        texture = libatlas.transfer(result, values, page=page)
        for number, mesh in enumerate(result):
            corners = mesh.corner_uvs[mesh.triangle_page == page] * result.pages[page]
            for _, x, y in covered_texels(corners, *result.pages[page]):
                assert np.allclose(texture[y, x], number + 1)
    assert len(result.pages) > 1


def test_threads_change_nothing_and_progress_rises():
    vertices, faces = terrain()
    result = libatlas.unwrap(vertices, faces)
    seen = []
    one = libatlas.transfer(result, vertices, threads=1, progress=lambda stage, f: seen.append((stage, f)))
    assert one.tobytes() == libatlas.transfer(result, vertices, threads=4).tobytes()
    assert seen[-1] == ("transfer", 1.0)
    with pytest.raises(InterruptedError):
        libatlas.transfer(result, vertices, progress=stop)


def stop(stage, fraction):
    raise InterruptedError


@pytest.mark.parametrize(
    ("change", "error", "message"),
    [
        (lambda v: {"values": v[1:]}, libatlas.InputError, "values: shape"),
        (lambda v: {"values": v * np.nan}, libatlas.InputError, "not finite"),
        (lambda v: {"values": v[:, :, None]}, libatlas.InputError, "values: shape"),
        (lambda v: {"values": v.astype(str)}, TypeError, "dtype"),
        (lambda v: {"values": v[:, :0]}, libatlas.InputError, "values: shape"),
        (lambda v: {"values": v, "page": 1}, libatlas.OptionError, "page is 1"),
        (lambda v: {"values": v, "page": -1}, libatlas.OptionError, "page is -1"),
        (lambda v: {"values": v, "shifts": 65}, libatlas.OptionError, "shifts is 65"),
    ],
)
def test_errors(change, error, message):
    vertices, faces = box()
    result = libatlas.unwrap(vertices, faces, page_size=64)
    with pytest.raises(error, match=message):
        libatlas.transfer(result, **change(vertices))


def test_a_mesh_of_an_atlas_alone_is_refused():
    atlas = libatlas.Atlas()
    atlas.add(*box())
    atlas.add(*box())
    with pytest.raises(libatlas.InputError, match="2 meshes"):
        libatlas.transfer(atlas.unwrap(page_size=64)[0], box()[0])
