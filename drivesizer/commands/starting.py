"""Specs to start from: starters by kind of load, examples that ship, and a few questions at a terminal."""

from __future__ import annotations

import os
import re
import sys
from pathlib import Path

import typer

from drivesizer.errors import InputError, nearest, quoted
from drivesizer.files.shipped import shipped_folder

__all__ = ["KINDS", "MACHINES", "copy_example", "examples", "interactive", "questionnaire", "starter"]

_STARTERS = Path(__file__).parents[1] / "spec" / "starters"
_MACHINES = _STARTERS / "machines"
KINDS = sorted(path.stem for path in _STARTERS.glob("*.yaml"))
"""Kinds of load that have a starter."""
MACHINES = sorted(path.stem for path in _MACHINES.glob("*.yaml"))
"""Machines of several axes that have one; ``machine`` is the first that people build, a gantry."""


def starter(kind: str) -> str:
    """The commented spec that ships for a kind of load, or for a machine.

    Parameters
    ----------
    kind
        One of ``KINDS`` or ``MACHINES``, or ``machine``.

    Returns
    -------
    str
        YAML.

    Raises
    ------
    InputError
        When there is none.
    """
    name = "gantry" if kind == "machine" else kind
    if name not in KINDS and name not in MACHINES:
        known = ", ".join([*KINDS, "machine", *MACHINES])
        raise InputError(f"--kind: {quoted(kind)} is not known; expected {known}")
    return ((_STARTERS if name in KINDS else _MACHINES) / f"{name}.yaml").read_text(encoding="utf-8")


# --- examples ---------------------------------------------------------------------------------------------------------


def examples() -> dict[str, Path]:
    """The specs that ship as examples, by name."""
    paths = sorted(shipped_folder("examples").glob("*.yaml"))
    return {path.stem: path for path in paths if path.stem != "study"}


def copy_example(name: str, output: Path) -> list[Path]:
    """Write an example, and the CSV and URDF files that it names beside it, where no such files are yet.

    Parameters
    ----------
    name
        Of ``examples``.
    output
        The spec to write.

    Returns
    -------
    list of Path
        Files that were written, the spec first.

    Raises
    ------
    InputError
        When there is no such example, or a file exists.
    """
    from drivesizer.files.writing import write_files

    known = examples()
    if name not in known:
        raise InputError(f"--example: {quoted(name)} is not known; expected {', '.join(known)}{nearest(name, known)}")
    source = known[name]
    text = source.read_text(encoding="utf-8")
    named = [source.parent / file for file in dict.fromkeys(re.findall(r"[\w-]+\.(?:csv|urdf)\b", text))]
    files = {output: text.encode()} | {output.parent / file.name: file.read_bytes() for file in named if file.is_file()}
    for path in files:
        if os.path.lexists(path):
            raise InputError(f"{path}: the file exists and is left alone; start in another folder")
    return write_files(files)


# --- questions --------------------------------------------------------------------------------------------------------

_FIGURE = re.compile(r"^(  (\w+): )([-+.\d][^#{\[]*?)( *)(#.*)?$")
_PROMPTED = {"load": None, "motion": {"speed", "travel", "period", "acceleration_time"}, "supply": {"nominal"}}
_OF_THE_TRADE = {"mass": "lb", "length": "in", "speed": "ft/s", "force": "lbf", "torque": "lbf*in",
                 "inertia": "lb*in^2", "temperature": "degF"}  # fmt: skip


def interactive() -> bool:
    """Whether someone is there to answer: both ends of the program are terminals."""
    return sys.stdin.isatty() and sys.stdout.isatty()


def questionnaire() -> str:
    """The starter of a kind of machine with the figures that the user types; each is read as strictly as in a file.

    Returns
    -------
    str
        YAML with the comments of the starter.
    """
    kind = _kind()
    lines = starter(kind).splitlines()
    american = typer.prompt("Units: metric or US", default="metric", show_default=True).strip().lower().startswith("u")
    typer.echo("Enter keeps a figure; any unit will do, such as 45 kg, 99 lb, 6 in, 1.5 m/s.")
    section = ""
    for number, line in enumerate(lines):
        section = line.split(":")[0] if re.match(r"\w", line) else section
        figure = _FIGURE.match(line)
        if figure and section in _PROMPTED and figure[2] in (_PROMPTED[section] or {figure[2]}):
            _prompt(lines, number, figure, american=american)
    return "\n".join(lines) + "\n"


def _kind() -> str:
    """The kind of load that is chosen out of a list, by number or by name."""
    for number, kind in enumerate(KINDS, 1):
        said = starter(kind).splitlines()[0].removeprefix("# ").rstrip(".")
        typer.echo(f"{number:>3}  {kind:<17} {said}")
    while True:
        answer = str(typer.prompt("What moves", default="wheeled_vehicle")).strip()
        chosen = KINDS[int(answer) - 1] if answer.isdecimal() and 1 <= int(answer) <= len(KINDS) else answer
        if chosen in KINDS:
            return chosen
        typer.echo(f"{quoted(answer)} is not in the list{nearest(answer, KINDS)}")


def _prompt(lines: list[str], number: int, figure: re.Match[str], *, american: bool) -> None:
    """Prompt for the figure of a line until the spec with it can be read; put it into the line."""
    from drivesizer.files.yaml_source import YamlSource
    from drivesizer.spec.robot import read_spec

    start, name, now, _, comment = figure.groups()
    now = _american(now) if american else now
    hint = f"  ({comment.removeprefix('# ').split(';')[0]})" if comment else ""
    while True:
        answer = str(typer.prompt(f"{name.replace('_', ' ')}{hint}", default=now)).strip()
        tried = [*lines[:number], f"{start}{answer:<24} {comment or ''}".rstrip(), *lines[number + 1 :]]
        try:
            read_spec(YamlSource("\n".join(tried), "robot.yaml"))
        except InputError as error:
            typer.echo(str(error).partition(": ")[2])
            continue
        lines[:] = tried
        return


def _american(text: str) -> str:
    """A figure in the unit that an American shop uses, to three digits; the same where it has none.

    >>> _american("30 kg"), _american("200 mm"), _american("0.015"), _american("24 V")
    ('66.1 lb', '7.87 in', '0.015', '24 V')
    """
    from drivesizer.units import from_si, kind_of_unit, to_si

    _, _, unit = text.partition(" ")
    kind = kind_of_unit(unit.strip()) if unit.strip() else ""
    if kind not in _OF_THE_TRADE:
        return text
    return f"{from_si(to_si(text, kind), _OF_THE_TRADE[kind], kind):.3g} {_OF_THE_TRADE[kind]}"
