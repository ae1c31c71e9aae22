"""The command line: parse, call, print.

Exit status: 0 a set was found or the set passes, 1 none does, 2 the input is wrong (one line says where and
what). Results go to stdout, warnings and errors to stderr.
"""

from __future__ import annotations

import sys
import time
import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Annotated, Any

import typer

from drivesizer import __version__
from drivesizer.catalog_cli import app as catalog_commands
from drivesizer.errors import DrivesizerError, InputError, quoted

__all__ = ["app", "main"]

app = typer.Typer(
    name="drivesizer",
    no_args_is_help=True,
    rich_markup_mode=None,
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 100},
)

Spec = Annotated[Path, typer.Argument(metavar="[ROBOT.YAML]", help="The spec; robot.yaml when not given.")]
Json = Annotated[bool, typer.Option("--json", help="Print one JSON document and nothing else.")]
Top = Annotated[int, typer.Option(min=1, max=1000, help="How many sets to show.")]
Chosen = Annotated[
    str | None, typer.Option("--set", metavar="MOTOR/GEARHEAD", help="Part numbers, e.g. 118752/406764; else the best.")
]
More = Annotated[
    list[str] | None,
    typer.Option("--catalog", metavar="NAME_OR_FILE", help="A catalogue beside the spec's, e.g. my_parts.yaml or all."),
]
DEFAULT = Path("robot.yaml")
_KINDS = (
    "wheeled_vehicle, conveyor, hoist, lead_screw, ball_screw, rack_pinion, rotary_table, arm, fan, flywheel, "
    "or recorded"
)


def _version(wanted: bool) -> None:
    if wanted:
        typer.echo(f"drivesizer {__version__}")
        raise typer.Exit


@app.callback()
def _root(
    version: Annotated[
        bool, typer.Option("--version", callback=_version, is_eager=True, help="Print the version and stop.")
    ] = False,
) -> None:
    """Size electric drives out of real catalogues: one robot.yaml in, the drive and its proof out."""


def _load(path: Path, more: list[str] | None = None) -> Any:
    """The spec, with further catalogues; their paths count from the current folder."""
    from drivesizer.spec import load_spec

    if path == DEFAULT and not path.exists():
        raise InputError("robot.yaml: there is no such file here; `drivesizer init` writes one to start from")
    spec = load_spec(path)
    if not more:
        return spec
    names = [str(Path(name).absolute()) if name.endswith((".yaml", ".yml")) else name for name in more]
    select = spec.select.model_copy(update={"catalogs": list(dict.fromkeys([*spec.select.catalogs, *names]))})
    return spec.model_copy(update={"select": select})


def _tell(messages: tuple[str, ...]) -> None:
    for message in messages:
        typer.echo(f"note: {message}", err=True)


@app.command(epilog="Example: drivesizer size examples/sps_robot.yaml --top 3 --objective price")
def size(
    spec: Spec = DEFAULT,
    top: Top = 5,
    objective: Annotated[
        str | None, typer.Option(help="mass, price, energy ... or several with weights, e.g. mass=2,price=1.")
    ] = None,
    pareto: Annotated[
        str | None, typer.Option(metavar="NAMES", help="Also print the front of several, e.g. mass,price,energy.")
    ] = None,
    json: Json = False,
    csv: Annotated[Path | None, typer.Option(help="Also write the sets to this CSV file.")] = None,
    pdf: Annotated[Path | None, typer.Option(help="Also write the report to this PDF file.")] = None,
    quiet: Annotated[bool, typer.Option("--quiet", "-q", help="Only the drive, no derivation, no notes.")] = False,
    catalogs: More = None,
) -> None:
    """Find the drive: requirements, the best sets, and why the rest fell."""
    from drivesizer.sizing import size as sized

    with _progress() as progress:
        result = sized(
            _load(spec, catalogs), top=top, objective=_objective(objective), pareto=_pareto(pareto), progress=progress
        )
    if csv:
        from drivesizer.report import write_sets

        write_sets(result, csv)
    if pdf:
        from drivesizer.report import write

        write(result, _proof(result, None), pdf)
    if json:
        from drivesizer import contract

        typer.echo(contract.as_text(contract.sizing(result)))
    else:
        from drivesizer import terminal

        terminal.sizing(result, quiet=quiet)
        _tell(() if quiet else result.warnings)
    raise typer.Exit(0 if result.sets else 1)


