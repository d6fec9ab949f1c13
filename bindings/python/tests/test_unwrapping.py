import gc

import numpy as np
import pytest

import libatlas
from libatlas._library import Context, Handle
from libatlas._raster import covered_texels
from meshes import box, join, made, terrain, torus

MADE = made()


def areas(corners):
    """Signed areas of triangles in the plane."""
    a, b, c = corners[:, 0], corners[:, 1], corners[:, 2]
    return ((b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0]) / 2


@pytest.mark.parametrize("name", list(MADE))
def test_result_is_the_mesh_with_uvs(name):
    vertices, faces = MADE[name]
    result = libatlas.unwrap(vertices, faces, page_size=512)
    vmapping, new_faces, uvs = result
    assert np.array_equal(vmapping[new_faces], faces)
    assert uvs.min() >= 0 and uvs.max() <= 1
    assert result.corner_uvs.shape == (len(faces), 3, 2)
    assert np.array_equal(result.corner_uvs[5, 2], uvs[new_faces[5, 2]])
    texels = areas(result.corner_uvs.astype(np.float64) * result.pages[0])
    assert (texels > 0).all()
    # The page is used as much as the result says, and charts have the density that it names.
    assert texels.sum() / np.prod(result.pages[0]) == pytest.approx(result.atlas.utilization, rel=1e-3)
    density = np.sqrt(texels.sum() / result.distortion.surface_area)
    assert density == pytest.approx(result.atlas.texels_per_unit, rel=0.05)


def test_charts_and_quality():
    vertices, faces = MADE["two"]
    result = libatlas.unwrap(vertices, faces, max_stretch=1.1)
    charts = result.charts
    assert len(charts) == result.triangle_chart.max() + 1
    assert np.array_equal(charts.triangle_count, np.bincount(result.triangle_chart))
    assert np.array_equal(charts.page[result.triangle_chart], result.triangle_page)
    assert charts.area.sum() == pytest.approx(result.distortion.surface_area)
    assert charts.kept.dtype == bool and not charts.kept.any()
    assert result.distortion.stretch_999 == charts.stretch_999.max() <= 1.1
    assert 1 <= result.distortion.stretch_l2 <= 1.1
    assert result.distortion.flipped_triangles == 0
    assert result.atlas.texels_drawn_twice == 0


def test_seams_are_edges_with_two_places_in_uv():
    vertices, faces = MADE["box"]
    result = libatlas.unwrap(vertices, faces)
    ends = {}
    for t in range(len(faces)):
        for k in range(3):
            key = (faces[t, k], faces[t, (k + 1) % 3])
            ends[key] = (t, k, tuple(result.corner_uvs[t, k]), tuple(result.corner_uvs[t, (k + 1) % 3]))
    expected = np.zeros(faces.shape, bool)
    for (a, b), (t, k, at_a, at_b) in ends.items():
        _, _, other_b, other_a = ends[b, a]
        expected[t, k] = (at_a, at_b) != (other_a, other_b)
    assert result.seams.dtype == bool
    assert np.array_equal(result.seams, expected) and expected.any()


def test_marked_seams_are_seams():
    vertices, faces = torus()
    free = libatlas.unwrap(vertices, faces).seams
    marked = np.zeros(faces.shape, bool)
    marked[np.flatnonzero(~free.any(1))[::7], 1] = True
    result = libatlas.unwrap(vertices, faces, seams=marked)
    assert (result.seams | ~marked).all() and not (free | ~marked).all()


def test_seams_keep_away_from_high_weights():
    vertices, faces = torus(40, 24)
    heavy = vertices[:, 0] > 0
    ends = vertices[faces], vertices[np.roll(faces, -1, 1)]
    length, side = np.linalg.norm(ends[0] - ends[1], axis=2), ends[0][..., 0] + ends[1][..., 0] > 0

    def seams(weights):
        marked = libatlas.unwrap(vertices, faces, seam_weights=weights).seams
        return (length * (marked & side)).sum(), (length * (marked & ~side)).sum()

    free, (there, elsewhere) = seams(None), seams(np.where(heavy, 10, 1))
    assert there < 0.7 * free[0] and there < 0.65 * elsewhere
    with pytest.raises(libatlas.InputError, match="vertex 0: seam weight -1"):
        seams(-np.ones(len(vertices)))
    with pytest.raises(libatlas.InputError, match="seam_weights: shape"):
        seams(np.ones(3))


