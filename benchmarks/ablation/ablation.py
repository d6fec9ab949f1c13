"""The ablation bench: what each constant of charts and packing, and each rule, is worth.

  scripts/ablation.sh run [--rows REGEX] [--minutes N]   measures rows that are not measured yet
  scripts/ablation.sh table                              writes docs/generated/ablation.{md,json}

A row is a constant that is halved or doubled, or a rule (a step of rules.txt, or a constant of type
bool) that is left out. It is measured on the deciding half of the set (even members of each family),
in draws whose vertices are moved by 0.1 % of an edge. A constant that changes no bit of the first
members is not measured further. --half checking measures the other half, to confirm a whole change. The table
keeps rows that another version of the code has written, until they are measured again.
"""
import argparse
import hashlib
import json
import math
import os
import pathlib
import re
import subprocess
import sys
import time

MEMBERS, SCREENED = 14, 2
TIMEOUT = 600  # seconds a row may take
# figure, whether more of it is worse, and whether it is compared as a ratio
FIGURES = [("charts", True, True), ("seam", True, True), ("visible_smooth", True, True),
           ("jag", True, False), ("l2", True, False), ("use", False, False),
           ("chart_s", True, True), ("page_s", True, True)]
HEADS = {"charts": "charts", "seam": "seam", "visible_smooth": "visible smooth", "jag": "jag",
         "l2": "L2 x 10^4", "use": "page use x 10^3", "chart_s": "CPU, charts", "page_s": "CPU, pages"}


def measure(program, change, first, step, members, draws):
    """Runs the program; returns {(mesh, draw): figures}, or a word that says how it failed."""
    env = dict(os.environ, LIBATLAS_TUNED=change)
    try:
        done = subprocess.run([program, str(first), str(step), str(members), str(draws)], env=env,
                              capture_output=True, text=True, timeout=TIMEOUT)
    except subprocess.TimeoutExpired:
        return f"took more than {TIMEOUT} s"
    if done.returncode != 0:
        return f"failed: {(done.stderr.strip().splitlines() or [done.returncode])[-1]}"
    rows = map(json.loads, done.stdout.splitlines())
    return {(row.pop("mesh"), row.pop("draw")): row for row in rows}


def without_times(figures):
    return {key: {name: value for name, value in row.items() if not name.endswith("_s")}
            for key, row in figures.items()}


def changes_of(constants):
    """The rows: (name, change as the environment gives it, what is written in the table)."""
    for constant in constants:
        name = constant["name"]
        if constant["fixed"]:
            continue
        if constant["type"] == "bool":
            yield name, f"{name}={0 if constant['value'] == 'true' else 1}", "off"
        else:
            yield name, f"{name}*0.5", "x 0.5"
            yield name, f"{name}*2", "x 2"


class Store:
    """Results as files, one a row, so that a run can be ended and goes on where it was."""

    def __init__(self, folder, program, half, draws):
        digest = hashlib.sha256(pathlib.Path(program).read_bytes()).hexdigest()[:12]
        self.folder = folder / f"{half}-{draws}-{digest}"
        self.folder.mkdir(parents=True, exist_ok=True)

    def path(self, change):
        return self.folder / (re.sub(r"[^\w.*=-]", "_", change or "plain") + ".json")

    def load(self, change):
        path = self.path(change)
        if not path.exists():
            return None
        found = json.loads(path.read_text())
        return found if isinstance(found, str) else {tuple(key): row for key, row in found}

    def save(self, change, result):
        path = self.path(change)
        part = path.with_suffix(".part")
        part.write_text(json.dumps(result if isinstance(result, str) else [[list(k), v] for k, v in result.items()]))
        part.replace(path)


def run(args, program, constants, store):
    first = 0 if args.half == "deciding" else 1
    whole = (first, 2, MEMBERS, args.draws)
    screen = (first, 2, SCREENED, 1)
    plain = store.load("")
    if plain is None:
        plain = measure(program, "", *whole)
        if isinstance(plain, str):
            sys.exit(f"the plain run {plain}")
        store.save("", plain)
    few = without_times(measure(program, "", *screen))
    end = time.time() + 60 * args.minutes
    rows = [row for row in changes_of(constants) if re.search(args.rows, row[0])]
    for number, (_, change, shown) in enumerate(rows):
        if store.load(change) is not None:
            continue
        if time.time() > end:
            print(f"{len(rows) - number} rows are left; run the command again to go on")
            return
        begin = time.time()
        # A step may matter to one kind of mesh only, so it is not judged by a few.
        result = None if shown == "off" else measure(program, change, *screen)
        if result is None or not isinstance(result, str):
            quiet = result is not None and without_times(result) == few
            result = "nothing changes" if quiet else measure(program, change, *whole)
        store.save(change, result)
        print(f"{number + 1}/{len(rows)} {change}: "
              f"{result if isinstance(result, str) else 'measured'} ({time.time() - begin:.0f} s)", flush=True)