def _objective(text: str | None) -> Any:
    """The objective that an option names, None without one."""
    from drivesizer.ranking import objective_of

    return None if text is None else objective_of(text)


def _pareto(text: str | None) -> tuple[str, ...]:
    """The objectives of a front."""
    from drivesizer.choices import OBJECTIVES

    names = tuple(name.strip() for name in text.split(",")) if text else ()
    wrong = [name for name in names if name not in OBJECTIVES]
    if wrong:
        raise InputError(f"--pareto: {quoted(wrong[0])} is not known; expected {', '.join(OBJECTIVES)}")
    if text is not None and len(set(names)) < 2:
        raise InputError(f"--pareto: {quoted(text)} names one objective; expected several, e.g. mass,price,energy")
    return tuple(dict.fromkeys(names))


@contextmanager
def _progress() -> Iterator[Callable[[int, int], None]]:
    """A bar on stderr for a search that lasts longer than a second; nothing for a shorter one."""
    bar: Any = None
    started = time.monotonic()

    def told(done: int, total: int) -> None:
        nonlocal bar
        if bar is None and time.monotonic() - started > 1.0:
            from rich.console import Console
            from rich.progress import Progress

            bar = Progress(console=Console(stderr=True), transient=True)
            bar.add_task("sets examined", total=total)
            bar.start()
        if bar is not None:
            bar.update(bar.task_ids[0], completed=done)

    try:
        yield told
    finally:
        if bar is not None:
            bar.stop()


def _proof(result: Any, profile: str | None) -> Any:
    """The closed-loop validation of the best set, None when there is no set."""
    from drivesizer.simulate import validate as validated

    return validated(result.spec, result.sets[0], profile=profile) if result.sets else None


@app.command(epilog="Example: drivesizer validate examples/sps_robot.yaml --profile trapezoid")
def validate(
    spec: Spec = DEFAULT,
    profile: Annotated[
        str | None,
        typer.Option(help="trapezoid, s-curve, or a CSV file of time and speed; else the spec's."),
    ] = None,
    chosen: Chosen = None,
    json: Json = False,
    csv: Annotated[Path | None, typer.Option(help="Also write the time series to this CSV file.")] = None,
    drawings: Annotated[
        Path | None, typer.Option("--figures", metavar="FOLDER", help="Also draw the loop, Bode and step: SVG and PNG.")
    ] = None,
    case: Annotated[
        str | None, typer.Option(metavar="NAME", help="The load case to drive; else the spec itself.")
    ] = None,
    everything: Annotated[bool, typer.Option("--all", help="The best sets of the search, ranked anew.")] = False,
    top: Annotated[int, typer.Option(min=1, max=100, help="How many, with --all.")] = 5,
    catalogs: More = None,
) -> None:
    """Drive a set through the profile in closed loop: every demand against its limit."""
    from drivesizer.simulate import validate as validated

    robot = _load(spec, catalogs)
    driven = _case(robot, case)
    if everything:
        if chosen or csv or drawings:
            raise InputError("--all: it takes the sets of the search; --set, --csv and --figures are for one of them")
        raise typer.Exit(_all_of(robot, driven, profile, top, json))
    found = _pick(robot, chosen)
    proof = validated(driven, found, profile=profile)
    if drawings:
        from drivesizer.report import write_figures

        for path in write_figures(proof, drawings):
            typer.echo(f"{path} written", err=True)
    if csv:
        from drivesizer.report import write_series

        write_series(proof, csv)
    if json:
        from drivesizer import contract

        typer.echo(contract.as_text(contract.validation(proof)))
    else:
        from drivesizer import terminal

        terminal.validation(proof)
        _tell(proof.warnings)
    raise typer.Exit(0 if proof.status == "pass" else 1)


