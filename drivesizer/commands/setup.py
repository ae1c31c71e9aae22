"""``drivesizer init``, ``schema``, ``equations`` and ``doctor``."""

from __future__ import annotations

import os
import platform
import re
import sys
import tempfile
import textwrap
import warnings
from collections.abc import Callable, Iterator, Sequence
from functools import partial
from importlib import metadata, resources
from pathlib import Path
from typing import Annotated, Any, NamedTuple

import typer

from drivesizer.commands import common
from drivesizer.commands.common import DEFAULT, Json, OfAxis, at_a_terminal, file_argument, file_option
from drivesizer.errors import DrivesizerError, InputError, nearest, quoted, reason_of
from drivesizer.files.cache import CacheWarning, folder
from drivesizer.files.text import shipped_folder
from drivesizer.files.writing import new, write_files
from drivesizer.version import __version__

# -- Specs to start from: starters by kind of load, examples that ship, and a few questions at a terminal.


_STARTERS = Path(__file__).parents[1] / "spec" / "starters"
_MACHINES = _STARTERS / "machines"
KINDS = sorted(path.stem for path in _STARTERS.glob("*.yaml"))
"""Kinds of load that have a starter."""
MACHINES = sorted(path.stem for path in _MACHINES.glob("*.yaml"))
"""Machines of several axes that have one; ``machine`` is the first that people build, a gantry."""


def starter(kind: str) -> str:
    """The commented spec that ships for a kind of load, or for a machine."""
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
    """Write an example, and the CSV and URDF files that it names beside it, where no such files are yet."""

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


def questionnaire() -> str:
    """The starter of a kind of machine with the figures that the user types; each is read as strictly as in a file."""
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
        title = starter(kind).splitlines()[0].removeprefix("# ").rstrip(".")
        typer.echo(textwrap.fill(f"{number:>3}  {kind:<17} {title}", 80, subsequent_indent=" " * 23))
    while True:
        answer = str(typer.prompt("What moves", default="wheeled_vehicle")).strip()
        name = KINDS[int(answer) - 1] if answer.isdecimal() and 1 <= int(answer) <= len(KINDS) else answer
        if name in KINDS:
            return name
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
        draft = [*lines[:number], f"{start}{answer:<24} {comment or ''}".rstrip(), *lines[number + 1 :]]
        try:
            read_spec(YamlSource("\n".join(draft), "robot.yaml"))
        except InputError as error:
            typer.echo(str(error).partition(": ")[2])
            continue
        lines[:] = draft
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


def equations(
    number: Annotated[str | None, typer.Argument(help="The paper's number, or a requirement's name.")] = None,
    spec: Annotated[
        Path | None, file_argument(metavar="ROBOT.YAML", help="A spec, of which the numbers are put in.")
    ] = None,
    axis: OfAxis = None,
    report: common.Report = None,
) -> None:
    """List the paper's equations, or show one: as printed, as computed, why they differ, units, source; of a spec."""
    from drivesizer.output import derivation
    from drivesizer.output.document import equations as documents
    from drivesizer.platform import robot_figures
    from drivesizer.platform.equations import PLATFORM

    common.accept_reports(report)
    if number is None:
        common.present(documents.equations(), report)
        return
    sizing, platform = derivation.find(number), robot_figures.find(number)
    if sizing is None and platform is None:
        raise InputError(f"there is no equation {quoted(number)}; expected 1 to {max(PLATFORM)}")
    robot = None if spec is None else common.load_axis(spec, None, axis)
    if sizing is not None:
        common.present(documents.equation(sizing, *(_steps(sizing, robot) if robot else ())), report)
    elif platform is not None:
        numbers = _robot_equation(platform, robot) if robot else None
        common.present(documents.platform_equation(platform, numbers), report)


def _steps(declared: Any, robot: Any) -> tuple[Any, str]:
    """Steps of the paper's derivation that are of an equation, and the spec and its best drive that they are for."""
    from drivesizer.search.columns.paper import drive_requirements
    from drivesizer.spec.messages import PAPER_TREATS

    if not robot.paper_applies:
        raise InputError(f"{robot.where(())}: {PAPER_TREATS}; expected such a spec for equations 1 to 20")
    spec, drive = _with_best_drive(robot)
    steps = tuple(r for r in drive_requirements(spec, drive).values() if r.declared is declared)
    if not steps:
        why = "the spec gives its result, or does not need it" if drive else "it needs a drive, and there is none"
        raise InputError(f"{robot.where(())}: {declared.label} is no step of the derivation: {why}")
    return steps, f"{spec.name}, {drive.label}" if drive else spec.name


