"""The names of PyPI's xatlas, as its users call them."""

import numpy as np
import pytest

import libatlas.xatlas as xatlas
from meshes import box, read_obj, terrain, torus


def test_parametrize():
    vertices, faces = torus()
    vmapping, indices, uvs = xatlas.parametrize(vertices, faces)
    assert (vmapping.dtype, indices.dtype, uvs.dtype) == (np.uint32, np.uint32, np.float32)
    assert indices.shape == faces.shape and uvs.shape == (len(vmapping), 2)
    assert np.array_equal(vmapping[indices], faces)
    assert 0 <= uvs.min() and 0.9 < uvs.max() <= 1
    uvs[0] = 0.5  # arrays are the caller's own


def test_meshes_share_an_atlas():
    atlas = xatlas.Atlas()
    meshes = [torus(), box()]
    for vertices, faces in meshes:
        atlas.add_mesh(vertices, faces)
    assert len(atlas) == 0 and atlas.width == 0
    chart_options, pack_options = xatlas.ChartOptions(), xatlas.PackOptions()
    chart_options.max_iterations = 2
    pack_options.resolution, pack_options.padding, pack_options.blockAlign = 512, 2, True
    atlas.generate(chart_options, pack_options, False)
    assert len(atlas) == atlas.mesh_count == 2 and atlas.atlas_count == 1
    assert 480 <= max(atlas.width, atlas.height) <= 512
    assert atlas.chart_count == sum(atlas.get_mesh_chart_count(i) for i in range(2))
    assert 0.5 < atlas.utilization == atlas.get_utilization(0) <= 1 and atlas.texels_per_unit > 0
    for i, (vertices, faces) in enumerate(meshes):
        vmapping, indices, uvs = atlas[i]
        assert np.array_equal(vmapping[indices], faces)
        charts = [atlas.get_mesh_chart(i, c) for c in range(atlas.get_mesh_chart_count(i))]
        assert np.array_equal(np.sort(np.concatenate([c.faces for c in charts])), np.arange(len(faces)))
        page, chart = atlas.get_mesh_vertex_assignment(i)
        for number, c in enumerate(charts):
            assert c.type == xatlas.ChartType.Piecewise and c.atlas_index == 0
            assert (chart[indices[c.faces]] == number).all() and not page.any()
    with pytest.raises(IndexError, match="out of bounds"):
        atlas[2]
    with pytest.raises(IndexError, match="out of bounds"):
        atlas.get_mesh_chart(0, 99)
    with pytest.raises(IndexError, match="out of bounds"):
        atlas.get_utilization(1)


def test_density_and_resolution_make_pages():
    atlas = xatlas.Atlas()
    atlas.add_mesh(*terrain())
    options = xatlas.PackOptions()
    options.resolution, options.texels_per_unit = 256, 200
    atlas.generate(pack_options=options)
    assert atlas.atlas_count > 1 and atlas.width <= 256
    assert atlas.texels_per_unit == pytest.approx(200)
    options.resolution = 0
    atlas.generate(pack_options=options)
    assert atlas.atlas_count == 1 and atlas.width > 256


def test_uv_meshes_are_packed():
    vmapping, indices, uvs = xatlas.parametrize(*torus())
    atlas = xatlas.Atlas()
    atlas.add_uv_mesh(uvs, indices)
    atlas.add_uv_mesh(uvs, indices, np.full(len(indices), 7))
    atlas.generate()
    assert len(atlas) == 2
    first, second = atlas[0], atlas[1]
    assert np.array_equal(first[0], np.arange(len(uvs))) and np.array_equal(second[1], indices)
    assert atlas.get_mesh_chart(1, 0).material == 7 and atlas.get_mesh_chart(0, 0).material == 0
    image = atlas.chart_image
    assert image.shape == (atlas.height, atlas.width, 3) and image.dtype == np.uint8
    covered = image.any(-1).mean()
    assert covered == pytest.approx(atlas.utilization, abs=0.01)
    assert len(np.unique(image.reshape(-1, 3), axis=0)) == atlas.chart_count + 1
    with pytest.raises(RuntimeError):
        atlas.add_mesh(*box())


