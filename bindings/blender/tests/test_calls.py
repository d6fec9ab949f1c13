"""What of the extension needs no Blender: islands, room beside pinned ones, and the library's calls."""

import ast
import re
import subprocess
import sys
import types
import zipfile
from pathlib import Path

import numpy as np
import pytest

FOLDER = Path(__file__).parents[1]
package = types.ModuleType("libatlas_uv")  # whose __init__ needs Blender
package.__path__ = [str(FOLDER / "libatlas_uv")]
sys.modules["libatlas_uv"] = package

from libatlas_uv import calls, islands  # noqa: E402


def grid(n=4, name="grid", height=lambda x, y: 0 * x):
    """n x n quads, with the uvs of a plane."""
    x, y = (k.ravel() for k in np.mgrid[: n + 1, : n + 1])
    corner = (np.arange(n)[:, None] * (n + 1) + np.arange(n)).ravel()
    corners = np.stack([corner, corner + n + 1, corner + n + 2, corner + 1], 1).ravel()
    loops = np.arange(4 * n * n).reshape(-1, 4)
    return calls.Faces(
        name=name,
        vertices=np.stack([x, y, height(x / n, y / n)], 1).astype(np.float32),
        sizes=np.full(n * n, 4),
        corners=corners.astype(np.uint32),
        seams=np.zeros(4 * n * n, bool),
        materials=np.zeros(n * n, np.uint32),
        uvs=np.stack([x, y], 1)[corners].astype(np.float32) / n,
        pinned=np.zeros(4 * n * n, bool),
        triangles=loops[:, [[0, 1, 2], [0, 2, 3]]].reshape(-1, 3),
        triangle_face=np.arange(n * n).repeat(2),
        numbers=np.arange(n * n),
    )


def quiet(stage, fraction):
    pass


def test_faces_that_share_an_edge_in_uv_are_an_island():
    mesh = grid(4)
    same, island = islands.find_islands(mesh.corners, mesh.sizes, mesh.uvs)
    assert (island == 0).all() and len(np.unique(same)) == 25
    torn = mesh.uvs.copy()
    torn[32:] += [0.5, 0]  # the last two columns of faces
    _, island = islands.find_islands(mesh.corners, mesh.sizes, torn)
    assert island.tolist() == [0] * 8 + [8] * 8
    nearly = mesh.uvs + np.random.default_rng(0).uniform(-3e-5, 3e-5, mesh.uvs.shape).astype(np.float32)
    same, island = islands.find_islands(mesh.corners, mesh.sizes, nearly)
    assert (island == 0).all() and len(np.unique(same)) == 25


def test_components_of_a_long_path_in_any_order():
    rng = np.random.default_rng(1)
    name = rng.permutation(5000)
    first, second = name[:-1], name[1:]
    cut = first != name[2500]
    label = islands.components(5000, first[cut], second[cut])
    assert len(np.unique(label)) == 2
    assert (label[name[:2501]] == name[:2501].min()).all() and (label[name[2501:]] == name[2501:].min()).all()


def test_cells_that_triangles_touch():
    rng = np.random.default_rng(2)
    for size in (0.002, 0.1, 0.8):
        triangles = rng.uniform(-0.2, 1, (6, 1, 2)) + rng.uniform(0, size, (6, 3, 2))
        cells = islands.occupied_cells(triangles)
        weight = rng.dirichlet([1, 1, 1], 4000)
        points = np.einsum("ki,tij->tkj", weight, triangles).reshape(-1, 2)  # within them
        inside = ((points >= 0) & (points < 1)).all(1)
        x, y = (points[inside] * islands.CELLS).astype(int).T
        assert cells[y, x].all()
        # And few others: those along the border.
        border = 3 * size * 2 * islands.CELLS + 12
        area = abs(np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])) / 2
        assert cells.sum() <= area.sum() * islands.CELLS**2 + 6 * border


