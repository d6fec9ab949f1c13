"""The declarations of the package are those of libatlas/c/atlas.h."""

import ctypes
import os
import re
import shutil
import subprocess
from pathlib import Path

import pytest

from libatlas import _library, _structs

HEADER = Path(__file__).parents[3] / "libatlas" / "c" / "atlas.h"
pytestmark = pytest.mark.skipif(not HEADER.exists(), reason="needs the repository")


def declared():
    """Names and parameters of the header's functions."""
    text = re.sub(r"//[^\n]*", "", HEADER.read_text())
    found = re.findall(r"^LIBATLAS_API\s[^;#]*?libatlas_(\w+)\(([^;]*)\);", text, re.M)
    return {name: [] if args.strip() == "void" else args.split(",") for name, args in found}


def test_all_functions_are_declared_with_as_many_parameters():
    header = declared()
    assert len(header) > 20
    assert {name: len(args) for name, args in _library._TAKES.items()} == {
        name: len(args) for name, args in header.items()
    }


def test_all_structs_are_declared():
    text = HEADER.read_text()
    assert set(re.findall(r"^typedef struct (\w+) \{", text, re.M)) == set(_structs.STRUCTS)


def test_members_lie_where_the_compiler_puts_them(tmp_path):
    compiler = shutil.which(os.environ.get("CC", "cc"))
    if compiler is None:
        pytest.skip("needs a C compiler")
    lines = ["#include <stdio.h>", f'#include "{HEADER}"', "int main(void) {"]
    expected = []
    for name, struct in _structs.STRUCTS.items():
        lines.append(f'  printf("%zu\\n", sizeof({name}));')
        expected.append(ctypes.sizeof(struct))
        for member, kind in struct._fields_:
            lines.append(f'  printf("%zu\\n", offsetof({name}, {member}));')
            lines.append(f'  printf("%zu\\n", sizeof((({name}*)0)->{member}));')
            expected += [getattr(struct, member).offset, ctypes.sizeof(kind)]
    source = tmp_path / "layout.c"
    source.write_text("\n".join([*lines, "  return 0;", "}"]))
    program = tmp_path / "layout"
    subprocess.run([compiler, str(source), "-o", str(program)], check=True)
    printed = subprocess.run([str(program)], check=True, capture_output=True, text=True).stdout
    assert [int(number) for number in printed.split()] == expected


@pytest.mark.parametrize("name", ["Placement", "Instance"])
def test_numpy_sees_elements_as_the_struct(name):
    struct, dtype = getattr(_structs, name), getattr(_structs, name.upper())
    fields = {field: offset for field, (_, offset) in dtype.fields.items()}
    assert fields == {field: getattr(struct, field).offset for field, _ in struct._fields_}
    assert dtype.itemsize == ctypes.sizeof(struct)


def test_options_are_those_of_the_structs():
    from libatlas import IslandOptions, PackOptions, UnwrapOptions

    for typed, struct in (
        (UnwrapOptions, _structs.UnwrapOptions),
        (PackOptions, _structs.PackOptions),
        (IslandOptions, _structs.IslandOptions),
    ):
        assert list(typed.__annotations__) == [name for name, _ in struct._fields_ if name != "size"]
