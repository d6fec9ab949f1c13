import numpy as np
import pytest

import libatlas
from libatlas._plotting import chart_colours
from libatlas._raster import covered_texels
from meshes import box, torus


def axes():
    matplotlib = pytest.importorskip("matplotlib")
    matplotlib.use("Agg")
    from matplotlib.figure import Figure

    return Figure().add_subplot()


def test_all_triangles_of_a_page_are_drawn():
    result = libatlas.unwrap(*torus(), page_size=256)
    drawn = libatlas.plot(result, axes=axes())
    (collection,) = drawn.collections
    assert len(collection.get_paths()) == len(result.faces)
    corners = np.array([path.vertices[:3] for path in collection.get_paths()])
    assert np.allclose(corners, result.corner_uvs * result.pages[0])
    colours = np.unique(collection.get_facecolor(), axis=0)
    assert len(colours) == len(result.charts)


def test_an_atlas_is_drawn_page_by_page():
    atlas = libatlas.Atlas()
    atlas.add(*torus())
    atlas.add(*box())
    result = atlas.unwrap(page_size=128, pages=8, texels_per_unit=60)
    drawn = [libatlas.plot(result, page=page, axes=axes()) for page in range(len(result.pages))]
    paths = sum(len(collection.get_paths()) for one in drawn for collection in one.collections)
    assert paths == sum(len(mesh.faces) for mesh in result) and len(drawn) > 1
    with pytest.raises(libatlas.InputError):
        libatlas.plot(result, page=len(drawn), axes=axes())


def test_a_figure_is_made_if_none_is_given():
    pyplot = pytest.importorskip("matplotlib.pyplot")
    drawn = libatlas.plot(libatlas.unwrap(*box()))
    assert drawn.figure in [pyplot.figure(number) for number in pyplot.get_fignums()]
    pyplot.close("all")


def test_colours_of_neighbours_differ():
    colours = chart_colours(50)
    assert colours.min() >= 0 and colours.max() <= 1
    assert np.abs(np.diff(colours, axis=0)).max(1).min() > 0.1


def test_texels_whose_centres_are_covered():
    rng = np.random.default_rng(4)
    corners = rng.uniform(-4, 20, (40, 3, 2))
    x, y = np.meshgrid(np.arange(16) + 0.5, np.arange(12) + 0.5)
    expected = set()
    for t, (a, b, c) in enumerate(corners):
        sides = [(q - p)[0] * (y - p[1]) - (q - p)[1] * (x - p[0]) for p, q in ((a, b), (b, c), (c, a))]
        inside = np.all([s >= 0 for s in sides], 0) | np.all([s <= 0 for s in sides], 0)
        expected |= {(t, int(i), int(j)) for j, i in zip(*np.nonzero(inside))}
    found = [covered for chunk in covered_texels(corners, 16, 12) for covered in zip(*map(np.ndarray.tolist, chunk))]
    assert len(found) == len(set(found)) and set(found) == expected
