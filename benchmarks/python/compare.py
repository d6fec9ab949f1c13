"""Compares the Python packages that unwrap meshes, on a folder of OBJ files.

    pip install -r benchmarks/python/requirements.txt ./bindings/python
    python benchmarks/python/compare.py MODELS --measure build-dev/tests/support/atlas-measure [--json out.json]

Each unwrapping runs in a process of its own, which may take so many CPU seconds. What it made is measured by the program of the
tests, atlas-measure, which knows nothing of how it was made. Prints tables in Markdown: one of all meshes together, and
one line for each.
"""

from __future__ import annotations

import argparse
import json
import math
import resource
import signal
import subprocess
import sys
import tempfile
from pathlib import Path

HERE = Path(__file__).parent
sys.path.insert(0, str(HERE))
from unwrappers import UNWRAPPERS  # noqa: E402


def limit(seconds: int) -> None:
    resource.setrlimit(resource.RLIMIT_CPU, (seconds, seconds + 5))


def unwrap_and_measure(name: str, mesh: Path, measure: Path, timeout: int, runs: int) -> dict:
    """What atlas-measure says, and seconds: the least of the runs. Or {"failed": why}."""
    with tempfile.TemporaryDirectory() as folder:
        target = Path(folder, "out.obj")
        command = [sys.executable, HERE / "unwrappers.py", name, mesh, target]
        told = None
        for _ in range(runs):
            done = subprocess.run(
                command, capture_output=True, text=True, check=False, preexec_fn=lambda: limit(timeout)
            )
            if done.returncode == -signal.SIGXCPU:
                return {"failed": f"over {timeout} s"}
            if done.returncode != 0:
                return {"failed": f"exit code {done.returncode}", "output": done.stderr[-400:]}
            run = json.loads(done.stdout.strip().splitlines()[-1])
            told = run if told is None or run["cpu"] < told["cpu"] else told
        if 0 in told["page"]:
            return {"failed": "no page"}
        sides = [str(side) for side in told["page"]]
        measured = subprocess.run([measure, "atlas", target, *sides], capture_output=True, text=True, check=True)
        return {**json.loads(measured.stdout), "cpu": told["cpu"], "wall": told["wall"]}


def defects(row: dict) -> int:
    """Triangles that are turned over, closed or outside, and those without uvs."""
    return sum(row[name] for name in ("flipped", "degenerate", "outside", "without_uv"))


def mean(values: list[float]) -> float:
    """The geometric mean; of page use and stretch as well, whose ratios count."""
    return math.exp(sum(math.log(max(value, 1e-9)) for value in values) / len(values))


def summary(rows: dict[str, dict[str, dict]]) -> str:
    """Over the meshes that every package has unwrapped."""
    done = [mesh for mesh, by in rows.items() if not any("failed" in row for row in by.values())]
    names = list(next(iter(rows.values())))
    lines = [
        f"Over the {len(done)} meshes that all of them unwrap:",
        "",
        "| package | charts | L2 | seam | page use | defects | texels drawn twice | texels that bleed | CPU s |",
        "|---|---|---|---|---|---|---|---|---|",
    ]
    for name in names:
        of = [rows[mesh][name] for mesh in done]
        lines.append(
            f"| {name} | {sum(r['charts'] for r in of)} | {mean([r['stretch_l2'] for r in of]):.4f} "
            f"| {mean([r['seam'] for r in of if r['seam'] > 0] or [0]):.2f} "
            f"| {mean([r['utilization'] for r in of]):.3f} | {sum(map(defects, of))} "
            f"| {sum(r['overlap'] for r in of)} | {sum(r['bleed'] for r in of)} | {sum(r['cpu'] for r in of):.2f} |"
        )
    return "\n".join(lines)


def table(rows: dict[str, dict[str, dict]]) -> str:
    names = list(next(iter(rows.values())))
    lines = [
        "| mesh | triangles | | charts | L2 | seam | page use | defects | CPU s |",
        "|---|---|---|---|---|---|---|---|---|",
    ]
    for mesh, by in rows.items():
        triangles = next((row["triangles"] for row in by.values() if "failed" not in row), 0)
        for place, name in enumerate(names):
            row = by[name]
            head = f"| {mesh} | {triangles} " if place == 0 else "| | "
            if "failed" in row:
                lines.append(f"{head}| {name} | {row['failed']} | | | | | |")
                continue
            lines.append(
                f"{head}| {name} | {row['charts']} | {row['stretch_l2']:.4f} | {row['seam']:.2f} "
                f"| {row['utilization']:.3f} | {defects(row)} | {row['cpu']:.2f} |"
            )
    return "\n".join(lines)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("models", type=Path, help="a folder of OBJ files")
    parser.add_argument("--measure", type=Path, required=True, help="the program atlas-measure")
    parser.add_argument("--only", nargs="+", choices=list(UNWRAPPERS), default=list(UNWRAPPERS))
    parser.add_argument("--timeout", type=int, default=300, help="CPU seconds for one mesh (300)")
    parser.add_argument("--runs", type=int, default=1, help="the fastest of so many counts (1)")
    parser.add_argument("--json", type=Path, help="where all that was measured goes; what it has is not measured again")
    options = parser.parse_args()
    meshes = sorted(options.models.glob("*.obj"))
    if not meshes:
        parser.error(f"{options.models} holds no .obj file")
    rows: dict[str, dict[str, dict]] = (
        json.loads(options.json.read_text()) if options.json and options.json.exists() else {}
    )
    for mesh in meshes:
        rows.setdefault(mesh.stem, {})
        for name in options.only:
            if name in rows[mesh.stem]:
                continue
            row = unwrap_and_measure(name, mesh, options.measure, options.timeout, options.runs)
            rows[mesh.stem][name] = row
            if options.json:
                options.json.write_text(json.dumps(rows, indent=1) + "\n")
            print(f"{mesh.stem}, {name}: {row}", file=sys.stderr, flush=True)
    print(summary(rows), table(rows), sep="\n\n")


if __name__ == "__main__":
    main()