def test_seams_are_weighed_against_stretch():
    few, usual = (libatlas.unwrap(*torus(60, 30), seam_weight=weight) for weight in (5, 1))
    assert len(few.charts) < len(usual.charts)
    assert few.distortion.seam_length < usual.distortion.seam_length
    assert few.distortion.stretch_l2 > usual.distortion.stretch_l2
    with pytest.raises(libatlas.OptionError, match="seam_weight is -1"):
        libatlas.unwrap(*torus(), seam_weight=-1)


def test_materials_divide_charts():
    vertices, faces = terrain()
    materials = np.arange(len(faces)) // 500
    result = libatlas.unwrap(vertices, faces, materials=materials)
    assert np.array_equal(result.charts.material[result.triangle_chart], materials)
    alike = libatlas.unwrap(vertices, faces, materials=materials, split_at_materials=False)
    assert len(alike.charts) < len(result.charts)


def test_normals_that_differ_make_seams():
    vertices, faces = box(1)
    soup, corner = vertices[faces].reshape(-1, 3), np.arange(36).reshape(-1, 3)
    flat = np.cross(soup[1::3] - soup[::3], soup[2::3] - soup[::3]).repeat(3, 0)
    smooth = libatlas.unwrap(soup, corner)
    assert len(libatlas.unwrap(soup, corner, normals=flat).charts) == 6 > len(smooth.charts)


def test_density_makes_charts_larger():
    vertices, faces = join(box(), box())
    half = len(faces) // 2
    result = libatlas.unwrap(vertices, faces, triangle_density=np.repeat([1, 3], half))
    size = areas(result.corner_uvs.astype(np.float64))
    assert size[half:].sum() / size[:half].sum() == pytest.approx(9, rel=0.01)
    atlas = libatlas.Atlas()
    for density in (1, 3):
        atlas.add(*box(), density=density)
    one, three = (areas(mesh.corner_uvs.astype(np.float64)).sum() for mesh in atlas.unwrap())
    assert three / one == pytest.approx(9, rel=0.01)


def test_given_uvs_are_kept():
    vertices, faces = torus()
    first = libatlas.unwrap(vertices, faces)
    again = libatlas.unwrap(vertices[first.vmapping], first.faces, uvs=first.uvs, keep_uvs=True)
    assert again.charts.kept.all() and again.atlas.kept_charts == len(first.charts)
    indexed = libatlas.unwrap(vertices, faces.astype(np.uint16), uvs=first.uvs, uv_faces=first.faces, keep_uvs=True)
    assert indexed.charts.kept.all() and len(indexed.charts) == len(first.charts)
    ratio = areas(indexed.corner_uvs.astype(np.float64)) / areas(first.corner_uvs.astype(np.float64))
    assert ratio.max() / ratio.min() == pytest.approx(1, rel=0.02)
    assert not libatlas.unwrap(vertices, faces).charts.kept.any()


def test_meshes_share_an_atlas():
    meshes = [torus(), box(), terrain()]
    atlas = libatlas.Atlas()
    assert [atlas.add(*mesh) for mesh in meshes] == [0, 1, 2] and len(atlas) == 3
    result = atlas.unwrap(page_size=256, pages=4, texels_per_unit=100)
    assert len(result) == 3 and len(result[1:]) == 2 and len(result.pages) > 1
    for number, (mesh, (vertices, faces)) in enumerate(zip(result, meshes)):
        assert np.array_equal(mesh.vmapping[mesh.faces], faces)
        assert (result.charts.mesh[mesh.triangle_chart] == number).all()
        assert mesh.seams.shape == faces.shape
    assert np.array_equal(result[-1].uvs, result[2].uvs)
    with pytest.raises(IndexError):
        result[3]
    # All charts lie apart on their pages, with the padding between them.
    for page, (width, height) in enumerate(result.pages):
        count = np.zeros((height, width), int)
        for mesh in result:
            corners = mesh.corner_uvs[mesh.triangle_page == page] * result.pages[page]
            for _, x, y in covered_texels(corners, width, height):
                np.add.at(count, (y, x), 1)
        assert count.any() and (count > 1).mean() < 1e-3  # edges may run through centres