def _robot_equation(declared: Any, robot: Any) -> Any:
    """An equation of the platform with the numbers of a spec; inertias are those with the best drive's rotors."""
    from drivesizer.output.platform import equation_of

    if robot.platform is None:
        raise InputError(f"{robot.where(())}: no section platform; expected one, e.g. platform: {{layout: ...}}")
    turning = declared.number in range(34, 53) or declared.number >= 57  # of the dynamics
    spec, drive = _with_best_drive(robot) if turning else (robot, None)
    return equation_of(declared, spec, drive, turning)


def _with_best_drive(robot: Any) -> tuple[Any, Any]:
    """The machine of the mass that it was sized for, and the drive that a sizing reports, or None."""
    from drivesizer.sizing import size as sized

    with common.working("sizing the drive"):
        sizing = sized(robot, top=1, detail="drives")
    return sizing.spec, sizing.reported


def init(
    kind: Annotated[
        str | None,
        typer.Option(help=f"Kind of load: {', '.join(KINDS)}; or a machine: {', '.join(MACHINES)}."),
    ] = None,
    output: Annotated[Path, file_option("--output", "-o", help="The file to write; - prints it.")] = DEFAULT,
    example: Annotated[str | None, typer.Option(metavar="NAME", help="An example, such as sps_robot.")] = None,
    urdf: Annotated[
        Path | None,
        file_option("--from-urdf", metavar="FILE", help="Wheels or joints of a URDF, joints of an MJCF."),
    ] = None,
    joint: Annotated[str | None, typer.Option(metavar="NAME", help="With --from-urdf: one joint alone.")] = None,
    drawing: Annotated[
        Path | None, file_option("--sketch", metavar="FILE", help="Also the load with its symbols, as SVG.")
    ] = None,
) -> None:
    """Write a commented robot.yaml to start from: by kind of load, or at a terminal by a few questions."""
    if joint is not None and urdf is None:
        raise InputError("--joint: it names a joint of --from-urdf; expected both")
    options = [name for name, value in (("--kind", kind), ("--example", example), ("--from-urdf", urdf)) if value]
    if len(options) > 1:
        raise InputError(f"{' and '.join(options)}: each gives the whole spec; expected one of them")
    if drawing is not None:
        _draw(kind or "wheeled_vehicle", drawing)
    if urdf is not None:
        _start(_from_description(urdf, joint, output), output)
    elif example is not None:
        _written(copy_example(example, output))
    elif kind is None and str(output) != "-" and at_a_terminal():
        start_by_questions(output)
    else:
        _start(starter(kind or "wheeled_vehicle"), output)


def _draw(kind: str, path: Path) -> None:
    """Write the sketch of a kind of load."""
    from drivesizer.output.sketch import SKETCHES, sketch

    if kind not in SKETCHES:
        raise InputError(f"--sketch: there is none of {quoted(kind)}; expected --kind {', '.join(SKETCHES)}")
    if path.suffix.lower() != ".svg":
        raise InputError(f"--sketch: {quoted(path.name)} is no SVG; expected a name such as {kind}.svg")
    new(path, sketch(kind))


def _from_description(path: Path, joint: str | None, output: Path) -> str:
    """The spec of a vehicle or of one joint of a URDF; of several joints, or of MJCF, a machine."""
    from drivesizer.spec.from_description import has_wheels, joints_to_drive, machine_of, spec_of

    if joint is not None or has_wheels(path) or (path.suffix == ".urdf" and joints_to_drive(path) < 2):
        return spec_of(path, joint)
    answered = at_a_terminal() and str(output) != "-"
    masses = ("with_drives" if typer.confirm(_HOLD_DRIVES, default=True) else "without") if answered else ""
    return machine_of(path, Path() if str(output) == "-" else output.parent, masses)


def start_by_questions(output: Path) -> None:
    """Write the spec that the answers at a terminal give to a file that must not exist yet."""
    if os.path.lexists(output):  # before the first question
        raise InputError(f"{output}: the file exists and is left alone; name another with -o")
    _start(questionnaire(), output)


