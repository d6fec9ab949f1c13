"""Writes the component `uv` as two files, libatlas.h and libatlas.cpp, for projects that would rather
compile one source than build a library.

Usage: python3 scripts/two_files.py [TARGET_FOLDER]        (out/two_files by default)

The source needs the headers of Eigen, GLM and fmt beside it or installed, and C++20:
  g++ -std=c++20 -O2 -ffp-contract=off -c libatlas.cpp -I eigen3
The header has the C++ and the C interface; a C compiler sees the latter alone.
"""
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
MODULES = ["core", "param", "charts", "raster", "pack", "uvs", "unwrap", "c"]
C_HEADER = "libatlas/c/atlas.h"
THREADS = "run_chunks_own.cpp background.cpp granted_threads.cpp"  # of core/CMakeLists.txt
INCLUDE = re.compile(r'^[ \t]*#[ \t]*include[ \t]+"(libatlas/[^"]+)"[^\n]*\n', re.M)

NOTICE = """// libatlas, the component uv: charts, uvs and atlas packing of triangle meshes.
// Made by scripts/two_files.py from the sources of version {version}; change those, not this file.
//
{licence}
"""


def version():
    return re.search(r"VERSION (\d+\.\d+\.\d+)", (ROOT / "CMakeLists.txt").read_text())[1]


def notice():
    licence = (ROOT / "LICENSE").read_text().strip().splitlines()
    text = "\n".join(("// " + line).rstrip() for line in licence)
    return NOTICE.format(version=version(), licence=text)


def is_internal(text):
    return text.startswith("// Internal")


class Writer:
    """Headers are written once, before what includes them."""

    def __init__(self):
        self.done = set()

    def header(self, name):
        if name in self.done:
            return ""
        self.done.add(name)
        text = (ROOT / name).read_text()
        return self.expand(text.replace("#pragma once\n", ""), name)

    def expand(self, text, name):
        before = "".join(self.header(match[1]) for match in INCLUDE.finditer(text))
        return f"{before}\n// ---- {name} ----\n\n{INCLUDE.sub('', text).strip()}\n"


def sources():
    for module in MODULES:
        text = (ROOT / "libatlas" / module / "CMakeLists.txt").read_text()
        listed = re.search(r"SOURCES\s+(.*?)(?:DEPENDS|PRIVATE_LIBS|\))", text, re.S)[1]
        for name in listed.replace("${threads}", THREADS).split():
            yield f"libatlas/{module}/{name}"


def unnamed_bodies(text):
    """The bodies of the unnamed namespaces of a source."""
    for match in re.finditer(r"^namespace \{\n(.*?)^\}  // namespace\n", text, re.M | re.S):
        yield match[1]


DECLARED = re.compile(
    r"^(?:template <[^\n]*>\n)?(?:(?:struct|class|enum class|enum|union) (?P<type>\w+)|using (?P<alias>\w+) =|"
    r"[A-Za-z_][\w:<>,*& ]*?[ *&](?P<name>\w+)(?:\[[^\]]*\])?\s*(?:\(|=|\{|;))", re.M)


def declared_names(bodies):
    """Names that are declared at the outermost level, that is, not indented."""
    names = set()
    for body in bodies:
        for match in DECLARED.finditer(body):  # what is nested is indented
            name = match["type"] or match["alias"] or match["name"]
            if name and name not in ("return", "namespace", "operator"):
                names.add(name)
        for line in re.findall(r"^constexpr [^;(]*;", body, re.M):
            names.update(re.findall(r"\bk[A-Z]\w*(?= *[={])", line))
    return names


def renamed(text, names, suffix):
    if not names:
        return text
    pattern = re.compile(r"(?<![\w.\"])(?<!->)(?:(?<!::)|(?<=atlas::c::))(" + "|".join(sorted(names)) + r")\b")
    lines = text.splitlines(keepends=True)
    return "".join(line if line.startswith("#include") else
                   pattern.sub(lambda match: f"{match[1]}_{suffix}", line) for line in lines)


def main():
    target = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else ROOT / "out" / "two_files")
    target.mkdir(parents=True, exist_ok=True)
    writer = Writer()
    public = [path for module in MODULES for path in sorted((ROOT / "libatlas" / module).rglob("*.h"))
              if not is_internal(path.read_text()) and str(path.relative_to(ROOT)) != C_HEADER]
    body = "".join(writer.header(str(path.relative_to(ROOT))) for path in public)
    header = (notice() + "#pragma once\n\n#ifdef __cplusplus\n" + body + "\n#endif  // __cplusplus\n"
              + writer.header(C_HEADER))
    (target / "libatlas.h").write_text(header)

    texts = {name: (ROOT / name).read_text() for name in sources()}
    used = {}  # by which folders and headers
    for name, text in texts.items():
        for declared in declared_names(unnamed_bodies(text)):
            used.setdefault(declared, set()).add(name.rpartition("/")[0])
    for module in MODULES:
        for path in (ROOT / "libatlas" / module).rglob("*.h"):
            for declared in declared_names([path.read_text()]):
                used.setdefault(declared, set()).add(str(path))
    parts = []
    for name, text in texts.items():
        clashing = {declared for declared in declared_names(unnamed_bodies(text)) if len(used[declared]) > 1}
        suffix = re.sub(r"\W", "_", name.removeprefix("libatlas/").removesuffix(".cpp"))
        before = "".join(writer.header(match[1]) for match in INCLUDE.finditer(text))
        own = renamed(INCLUDE.sub("", text), clashing, suffix)
        parts.append(f"{before}\n// ---- {name} ----\n\n{own.strip()}\n")
    source = (notice() + "\n#define Eigen atlas_eigen\n#define EIGEN_DONT_VECTORIZE\n#define EIGEN_MPL2_ONLY\n#ifndef FMT_HEADER_ONLY\n"
              "#define FMT_HEADER_ONLY\n#endif\n#define LIBATLAS_C_BUILT\n\n"
              '#include "libatlas.h"\n' + "".join(parts))
    (target / "libatlas.cpp").write_text(source)
    print(f"{target / 'libatlas.h'}: {header.count(chr(10))} lines")
    print(f"{target / 'libatlas.cpp'}: {source.count(chr(10))} lines")


main()