def test_the_largest_room_is_free_and_as_large_as_can_be():
    cells = np.zeros((islands.CELLS, islands.CELLS), bool)
    assert islands.largest_room(cells, 1, 0.5) == (1, 0, 0)
    cells[: islands.CELLS // 4] = True
    scale, x, y = islands.largest_room(cells, 1, 1)
    assert scale == pytest.approx(0.75, abs=2 / islands.CELLS) and y >= 0.25 and y + scale <= 1
    cells[:] = True
    assert islands.largest_room(cells, 0.5, 0.5)[0] == 0


def test_unwrapping_beside_a_pinned_island():
    mesh = grid(8, height=lambda x, y: 3 * np.sin(5 * x) * np.cos(4 * y))
    half = np.repeat(np.arange(64) < 32, 4)
    mesh.uvs = mesh.uvs * np.float32(0.4) + np.where(half, 0.0, 0.1)[:, None].astype(np.float32)
    mesh.pinned[3] = True
    laid = calls.unwrap([mesh], {"page_size": 512}, quiet)
    uvs = laid.uvs[0]
    assert np.array_equal(uvs[half], mesh.uvs[half]) and not np.array_equal(uvs[~half], mesh.uvs[~half])
    assert uvs.min() >= 0 and uvs.max() <= 1 and "beside pinned islands" in laid.told
    low, high = uvs[~half].min(0), uvs[~half].max(0)
    taken = mesh.uvs[half]
    assert (low >= taken.max(0)).any() or (high <= taken.min(0)).any()  # it lies beside, in a free rectangle
    assert (high - low).prod() > 0.3


def test_what_is_packed_is_turned_and_scaled_only():
    meshes = [grid(3, "first"), grid(5, "second")]
    meshes[1].uvs = meshes[1].uvs * np.float32(0.5) + np.float32(0.1)
    before = [mesh.uvs.copy() for mesh in meshes]
    laid = calls.pack(meshes, {"page_size": 256}, quiet)
    lengths = [np.linalg.norm(np.diff(uvs.reshape(-1, 4, 2), axis=1), axis=2) for uvs in laid.uvs]
    given = [np.linalg.norm(np.diff(uvs.reshape(-1, 4, 2), axis=1), axis=2) for uvs in before]
    ratio = np.concatenate([(a / b).ravel() for a, b in zip(lengths, given)])
    assert np.ptp(ratio) < 1e-3 * ratio.mean()
    assert all(uvs.min() >= 0 and uvs.max() <= 1 for uvs in laid.uvs)


def test_errors_name_objects_and_faces():
    mesh = grid(2, "Roof")
    mesh.vertices[mesh.corners[4]] = np.nan
    with pytest.raises(calls.Refused, match="Roof: face [0-3]"):
        calls.unwrap([grid(2), mesh], {}, quiet)
    part = mesh.some(np.array([False, True, True, True]))
    with pytest.raises(calls.Refused, match="Roof: face [1-3]"):
        calls.unwrap([part], {}, quiet)


def test_some_faces():
    mesh = grid(2)
    part = mesh.some(np.array([False, True, False, True]))
    assert part.corners.tolist() == mesh.corners[4:8].tolist() + mesh.corners[12:].tolist()
    assert part.triangles.tolist() == [[0, 1, 2], [0, 2, 3], [4, 5, 6], [4, 6, 7]]
    assert part.triangle_face.tolist() == [0, 0, 1, 1] and part.numbers.tolist() == [1, 3]


def test_versions_agree():
    source = (FOLDER / "libatlas_uv/__init__.py").read_text()
    info = next(node.value for node in ast.parse(source).body if getattr(node, "targets", [None])[0])
    version = ".".join(map(str, ast.literal_eval(info)["version"]))
    manifest = (FOLDER / "libatlas_uv/blender_manifest.toml").read_text()
    assert re.search(r'^version = "(.*)"', manifest, re.M)[1] == version
    assert f"project(libatlas VERSION {version}" in (FOLDER.parents[1] / "CMakeLists.txt").read_text()


def test_the_package_is_one_folder_with_its_wheels(tmp_path):
    wheels = [tmp_path / f"libatlas-0.1.0-py3-none-{tag}.whl" for tag in ("manylinux_2_28_x86_64", "win_amd64")]
    for wheel in wheels:
        wheel.write_bytes(b"wheel")
    target = tmp_path / "out.zip"
    command = [sys.executable, FOLDER / "package.py", target]
    subprocess.run([*command, *wheels], check=True, capture_output=True)
    with zipfile.ZipFile(target) as archive:
        names = archive.namelist()
        manifest = archive.read("libatlas_uv/blender_manifest.toml").decode()
    assert all(name.startswith("libatlas_uv/") for name in names) and "libatlas_uv/__init__.py" in names
    assert "libatlas_uv/wheels/libatlas-0.1.0-py3-none-win_amd64.whl" in names
    assert (
        "platforms = ['linux-x64', 'windows-x64']" in manifest
        and "./wheels/libatlas-0.1.0-py3-none-win_amd64.whl" in manifest
    )
    wrong = subprocess.run(
        [*command, tmp_path / "numpy-1-py3-none-win_amd64.whl"], capture_output=True, text=True, check=False
    )
    assert wrong.returncode != 0 and "no wheel of libatlas" in wrong.stderr
