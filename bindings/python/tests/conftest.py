import os
import subprocess
from pathlib import Path

import numpy as np
import pytest


@pytest.fixture
def reference(tmp_path):
    """Unwraps by the C++ call (reference.cpp), whose program LIBATLAS_REFERENCE names."""
    program = os.environ.get("LIBATLAS_REFERENCE")
    if not program:
        pytest.skip("LIBATLAS_REFERENCE is not set")

    def run(vertices, faces, page_size):
        files = [tmp_path / name for name in ("positions", "indices", "result")]
        np.ascontiguousarray(vertices, np.float32).tofile(files[0])
        np.ascontiguousarray(faces, np.uint32).tofile(files[1])
        subprocess.run([program, *map(str, files), str(page_size)], check=True)
        data = np.fromfile(files[2], np.uint32)
        count = (len(data) - 3 * len(faces)) // 3
        vmapping, indices, uvs = np.split(data, [count, count + 3 * len(faces)])
        return vmapping, indices.reshape(-1, 3), uvs.view(np.float32).reshape(-1, 2)

    return run


def models():
    """The public meshes of docs/building.md, if there are any."""
    folder = os.environ.get("LIBATLAS_DATA")
    return sorted(Path(folder, "models").glob("*.obj")) if folder else []