def _start(text: str, output: Path) -> None:
    """Write a spec where no file is yet, or print it."""
    if str(output) == "-":
        typer.echo(text, nl=False)
        return

    if output.name.isprintable():  # else no comment can hold it
        text = text.replace(_NEXT.format("robot.yaml"), _NEXT.format(output.name), 1)
    new(output, text.encode())
    _written([output])


_HOLD_DRIVES = "Do the masses of its links hold the drives already (most robots on sale do)"
_NEXT = "# Then: drivesizer size {}"  # in a starter, the command with its file


def _written(paths: list[Path]) -> None:
    """Name the files that were written, and the next command."""
    behind = "" if paths[0] == DEFAULT else f" {paths[0]}"
    typer.echo(f"{', '.join(map(str, paths))} written; now: drivesizer size{behind}")


def schema(
    of: Annotated[
        str,
        typer.Argument(metavar="WHAT", help="spec, machine, study, catalog, report, prediction or export."),
    ] = "spec",
) -> None:
    """Print the JSON Schema of robot.yaml, a machine, a study or a catalogue, or of a JSON document, for programs."""
    import json

    from drivesizer.catalog.schema import catalog_schema
    from drivesizer.output.export.machine import export_schema
    from drivesizer.output.json.schema import record_schema, report_schema
    from drivesizer.results.identification import Comparison, Identification
    from drivesizer.results.prediction import Prediction
    from drivesizer.spec.machine import machine_schema
    from drivesizer.spec.robot import RobotSpec
    from drivesizer.study.plan import StudyFile

    schemas: dict[str, Callable[[], Any]] = {
        "spec": RobotSpec.model_json_schema, "catalog": catalog_schema, "report": report_schema,
        "study": StudyFile.model_json_schema, "prediction": partial(record_schema, Prediction), "export": export_schema,
        "machine": machine_schema, "identification": partial(record_schema, Identification),
        "comparison": partial(record_schema, Comparison),
    }  # fmt: skip
    if of not in schemas:
        raise InputError(f"there is no schema of {quoted(of)}; expected {' or '.join(schemas)}")
    typer.echo(json.dumps(schemas[of](), indent=2, ensure_ascii=False))


def doctor(json: Json = False) -> None:
    """Check this installation: libraries, cache, catalogues, fonts, terminal."""
    findings = examined()
    if json:
        common.print_json({"findings": findings})
    else:
        print_findings(findings)
    raise typer.Exit(0 if all(f.works for f in findings) else 1)


# -- Check of an installation: libraries, cache, catalogues, fonts, terminal; with a remedy for each failure.


class Finding(NamedTuple):
    """Result of one check of the installation."""

    subject: str
    found: str
    works: bool
    remedy: str = ""  # where it does not work


def examined() -> list[Finding]:
    """Everything that a command needs, in the order in which it would fail."""
    return [finding for look in (_program, _libraries, _cache, _catalogues, _machine_code, _report, _terminal)
            for finding in _findings_of(look)]  # fmt: skip


def _findings_of(look: Callable[[], Iterator[Finding]]) -> list[Finding]:
    """Findings of one check; a failure inside it is a finding too."""
    findings: list[Finding] = []
    try:
        findings.extend(look())
    except (DrivesizerError, ImportError, OSError, RuntimeError) as error:
        name = look.__name__.strip("_").replace("_", " ")
        findings.append(Finding(name, f"{type(error).__name__}: {error}", False, "install drivesizer anew"))
    return findings


def _program() -> Iterator[Finding]:
    yield Finding("drivesizer", f"{__version__} in {Path(str(resources.files('drivesizer')))}", True)
    yield Finding("Python", f"{platform.python_version()} ({sys.executable})", sys.version_info >= (3, 11),
                  "drivesizer needs Python 3.11 or later")  # fmt: skip