def compare(plain, changed):
    """Per figure the mean difference over meshes, each a mean over its draws, and its standard error."""
    meshes = sorted({mesh for mesh, _ in plain})
    result = {}
    for figure, _, ratio in FIGURES:
        values = []
        for mesh in meshes:
            before, after = ([row[figure] for (m, _), row in figures.items() if m == mesh]
                             for figures in (plain, changed))
            a, b = sum(before) / len(before), sum(after) / len(after)
            if not ratio:
                values.append(b - a)
            elif a > 0 and b > 0:
                values.append(math.log(b / a))
        mean = sum(values) / len(values)
        spread = math.sqrt(sum((v - mean) ** 2 for v in values) / max(1, len(values) - 1) / len(values))
        result[figure] = (round(mean, 6), round(spread, 6))
    result["defects"] = sum(r["defects"] for r in changed.values()) - sum(r["defects"] for r in plain.values())
    return result


def cell(figure, ratio, mean, spread):
    factor = 100 if ratio else {"l2": 1e4, "use": 1e3, "jag": 1e3}[figure]
    strong = abs(mean) > 2 * spread and abs(mean) * factor >= 0.05
    text = f"{mean * factor:+.1f} ± {spread * factor:.1f}"
    return f"**{text}**" if strong else text


def rows_of(args, constants, store):
    """All rows: what is measured now, and what the last table has of the others."""
    plain = store.load("")
    written = args.docs / "ablation.json"
    rows = {}
    if written.exists():
        rows = {row["change"]: row for row in json.loads(written.read_text())["rows"]}
    known = list(changes_of(constants))
    rows = {change: rows[change] for _, change, _ in known if change in rows}
    for name, change, shown in known:
        result = store.load(change)
        if result is None or plain is None:
            continue
        rows[change] = {"row": name, "change": change, "shown": shown, "draws": args.draws}
        if isinstance(result, str):
            rows[change]["says"] = result
        else:
            rows[change].update(compare(plain, result))
    return [rows[change] for _, change, _ in known if change in rows], len(known)


def table(args, constants, store):
    rows, known = rows_of(args, constants, store)
    values = {c["name"]: c["value"] for c in constants}
    lines, quiet = [], []
    for row in rows:
        if row.get("says") == "nothing changes":
            quiet.append(f"- `{row['row']}` {row['shown']} ({values[row['row']]})")
            continue
        cells = [row["says"]] + [""] * len(FIGURES) if "says" in row else [
            cell(f, ratio, *row[f]) for f, _, ratio in FIGURES] + [f"{row['defects']:+d}"]
        lines.append(f"| `{row['row']}` | {row['shown']} | {row['draws']} | " + " | ".join(cells) + " |")
    head = """# Ablation

What changes if a step of `charts/`, `param/`, `pack/` or `unwrap/` is left out, or one of their constants is halved or
doubled: means over the generated meshes that decide, and their standard errors over meshes; what is beyond twice that
is bold. Ratios are in per cent, and jag is times 10^3. More is worse, except for page use. Written by
`scripts/ablation.sh`; [how](../charts-measured.md#ablation).

"""
    text = head + "| row | change | draws | " + " | ".join(HEADS[f] for f, _, _ in FIGURES) + " | defects |\n"
    text += "|---" * (len(FIGURES) + 4) + "|\n" + "\n".join(lines) + "\n"
    text += f"\nNothing changes on the first members of each family ({len(quiet)} rows):\n\n" + "\n".join(quiet) + "\n"
    fixed = [c for c in constants if c["fixed"]]
    text += "\nNo rows:\n\n" + "\n".join(f"- `{c['name']}`: {c['fixed']}" for c in fixed) + "\n"
    missing = known - len(rows)
    if missing:
        text += f"\n{missing} rows are not measured yet.\n"
    (args.docs / "ablation.md").write_text(text)
    lines = ",\n".join(json.dumps(row) for row in rows)
    (args.docs / "ablation.json").write_text(f'{{"rows": [\n{lines}\n]}}\n')
    print(f"{len(rows) - len(quiet)} rows that change something, {len(quiet)} that change nothing, {missing} not measured")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("what", choices=["run", "table"])
    parser.add_argument("--build", type=pathlib.Path, required=True, help="the build with LIBATLAS_TUNING")
    parser.add_argument("--docs", type=pathlib.Path, required=True, help="where the table goes")
    parser.add_argument("--half", choices=["deciding", "checking"], default="deciding")
    parser.add_argument("--draws", type=int, default=3, help="of each mesh (3)")
    parser.add_argument("--rows", default="", help="only constants whose names match")
    parser.add_argument("--minutes", type=float, default=1e9, help="begin no row after that time")
    args = parser.parse_args()
    program = args.build / "benchmarks/ablation/atlas-ablation-measure"
    constants = json.loads((args.build / "tuned/constants.json").read_text())
    store = Store(args.build / "ablation", program, args.half, args.draws)
    if args.what == "run":
        run(args, program, constants, store)
    else:
        table(args, constants, store)


main()
