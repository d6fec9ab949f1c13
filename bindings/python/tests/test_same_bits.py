"""Results are those of the C++ call, to the bit."""

import numpy as np
import pytest

import libatlas
from conftest import models
from meshes import made, read_obj

MADE = made()


def assert_same(result, expected):
    for ours, theirs in zip(result, expected):
        assert ours.dtype == theirs.dtype and ours.shape == theirs.shape
        assert ours.tobytes() == theirs.tobytes()


@pytest.mark.parametrize("name", list(MADE))
def test_made_meshes(reference, name):
    vertices, faces = MADE[name]
    assert_same(libatlas.unwrap(vertices, faces, page_size=512), reference(vertices, faces, 512))


@pytest.mark.heavy
@pytest.mark.filterwarnings("ignore::libatlas.RepairWarning")
@pytest.mark.parametrize("path", models() or [None], ids=lambda path: path.stem if path else "none")
def test_models(reference, path):
    if path is None:
        pytest.skip("LIBATLAS_DATA is not set")
    vertices, faces = read_obj(path)
    assert_same(libatlas.unwrap(vertices, faces), reference(vertices, faces, 2048))


def test_the_number_of_threads_changes_nothing():
    vertices, faces = MADE["fine torus"]
    one, four = (libatlas.unwrap(vertices, faces, threads=n) for n in (1, 4))
    assert_same(one, four)


@pytest.mark.parametrize("kind", [np.uint16, np.uint32, np.int16, np.int32, np.int64, np.uint64])
def test_the_type_of_indices_changes_nothing(kind):
    vertices, faces = MADE["torus"]
    assert_same(libatlas.unwrap(vertices, faces.astype(kind)), libatlas.unwrap(vertices, faces))


def test_the_layout_of_arrays_changes_nothing():
    vertices, faces = MADE["torus"]
    expected = libatlas.unwrap(vertices, faces)
    wide = np.zeros((len(vertices), 8), np.float32)
    wide[:, 2:5] = vertices
    assert not wide[:, 2:5].flags.c_contiguous
    swapped = vertices.astype(">f4")
    fixed = vertices.astype(np.float32)
    fixed.flags.writeable = False
    backwards = np.ascontiguousarray(vertices[::-1], np.float32)[::-1]
    for other in (wide[:, 2:5], swapped, fixed, backwards, np.asfortranarray(vertices), vertices.tolist()):
        assert_same(libatlas.unwrap(other, faces), expected)
    for other in (np.asfortranarray(faces), faces.tolist(), np.repeat(faces, 2, 0)[::2]):
        assert_same(libatlas.unwrap(vertices, other), expected)