def _case(robot: Any, name: str | None) -> Any:
    """The load case of a spec that a name stands for; the spec itself without one."""
    found = {case or "": spec for case, spec in robot.load_cases}
    if name is not None and name not in found:
        raise InputError(f"--case: {quoted(name)} is not known; expected {', '.join(filter(None, found)) or 'none'}")
    return robot if name is None else found[name]


def _all_of(robot: Any, driven: Any, profile: str | None, top: int, json: bool) -> int:
    """The best sets of the search in closed loop, those that pass first; the exit status."""
    from drivesizer.simulate import validate_all
    from drivesizer.sizing import size as sized

    result = sized(robot, top=top)
    if not result.sets:
        raise NothingFitsError("no set stands; `drivesizer size` shows the nearest misses")
    proofs, said = validate_all(result, spec=driven, profile=profile)
    if json:
        from drivesizer import contract

        documents = [contract.validation(proof) for proof in proofs]
        typer.echo(contract.as_text({"schema_version": contract.SCHEMA_VERSION, "validations": documents}))
    else:
        from drivesizer import terminal

        terminal.validations(proofs, result.objective)
    _tell(tuple(said))
    return 0 if any(proof.status == "pass" for proof in proofs) else 1


def _pick(robot: Any, chosen: str | None) -> Any:
    """The set to validate: named by its parts, or the best of the search."""
    from drivesizer.sizing import explain as explained
    from drivesizer.sizing import size as sized

    if chosen is None:
        result = sized(robot, top=1)
        if not result.sets:
            raise NothingFitsError(
                "no set stands; `drivesizer size` shows the nearest misses, --set names one to validate"
            )
        return result.sets[0]
    parts = [part.strip() for part in chosen.split("/")]
    if len(parts) > 2 or not all(parts):
        raise InputError(f"--set: {quoted(chosen)} is not MOTOR/GEARHEAD or ACTUATOR; expected e.g. 118752/406764")
    sets = explained(robot, *parts)
    return min(sets, key=lambda s: ({"pass": 0, "unknown": 1, "fail": 2}[s.status], s.rank))


class NothingFitsError(DrivesizerError):
    """The input is right and no set stands: exit status 1."""


@app.command(epilog="Example: drivesizer report examples/sps_robot.yaml -o report.pdf")
def report(
    output: Annotated[Path, typer.Option("--output", "-o", help="report.pdf or report.csv.")],
    spec: Spec = DEFAULT,
    top: Top = 10,
    profile: Annotated[
        str | None,
        typer.Option(help="trapezoid, s-curve, or a CSV file of time and speed; else the spec's."),
    ] = None,
    catalogs: More = None,
) -> None:
    """Write the report: PDF, or CSV tables."""
    from drivesizer.report import write
    from drivesizer.sizing import size as sized

    result = sized(_load(spec, catalogs), top=top)
    for path in write(result, _proof(result, profile), output):
        typer.echo(path)
    raise typer.Exit(0 if result.sets else 1)


@app.command(epilog="Example: drivesizer explain examples/sps_robot.yaml --motor 118743 --gearhead 406764")
def explain(
    motor: Annotated[str, typer.Option(help="Part number of the motor, or of an actuator.")],
    gearhead: Annotated[str, typer.Option(help="Part number of the gearhead; `direct` is none.")] = "",
    spec: Spec = DEFAULT,
    json: Json = False,
    catalogs: More = None,
) -> None:
    """Show why one pair of motor and gearhead passes or fails, check by check."""
    from drivesizer.sizing import explain as explained
    from drivesizer.sizing import load_parts

    robot = _load(spec, catalogs)
    catalog = load_parts(robot)
    sets = explained(robot, motor, gearhead, catalog=catalog)
    if json:
        from drivesizer import contract

        document = {"schema_version": contract.SCHEMA_VERSION, "drivesizer": __version__}
        typer.echo(contract.as_text(document | {"sets": [contract.drive_set(s) for s in sets]}))
    else:
        from drivesizer import terminal

        terminal.explained(sets, catalog)
    raise typer.Exit(0 if any(s.status != "fail" for s in sets) else 1)


