"""Writes completions for bash and zsh from what `PROGRAM --help` prints.

Usage: completion.py PROGRAM TARGET_FOLDER    writes PROGRAM (bash) and _PROGRAM (zsh)
"""
import pathlib
import re
import subprocess
import sys

OPTION = re.compile(r"^  (?P<names>-[\w-]+(?:,-[\w-]+)*)(?P<value>,? [A-Z|a-z]\S*)?(?P<rest>.*)$")


def help_of(command):
    return subprocess.run(command + ["--help"], check=True, capture_output=True, text=True).stdout


def options_of(text):
    """Pairs of an option's names and the line that tells what it does."""
    found, lines = [], text.splitlines()
    for i, line in enumerate(lines):
        match = OPTION.match(line)
        if not match:
            continue
        tail = re.split(r"\s{2,}", line.strip(), maxsplit=1)
        about = tail[1] if len(tail) == 2 else lines[i + 1].strip()
        takes_value = bool(re.match(r"\s?(TEXT|INT|UINT|FLOAT|NAME|WxH|TIME|N\|)", (match["value"] or "").strip()))
        found.append((match["names"].split(","), about, takes_value))
    return found


def commands_of(text):
    part = text.partition("Subcommands:")[2].partition("\n\n")[0]
    return re.findall(r"^  (\w+)\s{2,}(.*)$", part, re.M)


def bash(name, plain, commands):
    words = {"": " ".join([c for c, _ in commands] + [n for names, _, _ in plain for n in names])}
    words |= {c: " ".join(n for names, _, _ in options for n in names) for c, options in commands}
    cases = "\n".join(f"    {c}) words='{words[c]}' ;;" for c, _ in commands)
    function = "_" + name.replace("-", "_")
    return f"""# Completion of {name} for bash.
{function}() {{
  local word="${{COMP_WORDS[COMP_CWORD]}}" words='{words[""]}'
  case "${{COMP_WORDS[1]}}" in
{cases or "    *) ;;"}
  esac
  COMPREPLY=($(compgen -W "$words" -- "$word"))
  [[ "$word" == -* ]] || COMPREPLY+=($(compgen -f -- "$word"))
}}
complete -o filenames -F {function} {name}
"""


def zsh(name, plain, commands):
    def escaped(text):
        return text.replace("'", "'\\''").replace("[", "(").replace("]", ")").replace(":", "\\:")

    def arguments(options, indent):
        lines = [f"'{n}[{escaped(about)}]{':value:_files' if value else ''}'"
                 for names, about, value in options for n in names]
        return (" \\\n" + indent).join(["_arguments -s", *lines, "'*:file:_files'"])

    if not commands:
        return f"#compdef {name}\n{arguments(plain, '  ')}\n"
    cases = "\n".join(f"  {c}) shift words; (( CURRENT-- )); {arguments(options, '    ')} ;;" for c, options in commands)
    return f"#compdef {name}\ncase $words[2] in\n{cases}\n  *) {arguments(plain, '    ')} '1:command:({' '.join(c for c, _ in commands)})' ;;\nesac\n"


def main():
    program, target = sys.argv[1], pathlib.Path(sys.argv[2])
    name = pathlib.Path(program).name
    text = help_of([program])
    commands = [(c, options_of(help_of([program, c]))) for c, _ in commands_of(text)]
    target.mkdir(parents=True, exist_ok=True)
    (target / name).write_text(bash(name, options_of(text), commands))
    (target / f"_{name}").write_text(zsh(name, options_of(text), commands))


main()