def _libraries() -> Iterator[Finding]:
    """Each library that drivesizer names, with the least version required; one of an extra may be missing."""
    for line in metadata.requires("drivesizer") or ():
        required = re.match(r"([\w.-]+)\s*>=\s*([\d.]+)(?:\s*;\s*(.*))?$", line)
        extra = re.search(r"extra\s*==\s*['\"](\w+)", line)
        below = re.search(r"python_version\s*<\s*['\"]([\d.]+)", (required and required[3]) or "")
        of_later = below is not None and sys.version_info[:2] >= tuple(_number(below[1]))
        if required is None or of_later or (extra and extra[1] == "dev"):
            continue
        name, least = required[1], required[2]
        try:
            version = metadata.version(name)
        except metadata.PackageNotFoundError:
            state = f"not installed, optional: pip install drivesizer[{extra[1]}]" if extra else "missing"
            yield Finding(name, state, extra is not None, f"pip install '{name}>={least}'")
            continue
        yield Finding(name, version, _number(version) >= _number(least), f"pip install '{name}>={least}'")


def _number(version: str) -> list[int]:
    """Leading numbers of a version.

    >>> _number("0.10.2.post1")
    [0, 10, 2]
    """
    leading = re.match(r"\d+(?:\.\d+)*", version)
    return [int(part) for part in leading[0].split(".")] if leading else []


def _cache() -> Iterator[Finding]:
    from drivesizer.output.words import number_of

    place = folder()
    try:
        place.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=place):
            pass
    except OSError as error:
        state = f"{place} cannot be written ({reason_of(error)})"
        yield Finding("cache", state, False, "every start is slower; name another folder with DRIVESIZER_CACHE")
        return
    files = [path for path in place.rglob("*") if path.is_file()]
    size = sum(path.stat().st_size for path in files) / 1e6
    yield Finding("cache", f"{place}: {number_of(len(files), 'file')}, {size:.1f} MB", True)


def _catalogues() -> Iterator[Finding]:
    from drivesizer.catalog import load
    from drivesizer.output.words import number_of

    with warnings.catch_warnings():
        warnings.simplefilter("ignore", CacheWarning)  # the cache's own finding says it
        parts = load(("all",))
    counts = ", ".join(f"{len(getattr(parts, name).rows)} {name}" for name in ("motors", "gearheads", "actuators"))
    text = f"{number_of(len(parts.digests), 'file')}: {counts}"
    yield Finding("catalogues", text, bool(parts.digests), "install drivesizer anew")


def _machine_code() -> Iterator[Finding]:
    from drivesizer.control.engine import is_compiled

    ready = is_compiled()
    slow = "not at hand as machine code, some hundred times slower without numba"
    yield Finding("closed loop", "ready as machine code" if ready else slow, ready, "install drivesizer anew")


def _report() -> Iterator[Finding]:
    """Whether a page can be set and a figure drawn."""
    from drivesizer.output.report.figures.style import Drawing
    from drivesizer.output.report.pdf import fonts

    figure = Drawing(lambda figure: figure.add_subplot().plot([0.0, 1.0]))()
    yield Finding("figures", f"drawn by matplotlib ({len(figure)} bytes)", figure.startswith(b"<?xml"))
    import typst

    page: bytes = typst.compile(b'#set text(font: "DejaVu Sans")\nA page', font_paths=fonts(), format="pdf")
    yield Finding("PDF and fonts", f"set by typst ({len(page)} bytes)", page.startswith(b"%PDF"))


def _terminal() -> Iterator[Finding]:
    from drivesizer.output.terminal.tables import console

    terminal = console()
    colour = "colour" if terminal.color_system else "no colour"
    because = " (NO_COLOR)" if os.environ.get("NO_COLOR") else ""
    yield Finding("terminal", f"{terminal.width} columns, {colour}{because}, {terminal.encoding}", True)
    works = terminal.encoding.lower().replace("-", "") == "utf8"
    if not works:
        yield Finding("letters", "Greek letters and frames cannot be shown", False, "set PYTHONUTF8=1")


def print_findings(findings: Sequence[Finding]) -> None:
    """Print what was examined, and the remedy where something does not work."""
    from drivesizer.commands.common import show_blocks
    from drivesizer.output.document import records as doc

    rows = [(finding.subject, finding.found, "ok" if finding.works else (doc.Strong("WRONG"),)) for finding in findings]
    remedies = [doc.Words(f"{finding.subject}: {finding.remedy}") for finding in findings if not finding.works]
    show_blocks([doc.table("installation", "", rows), *(remedies or [doc.Words("Everything works.")])])