@app.command(epilog="Example: drivesizer equations 10")
def equations(
    number: Annotated[str | None, typer.Argument(help="The paper's number, or a requirement's name.")] = None,
) -> None:
    """List the paper's equations, or show one: as printed, as computed, why they differ, units, source."""
    import drivesizer.equations
    from drivesizer import formula, terminal_equations

    if number is None:
        terminal_equations.equations()
        return
    declared = formula.find(number)
    if declared is None:
        raise InputError(f"there is no equation {quoted(number)}; expected 1 to {max(drivesizer.declare.EQUATIONS)}")
    terminal_equations.equation(declared)


@app.command(epilog="Example: drivesizer init --kind wheeled_vehicle -o robot.yaml")
def init(
    kind: Annotated[str, typer.Option(help=f"What is driven: {_KINDS}.")] = "wheeled_vehicle",
    output: Annotated[Path, typer.Option("--output", "-o", help="The file to write; - prints it.")] = DEFAULT,
) -> None:
    """Write a commented robot.yaml to start from."""
    from importlib import resources

    folder = resources.files("drivesizer") / "starters"
    known = sorted(entry.name.removesuffix(".yaml") for entry in folder.iterdir() if entry.name.endswith(".yaml"))
    if kind not in known:
        raise InputError(f"--kind: {quoted(kind)} is not known; expected {', '.join(known)}")
    text = (folder / f"{kind}.yaml").read_text(encoding="utf-8")
    if str(output) == "-":
        typer.echo(text, nl=False)
        return
    try:
        with output.open("x", encoding="utf-8") as file:
            file.write(text)
    except FileExistsError:
        raise InputError(f"{output}: the file exists and is left alone; name another with -o") from None
    except OSError as error:
        raise InputError(f"{output}: cannot be written ({(error.strerror or str(error)).lower()})") from None
    typer.echo(f"{output} written; now: drivesizer size{'' if output == DEFAULT else f' {output}'}")


@app.command(epilog="Example: drivesizer schema > robot.schema.json")
def schema(
    of: Annotated[str, typer.Argument(metavar="[spec|catalog]", help="Of what: spec or catalog.")] = "spec",
) -> None:
    """Print the JSON Schema of robot.yaml, or of a catalogue, for editors."""
    import json

    from drivesizer.catalog.schema import catalog_schema
    from drivesizer.spec import RobotSpec

    made = {"spec": RobotSpec.model_json_schema, "catalog": catalog_schema}
    if of not in made:
        raise InputError(f"there is no schema of {quoted(of)}; expected {' or '.join(made)}")
    typer.echo(json.dumps(made[of](), indent=2, ensure_ascii=False))


app.add_typer(catalog_commands, name="catalog")

# typer brings its own click or uses the installed one; this is that click's root of what a user can get wrong.
_Usage: type[Exception] = next(c for c in typer.BadParameter.__mro__ if c.__name__ == "ClickException")


def main() -> None:
    """Run the command line; every expected failure ends in one line and a status."""
    warnings.showwarning = lambda message, *_, **__: print(f"note: {message}", file=sys.stderr)
    try:
        status = app(standalone_mode=False)
    except NothingFitsError as error:
        status = _fail(str(error), 1)
    except DrivesizerError as error:
        status = _fail(str(error), 2)
    except typer.Abort:
        status = 130
    except BrokenPipeError:
        sys.stderr.close()  # the reader of our output went away: nothing left to say
        status = 0
    except _Usage as error:
        status = _fail(f"{error.format_message()} (try drivesizer --help)", 2)  # type: ignore[attr-defined]
    sys.exit(status or 0)


def _fail(message: str, status: int) -> int:
    print(f"drivesizer: {' '.join(message.split())}", file=sys.stderr)
    return status