def test_normals_and_uvs():
    vertices, faces = box(1)
    soup, corner = vertices[faces].reshape(-1, 3), np.arange(36).reshape(-1, 3)
    normals = np.cross(soup[1::3] - soup[::3], soup[2::3] - soup[::3]).repeat(3, 0)
    atlas = xatlas.Atlas()
    atlas.add_mesh(soup, corner, normals)
    atlas.generate()
    assert atlas.chart_count < 6
    options = xatlas.ChartOptions()
    options.normal_seam_weight = 2000
    atlas.generate(options)
    assert atlas.chart_count == 6

    vmapping, indices, uvs = xatlas.parametrize(vertices, faces)
    atlas = xatlas.Atlas()
    atlas.add_mesh(vertices[vmapping], indices, uvs=uvs)
    options = xatlas.ChartOptions()
    options.use_input_mesh_uvs = True
    atlas.generate(options)
    assert np.array_equal(atlas[0][1], indices) and len(atlas[0][0]) == len(vmapping)


def test_options():
    options = xatlas.ChartOptions()
    assert (options.max_cost, options.max_iterations, options.use_input_mesh_uvs) == (2.0, 1, False)
    with pytest.warns(UserWarning, match="max_cost changes nothing") as caught:
        options.max_cost = 4
    assert caught[0].filename == __file__ and options.max_cost == 4
    with pytest.raises(AttributeError):
        options.max_costs = 4
    with pytest.raises(AttributeError):
        xatlas.PackOptions().block_align = True


@pytest.mark.parametrize(
    ("arguments", "error", "message"),
    [
        ((np.zeros(1), [[0, 1, 2]]), ValueError, "Nx3"),
        ((np.zeros((3, 2)), [[0, 1, 2]]), ValueError, "Nx3"),
        ((np.zeros((3, 3)), [0, 1, 2]), ValueError, "Nx3"),
        ((np.zeros((3, 3)), [[0, 1, 2]], np.zeros((2, 3))), ValueError, "first dimension"),
        ((np.zeros((3, 3)), [[0, 1, 2]], None, np.zeros((2, 2))), ValueError, "first dimension"),
        ((np.zeros((3, 3)), [[0, 1, 2]], None, np.zeros((3, 3))), ValueError, "Nx2"),
        ((np.zeros((3, 3)), [[0, 1, 3]]), RuntimeError, "out of range"),
        ((np.zeros((3, 3)), [[0, 1, -1]]), RuntimeError, "out of range"),
    ],
)
def test_errors(arguments, error, message):
    with pytest.raises(error, match=message):
        xatlas.Atlas().add_mesh(*arguments)


def test_verbose_prints_stages(capsys):
    atlas = xatlas.Atlas()
    atlas.add_mesh(*box())
    atlas.generate(verbose=True)
    assert "packing 100 %" in capsys.readouterr().out


def test_export(tmp_path):
    vertices, faces = torus()
    vmapping, indices, uvs = xatlas.parametrize(vertices, faces)
    path = tmp_path / "torus.obj"
    xatlas.export(str(path), vertices[vmapping], indices, uvs)
    written, read = read_obj(path)
    assert np.array_equal(written.astype(np.float32), vertices[vmapping].astype(np.float32))
    assert np.array_equal(read, indices)
    texts = path.read_text()
    assert texts.count("vt ") == len(uvs) and f"f {indices[0, 0] + 1}/{indices[0, 0] + 1} " in texts
    xatlas.export(path, vertices, faces, normals=vertices)
    assert f"{faces[0, 0] + 1}//{faces[0, 0] + 1}" in path.read_text()
