"""Writes the folders whose constants decide charts and pages once more, with constants that a
program's environment can change (tuned.h), and a table of them.

Usage: instrument.py SOURCE_ROOT TARGET_FOLDER

Every `constexpr` number of a folder below becomes a row, named after its file and itself, and so does
every step in rules.txt. The sources that users compile stay as they are. Rows that must be known to
the compiler, or that no result hangs on, are listed with their reason in fixed_constants.txt.
"""
import json
import pathlib
import re
import sys

FOLDERS = ["param", "charts", "pack", "unwrap"]

COMMENT_OR_STRING = re.compile(r'//[^\n]*|/\*.*?\*/|"(?:\\.|[^"\\\n])*"|\'(?:\\.|[^\'\\\n])\'', re.S)
DECLARATION = re.compile(
    r"(?P<head>(?:\b(?:static|inline)\s+)*)\bconstexpr\s+(?P<type>[A-Za-z_][\w:]*(?:<[\w:, ]*>)?)\s+(?P<rest>k[A-Z][^;]*);")
NUMBER = re.compile(r"(?<![\w.'])(?:0[xX][0-9a-fA-F']+|(?:\d[\d']*\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)(?:[uUlLfF]*)(?![\w.])")
SCALARS = {"double", "float", "int", "bool", "std::size_t", "std::int32_t", "std::uint32_t",
           "std::int64_t", "std::uint64_t", "std::uint8_t", "std::uint16_t"}


def blank(text):
    """The text with comments and strings as blanks of the same length."""
    return COMMENT_OR_STRING.sub(lambda m: re.sub(r"[^\n]", " ", m.group()), text)


def innermost_is_class(text, position):
    """Whether the innermost braces around a position are those of a class."""
    depth = 0
    for i in range(position - 1, -1, -1):
        if text[i] == "}":
            depth += 1
        elif text[i] == "{":
            if depth == 0:
                begin = max(text.rfind(";", 0, i), text.rfind("}", 0, i), text.rfind("{", 0, i)) + 1
                return bool(re.search(r"\b(?:struct|class)\s+\w[\w:]*\s*(?:final)?\s*(?::[^:].*)?$",
                                      text[begin:i], re.S))
            depth -= 1
    return False


def split_declarators(rest):
    """Splits `kA = 1, kB = f(2, 3)` at its outer commas."""
    parts, depth, begin = [], 0, 0
    for i, c in enumerate(rest):
        if c in "({[":
            depth += 1
        elif c in ")}]":
            depth -= 1
        elif c == "," and depth == 0:
            parts.append(rest[begin:i])
            begin = i + 1
    return parts + [rest[begin:]]


def read_rules(text):
    """Returns {file: [(name, code, code without the step)]}."""
    rules = {}
    for line in text.splitlines():
        if line and not line.startswith("#"):
            file, name, code, without = (part.strip().replace("\\|", "|")
                                         for part in re.split(r"(?<!\\)\|", line))
            rules.setdefault(file, []).append((name, code, without))
    return rules


