"""The code of docs/python.md and of the package's README runs, one block after the other."""

import importlib.util
import json
import re
import warnings
from pathlib import Path

import pytest

from meshes import box, torus

ROOT = Path(__file__).parents[3]
PAGES = [ROOT / "docs/python.md", ROOT / "bindings/python/README.md", ROOT / "README.md"]
pytestmark = pytest.mark.skipif(not PAGES[0].exists(), reason="needs the repository")


def blocks(page):
    return re.findall(r"^```python\n(.*?)^```", page.read_text(), re.M | re.S)


@pytest.mark.parametrize("page", PAGES, ids=lambda page: f"{page.parent.name}-{page.stem}")
def test_code_of_the_documents(page, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    vertices, _ = torus()
    names = {
        "meshes": [torus(), box()],
        "window_is_closed": lambda: False,
        "colours": (vertices * 80 + 128).astype("u1"),
    }
    ran = 0
    for number, code in enumerate(blocks(page)):
        names["vertices"], names["faces"] = torus()  # which other blocks replace
        modules = [name for name in ("trimesh", "PIL") if name in code]
        if any(importlib.util.find_spec(name) is None for name in modules):
            continue
        with warnings.catch_warnings():
            if "trimesh" in code:
                warnings.simplefilter("ignore")
            exec(compile(code, f"{page.name}, block {number}", "exec"), names)
        ran += 1
    assert ran >= 1
    if page.stem == "python":
        assert ran >= 6


def test_the_first_snippet_has_four_lines():
    first = blocks(PAGES[0])[0]
    assert len([line for line in first.splitlines() if line.strip()]) <= 4


def test_cells_of_the_notebook(tmp_path, monkeypatch):
    pytest.importorskip("trimesh")
    pytest.importorskip("matplotlib").use("Agg")
    monkeypatch.chdir(tmp_path)
    notebook = json.loads((ROOT / "bindings/python/examples/unwrap.ipynb").read_text())
    names = {}
    cells = ["".join(cell["source"]) for cell in notebook["cells"] if cell["cell_type"] == "code"]
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of trimesh and matplotlib
        for number, code in enumerate(cells):
            exec(compile(code, f"cell {number}", "exec"), names)
    assert (tmp_path / "charts.glb").stat().st_size > 100_000
