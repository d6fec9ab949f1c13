import numpy as np
import pytest

import libatlas
from meshes import terrain, torus


def test_rectangles_lie_on_pages_and_apart():
    rng = np.random.default_rng(2)
    sizes = rng.integers(4, 60, (300, 2))
    packed = libatlas.pack_rects(sizes, page=(256, 256), allow_rotation=True, padding=1)
    assert packed.placed.all() and len(packed.pages) >= packed.page_lower_bound > 1
    sides = np.where(packed.rotated[:, None], sizes[:, ::-1], sizes)
    owner = np.full((len(packed.pages), 256, 256), -1)
    for i, (page, x, y, (w, h)) in enumerate(zip(packed.page, packed.x, packed.y, sides)):
        place = owner[page, y : y + h, x : x + w]
        assert place.shape == (h, w) and (place == -1).all()
        place[:] = i
    area = np.prod(sizes, 1).sum() / np.prod(packed.pages, 1).sum()
    assert packed.utilization == pytest.approx(area)
    assert packed.rotated.any() and packed.rotated.dtype == bool


def test_what_has_no_room_is_not_placed():
    packed = libatlas.pack_rects([[50, 50], [300, 10], [60, 60]], page=(100, 100), max_pages=1)
    assert packed.placed.tolist() == [False, False, True]
    none = libatlas.pack_rects(np.zeros((0, 2), int))
    assert none.placed.shape == (0,) and none.pages.shape == (0, 2)


def test_options_of_packing():
    packed = libatlas.pack_rects([[30, 20]] * 4, page=(128, 0), alignment=16, crop=True)
    assert not (packed.x % 16).any() and not (packed.y % 16).any()
    assert packed.pages[0, 0] <= 128


def test_islands_keep_their_shapes():
    vertices, faces = torus()
    unwrapped = libatlas.unwrap(vertices, faces)
    packed = libatlas.pack_islands(unwrapped.uvs, unwrapped.faces, page_size=256, padding=3)
    assert np.array_equal(np.unique(packed.triangle_island), np.arange(len(unwrapped.charts)))
    angle = packed.island_angle[packed.triangle_island]
    turn = np.stack([np.cos(angle), -np.sin(angle), np.sin(angle), np.cos(angle)], -1).reshape(-1, 2, 2)
    texels = packed.island_offset[packed.triangle_island][:, None] + packed.texels_per_uv * np.einsum(
        "tij,tkj->tki", turn, unwrapped.corner_uvs.astype(np.float64)
    )
    given = packed.uvs[unwrapped.faces] * packed.pages[0]
    assert np.abs(texels - given).max() < 0.01
    assert packed.utilization > 0.5 and packed.island_page.max() == 0


def test_uvs_that_no_triangle_names_become_zero():
    uvs = np.random.default_rng(1).random((5, 2)) + 3
    packed = libatlas.pack_islands(uvs, np.array([[0, 1, 2]], np.uint16))
    assert not packed.uvs[3:].any() and packed.uvs[:3].all()


def test_packing_can_be_stopped():
    def progress(stage, fraction):
        raise RuntimeError("stop")

    unwrapped = libatlas.unwrap(*terrain(100), max_stretch=1.02)
    with pytest.raises(RuntimeError, match="^stop$"):
        libatlas.pack_islands(unwrapped.uvs, unwrapped.faces, progress=progress)
