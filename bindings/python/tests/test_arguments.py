"""Wrong arguments end in exceptions, whatever they are."""

import math

import numpy as np
import pytest

import libatlas
from meshes import box

VERTICES, FACES = box(2)
UVS = np.random.default_rng(0).random((len(VERTICES), 2))


def strange_arrays(rng, good, integers):
    """Something that is no usable form of `good`."""
    rows, columns = good.shape
    kind = rng.integers(11 if integers else 10)
    if kind == 0:
        return good[:, : columns - 1]
    if kind == 1:
        return good.ravel()
    if kind == 2:
        return good[None]
    if kind == 3:
        return good.astype(complex)
    if kind == 4:
        return good.astype(str)
    if kind == 5:
        return rng.choice([None, "mesh", 7, b"", object()])
    if kind == 6:
        return [list(row) for row in good[:-1]] + [[0]]
    if kind == 7:
        return good.astype(object)
    if kind == 8:
        return good.astype(bool)
    if kind == 9:
        wrong = np.array(good, np.float64)
        if integers:
            return wrong
        wrong[rng.integers(rows), rng.integers(columns)] = rng.choice([math.nan, math.inf, -math.inf, 1e300])
        return wrong
    wrong = np.array(good, np.int64)
    wrong[rng.integers(rows), rng.integers(columns)] = rng.choice([-1, rows * 10, 2**31, 2**32, -(2**63)])
    return wrong


def strange_options(rng):
    name = rng.choice(["max_stretch", "padding", "page_size", "pages", "mip_levels", "charts", "square", "no_such"])
    value = {
        "max_stretch": [0.5, math.nan, -1, "1.25", None, 10**400],
        "padding": [-1, 2**31, 2**70, 1.5, None, "2", 5000],
        "page_size": [0, 63, 16385, -(2**31), 2048.0],
        "pages": [-1, 2**32, 0, "all"],
        "mip_levels": [-1, 11, 0.5],
        "charts": ["quick", 1, None, b"fast"],
        "square": [2, -1, "yes", None],
        "no_such": [1],
    }[name]
    return {name: value[rng.integers(len(value))]}


def one_wrong_call(rng):
    which = rng.integers(6)
    if which == 0:
        libatlas.unwrap(strange_arrays(rng, VERTICES, False), FACES)
    elif which == 1:
        libatlas.unwrap(VERTICES, strange_arrays(rng, FACES, True))
    elif which == 2:
        libatlas.unwrap(VERTICES, FACES, **strange_options(rng))
    elif which == 3:
        name = rng.choice(["normals", "uvs", "materials", "seams", "triangle_density"])
        bad = {
            "normals": [VERTICES[1:], VERTICES[:, :2], "n", VERTICES * 1j],
            "uvs": [UVS[1:], VERTICES, [0.5], UVS.astype(str)],
            "materials": [FACES, FACES[1:, 0], FACES[:, 0] * 1.5, -1 - FACES[:, 0]],
            "seams": [FACES[1:], FACES[:, 0], FACES * 1.0, "seams"],
            "triangle_density": [-np.ones(len(FACES)), np.full(len(FACES), np.nan), np.ones(3), np.zeros(len(FACES))],
        }[name]
        libatlas.unwrap(VERTICES, FACES, **{name: bad[rng.integers(len(bad))]})
    elif which == 4:
        if rng.integers(2):
            libatlas.pack_islands(strange_arrays(rng, UVS, False), FACES)
        else:
            libatlas.pack_islands(UVS, strange_arrays(rng, FACES, True))
    else:
        sizes = [[[-1, 2]], [[1, 2, 3]], [[1.5, 2]], [[2**31, 1]], "x", [[1, 2], [3]], None, [[1, 2j]]]
        pages = [(-1, 5), (1, 2, 3), 5, ("a", "b"), (2**31, 1), (1.5, 2), None]
        if rng.integers(2):
            libatlas.pack_rects(sizes[rng.integers(len(sizes))])
        else:
            libatlas.pack_rects([[1, 2]], page=pages[rng.integers(len(pages))])


def test_a_thousand_wrong_calls_raise():
    rng = np.random.default_rng(11)
    kinds = set()
    for _ in range(1000):
        with pytest.raises((libatlas.Error, TypeError)) as caught:
            one_wrong_call(rng)
        message = str(caught.value)
        assert message and "\n" not in message.rstrip("\n"), message
        kinds.add(type(caught.value))
    assert kinds == {libatlas.InputError, libatlas.OptionError, TypeError}
    # What is right still works.
    assert len(libatlas.unwrap(VERTICES, FACES).charts) > 0


@pytest.mark.parametrize(
    ("call", "error", "message"),
    [
        (lambda: libatlas.unwrap([], []), libatlas.InputError, r"shape is \(0,\), but \(N, "),
        (lambda: libatlas.unwrap(VERTICES, FACES[:0]), libatlas.InputError, "no triangle"),
        (lambda: libatlas.unwrap(VERTICES[:0], FACES), libatlas.InputError, "triangle 0"),
        (lambda: libatlas.unwrap(VERTICES, FACES + 1), libatlas.InputError, "names none of the"),
        (lambda: libatlas.unwrap(VERTICES, -FACES), libatlas.InputError, r"faces\[0, .\]: -\d+ is out of range"),
        (lambda: libatlas.unwrap(VERTICES * np.nan, FACES), libatlas.InputError, "not finite"),
        (lambda: libatlas.unwrap(VERTICES, FACES, page_size=1), libatlas.OptionError, "page_size is 1"),
        (lambda: libatlas.unwrap(VERTICES, FACES, pages=-1), libatlas.OptionError, "pages is -1"),
        (lambda: libatlas.unwrap(VERTICES, FACES, size=1), TypeError, "no option 'size'"),
        (lambda: libatlas.unwrap(VERTICES, FACES, uv_faces=FACES), libatlas.InputError, "uv_faces"),
        (lambda: libatlas.unwrap(VERTICES, FACES, threads=1.5), TypeError, "threads"),
        (lambda: libatlas.Atlas().unwrap(), libatlas.InputError, "mesh"),
        (lambda: libatlas.Atlas().add(VERTICES, FACES, density=math.nan), libatlas.InputError, "density"),
        (lambda: libatlas.pack_rects([[-1, 2]]), libatlas.InputError, "-1"),
        (lambda: libatlas.pack_islands(UVS, FACES[:0]), libatlas.InputError, "no triangle"),
    ],
)
def test_messages_name_the_element(call, error, message):
    with pytest.raises(error, match=message):
        call()


def test_errors_are_what_python_calls_them():
    with pytest.raises(ValueError):
        libatlas.unwrap(VERTICES[:, :2], FACES)
    with pytest.raises(libatlas.Error):
        libatlas.unwrap(VERTICES, FACES, padding=-1)


def test_an_atlas_survives_a_mesh_that_was_refused():
    atlas = libatlas.Atlas()
    with pytest.raises(libatlas.InputError):
        atlas.add(VERTICES, FACES + 1000)
    assert len(atlas) == 0
    assert atlas.add(VERTICES, FACES) == 0
    assert len(atlas.unwrap()) == 1