class File:
    def __init__(self, path, name, fixed, rules=()):
        self.text = path.read_text()
        self.plain = blank(self.text)
        self.name, self.fixed, self.rules, self.rows, self.seen = name, fixed, rules, [], {}

    def row(self, constant, position, type_name, value):
        count = self.seen[constant] = self.seen.get(constant, 0) + 1
        key = f"{self.name}:{constant}" + (f"#{count}" if count > 1 else "")
        line = self.text.count("\n", 0, position) + 1
        self.rows.append({"name": key, "line": line, "type": type_name,
                          "value": " ".join(value.split()), "fixed": self.fixed.get(key, "")})
        return key

    def with_rules(self, text):
        """The text with steps that can be left out."""
        for name, code, without in self.rules:
            at = self.text.find(code)
            if at < 0:
                sys.exit(f"rules.txt: {self.name} has no `{code}`")
            key = self.row(name, at, "bool", "true")
            on = f'::atlas::tuned<bool>("{key}", true)'
            if code.endswith(";"):
                changed = f"if ({on}) {{ {code} }} else {{ {without} }}"
            else:
                changed = f"({on} ? ({code}) : ({without}))"
            text = text.replace(code, changed)
        return text

    def instrumented(self):
        out, end = [], 0
        for match in DECLARATION.finditer(self.plain):
            replaced = self.declaration(match)
            if replaced is None:
                continue
            out += [self.text[end:match.start()], replaced]
            end = match.end()
        if not out and not self.rules:
            return None
        return self.with_rules("".join(out) + self.text[end:])

    def declaration(self, match):
        """The declaration with values that can change, or None if it has no number to change."""
        type_name, rest = match["type"], match["rest"]
        members = innermost_is_class(self.plain, match.start())
        storage = "static inline const" if members else "inline const" if "inline" in match["head"] else "static const"
        plain, tuned, changed = [], [], False
        for part in split_declarators(rest):
            text, any_row = self.declarator(part, type_name, match.start())
            changed |= any_row
            (tuned if any_row else plain).append(text)
        if not changed:
            return None
        kept = f"{match['head']}constexpr {type_name} {', '.join(plain)}; " if plain else ""
        return f"{kept}{storage} {type_name} {', '.join(tuned)};"

    def declarator(self, part, type_name, position):
        name = re.match(r"\s*(k\w+)", part)[1]
        if not NUMBER.search(re.sub(r"\bk\w+", "", part)) and type_name != "bool":
            return part.strip(), len(re.findall(r"\bk[A-Z]\w*", part)) > 1  # derived from others?
        if type_name in SCALARS and "[" not in part:
            value = re.match(r"\s*k\w+\s*(?:=\s*(.*)|\{(.*)\}\s*)$", part, re.S)
            value = value[1] or value[2]
            key = self.row(name, position, type_name, value)
            if self.fixed.get(key):
                return part.strip(), False
            return f'{name} = ::atlas::tuned<{type_name}>("{key}", {value.strip()})', True
        count, any_row = 0, False

        def number(found):
            nonlocal count, any_row
            key = self.row(f"{name}.{count}", position, "number", found.group())
            count += 1
            if self.fixed.get(key) or self.fixed.get(f"{self.name}:{name}"):
                self.rows[-1]["fixed"] = self.fixed.get(key) or self.fixed[f"{self.name}:{name}"]
                return found.group()
            any_row = True
            call = "tuned" if "array" in type_name or "[" in part else "TunedNumber"
            return f'::atlas::{call}("{key}", {found.group()})'

        head = re.match(r"\s*k\w+(?:\[[^\]]*\])?\s*=?", part)[0]
        text = head + NUMBER.sub(number, part[len(head):])
        return text.strip(), any_row


def main():
    root, target = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2])
    fixed = {}
    for line in (pathlib.Path(__file__).parent / "fixed_constants.txt").read_text().splitlines():
        if line and not line.startswith("#"):
            key, reason = line.split(None, 1)
            fixed[key] = reason
    rules = read_rules((pathlib.Path(__file__).parent / "rules.txt").read_text())
    rows = []
    for folder in FOLDERS:
        for path in sorted((root / "libatlas" / folder).rglob("*")):
            if path.suffix not in (".h", ".cpp"):
                continue
            name = str(path.relative_to(root / "libatlas"))
            file = File(path, name, fixed, rules.pop(name, ()))
            text = file.instrumented()
            rows += file.rows
            out = target / "libatlas" / name
            if text is None and path.suffix == ".h":
                out.unlink(missing_ok=True)  # the plain one is found in the source folder
                continue
            out.parent.mkdir(parents=True, exist_ok=True)
            text = f'#include "benchmarks/ablation/tuned.h"\n#line 1 "{path}"\n' + (text or file.text)
            if not out.exists() or out.read_text() != text:
                out.write_text(text)
    (target / "constants.json").write_text(json.dumps(rows, indent=1) + "\n")
    if rules:
        sys.exit("rules.txt names files that are not there: " + ", ".join(sorted(rules)))
    unknown = set(fixed) - {row["name"] for row in rows} - {row["name"].rsplit(".", 1)[0] for row in rows}
    if unknown:
        sys.exit("fixed_constants.txt names what is not there: " + ", ".join(sorted(unknown)))


main()