def test_instances_have_places_of_their_own():
    atlas = libatlas.Atlas()
    atlas.add(*torus(), instances=[1, 2, 1])
    atlas.add(*box())
    shown, once = atlas.unwrap(page_size=512)
    places = shown.instances
    assert len(places) == 3 and len(once.instances) == 0
    # uv * scale is the mesh in texels, twice as long for the second instance.
    page = shown.pages[places.page]
    assert places.scale[1] * page[1] == pytest.approx(2 * places.scale[0] * page[0], rel=0.05)
    width, height = shown.pages[0]
    count = np.zeros((height, width), int)
    uvs = [shown.corner_uvs * places.scale[i] + places.offset[i] for i in range(3)] + [once.corner_uvs]
    for corners in uvs:
        assert corners.min() >= 0 and corners.max() <= 1
        for _, x, y in covered_texels(corners * shown.pages[0], width, height):
            np.add.at(count, (y, x), 1)
    assert count.any() and (count > 1).mean() < 1e-3
    with pytest.raises(ValueError):
        places.scale[0] = 1


@pytest.mark.parametrize("bad", [[], [0], [-1], [np.nan], [[1]], 3])
def test_instances_that_are_none(bad):
    atlas = libatlas.Atlas()
    with pytest.raises(libatlas.InputError, match="instance"):
        atlas.add(*box(), instances=bad)
    assert len(atlas) == 0


def test_an_atlas_can_be_unwrapped_again_and_grow():
    atlas = libatlas.Atlas()
    atlas.add(*box())
    first = atlas.unwrap(page_size=256)
    seams = first[0].seams
    second = atlas.unwrap(page_size=512)
    assert 240 <= first.pages[0].max() <= 256 and 480 <= second.pages[0].max() <= 512
    atlas.add(*torus())
    assert len(atlas.unwrap()) == 2
    assert seams.any()
    with pytest.raises(libatlas.InputError):  # of other meshes
        first[0].seams


def test_arrays_outlive_everything_else_and_are_read_only():
    result = libatlas.unwrap(*torus())
    before = result.uvs.copy()
    uvs, pages = result.uvs, result.pages
    assert not uvs.flags.owndata and not uvs.flags.writeable
    with pytest.raises(ValueError):
        uvs[0] = 0
    del result
    gc.collect()
    [libatlas.unwrap(*torus()) for _ in range(3)]
    assert np.array_equal(uvs, before) and pages.shape == (1, 2)


def test_results_are_freed():
    resource = pytest.importorskip("resource")
    vertices, faces = torus(200, 100)
    libatlas.unwrap(vertices, faces)
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    for _ in range(10):
        libatlas.unwrap(vertices, faces)
    # Each result has over 2 MB.
    assert resource.getrusage(resource.RUSAGE_SELF).ru_maxrss < before + 12_000


def test_lightmap_options():
    options = libatlas.lightmap_options(20)
    assert options["square"] is True and options["texels_per_unit"] == 20
    result = libatlas.unwrap(*box(), **options)
    width, height = result.pages[0]
    assert width == height and width & (width - 1) == 0
    assert libatlas.lightmap_options(20, 0.5)["texels_per_unit"] == 10


def test_progress_comes_in_the_callers_thread_and_rises():
    import threading

    seen = []
    libatlas.unwrap(*MADE["fine torus"], progress=lambda *report: seen.append((threading.get_ident(), *report)))
    assert {thread for thread, _, _ in seen} == {threading.get_ident()}
    stages = list(dict.fromkeys(stage for _, stage, _ in seen))
    assert stages == ["charts", "packing"]
    for stage in stages:
        fractions = [fraction for _, name, fraction in seen if name == stage]
        assert fractions == sorted(fractions) and fractions[-1] == 1


def test_lines_of_the_library_are_warnings():
    context = Context()
    context._on_warning(None, b"a line")  # as the library calls it
    with pytest.warns(libatlas.RepairWarning, match="^a line$") as caught:
        context.call("atlas_create", Handle("atlas").out)
    assert caught[0].filename == __file__ and len(caught) == 1


def test_version():
    assert libatlas.__version__ == libatlas.version() and libatlas.version().count(".") == 2
