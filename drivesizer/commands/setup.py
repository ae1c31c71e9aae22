"""``drivesizer init``, ``schema``, ``equations`` and ``doctor``."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Annotated, Any

import typer

from drivesizer.commands.common import DEFAULT, Json, OfAxis, load, working
from drivesizer.commands.options import file_argument, file_option
from drivesizer.commands.starting import KINDS, MACHINES, copy_example, interactive, questionnaire, starter
from drivesizer.errors import InputError, quoted

__all__ = ["doctor", "equations", "init", "schema", "start_by_questions"]


def equations(
    number: Annotated[str | None, typer.Argument(help="The paper's number, or a requirement's name.")] = None,
    spec: Annotated[
        Path | None, file_argument(metavar="ROBOT.YAML", help="A spec, of which the numbers are put in.")
    ] = None,
    axis: OfAxis = None,
) -> None:
    """List the paper's equations, or show one: as printed, as computed, why they differ, units, source; of a spec."""
    from drivesizer.output import formula
    from drivesizer.output.terminal import equations as terminal_equations
    from drivesizer.platform import printed_forms
    from drivesizer.platform.matrix_equation import PLATFORM

    if number is None:
        terminal_equations.equations()
        return
    sizing, platform = formula.find(number), printed_forms.find(number)
    if sizing is None and platform is None:
        raise InputError(f"there is no equation {quoted(number)}; expected 1 to {max(PLATFORM)}")
    robot = None if spec is None else load(spec, None, axis)
    if sizing is not None:
        terminal_equations.equation(sizing, *(_steps(sizing, robot) if robot else ()))
    elif platform is not None:
        terminal_equations.platform_equation(platform, _robot_equation(platform, robot) if robot else None)


def _steps(declared: Any, robot: Any) -> tuple[Any, str]:
    """Steps of the paper's derivation that are of an equation, and the spec and its best drive that they are for."""
    from drivesizer.search.paper.derivation import drive_requirements
    from drivesizer.spec.robot.contradictions import PAPER_TREATS

    if not robot.paper_applies:
        raise InputError(f"{robot.where(())}: {PAPER_TREATS}; expected such a spec for equations 1 to 20")
    spec, drive = _with_best_drive(robot)
    found = tuple(r for r in drive_requirements(spec, drive).values() if r.declared is declared)
    if not found:
        why = "the spec gives its result, or does not need it" if drive else "it needs a drive, and there is none"
        raise InputError(f"{robot.where(())}: {declared.label} is no step of the derivation: {why}")
    return found, f"{spec.name}, {drive.label}" if drive else spec.name


def _robot_equation(declared: Any, robot: Any) -> Any:
    """An equation of the platform with the numbers of a spec; inertias are those with the best drive's rotors."""
    from drivesizer.output.platform_numbers import equation_of
    from drivesizer.platform import equations_dynamics

    if robot.platform is None:
        raise InputError(f"{robot.where(())}: no section platform; expected one, e.g. platform: {{layout: ...}}")
    turning = declared.name in equations_dynamics.__all__
    spec, drive = _with_best_drive(robot) if turning else (robot, None)
    return equation_of(declared, spec, drive, turning)


def _with_best_drive(robot: Any) -> tuple[Any, Any]:
    """The machine of the mass that it was sized for, and the drive that a sizing reports, or None."""
    from drivesizer.sizing import size as sized

    with working("sizing the drive"):
        found = sized(robot, top=1, brief=True)
    return found.spec, found.shown


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
) -> None:
    """Write a commented robot.yaml to start from: by kind of load, or at a terminal by a few questions."""
    if joint is not None and urdf is None:
        raise InputError("--joint: it names a joint of --from-urdf; expected both")
    chosen = [name for name, given in (("--kind", kind), ("--example", example), ("--from-urdf", urdf)) if given]
    if len(chosen) > 1:
        raise InputError(f"{' and '.join(chosen)}: each gives the whole spec; expected one of them")
    if urdf is not None:
        _start(_from_description(urdf, joint, output), output)
    elif example is not None:
        _written(copy_example(example, output))
    elif kind is None and str(output) != "-" and interactive():
        start_by_questions(output)
    else:
        _start(starter(kind or "wheeled_vehicle"), output)


def _from_description(path: Path, joint: str | None, output: Path) -> str:
    """The spec of a vehicle or of one joint of a URDF; of several joints, or of MJCF, a machine."""
    from drivesizer.spec.from_urdf import has_wheels, spec_of
    from drivesizer.spec.several_axes.from_description import joints_to_drive, machine_of

    if joint is not None or has_wheels(path) or (path.suffix == ".urdf" and joints_to_drive(path) < 2):
        return spec_of(path, joint)
    answered = interactive() and str(output) != "-"
    masses = ("with_drives" if typer.confirm(_HOLD_DRIVES, default=True) else "without") if answered else ""
    return machine_of(path, Path() if str(output) == "-" else output.parent, masses)


def start_by_questions(output: Path) -> None:
    """Write the spec that the answers at a terminal give.

    Parameters
    ----------
    output
        The file, which must not exist yet.

    Raises
    ------
    InputError
        When it exists.
    """
    if os.path.lexists(output):  # before the first question
        raise InputError(f"{output}: the file exists and is left alone; name another with -o")
    _start(questionnaire(), output)


def _start(text: str, output: Path) -> None:
    """Write a spec where no file is yet, or print it."""
    if str(output) == "-":
        typer.echo(text, nl=False)
        return
    from drivesizer.files.writing import new

    new(output, _naming(text, output.name).encode())
    _written([output])


def _naming(text: str, name: str) -> str:
    """A spec whose comment on the next command names its own file; a name that no comment can hold is left out.

    >>> _naming("# Then: drivesizer size robot.yaml", "hoist.yaml")
    '# Then: drivesizer size hoist.yaml'
    """
    return text.replace(_NEXT.format("robot.yaml"), _NEXT.format(name), 1) if name.isprintable() else text


_HOLD_DRIVES = "Do the masses of its links hold the drives already (most robots on sale do)"
_NEXT = "# Then: drivesizer size {}"


def _written(paths: list[Path]) -> None:
    """Name the files that were written, and the next command."""
    spec = paths[0]
    behind = "" if spec == DEFAULT else f" {spec}"
    typer.echo(f"{', '.join(map(str, paths))} written; now: drivesizer size{behind}")


def schema(
    of: Annotated[
        str,
        typer.Argument(
            metavar="WHAT", help="spec, machine, study, catalog, report, machine-report, prediction or export."
        ),
    ] = "spec",
) -> None:
    """Print the JSON Schema of robot.yaml, a machine, a study or a catalogue, or of a JSON document, for programs."""
    import json

    from drivesizer.catalog.schema import catalog_schema
    from drivesizer.output.export.json_document import export_schema
    from drivesizer.output.json.prediction import prediction_schema
    from drivesizer.output.json.schema import machine_report_schema, report_schema
    from drivesizer.spec.robot import RobotSpec
    from drivesizer.spec.several_axes.machine_schema import machine_schema
    from drivesizer.study.schema import StudyFile

    made = {"spec": RobotSpec.model_json_schema, "catalog": catalog_schema, "report": report_schema}
    made |= {"study": StudyFile.model_json_schema, "prediction": prediction_schema, "export": export_schema}
    made |= {"machine": machine_schema, "machine-report": machine_report_schema}
    if of not in made:
        raise InputError(f"there is no schema of {quoted(of)}; expected {' or '.join(made)}")
    typer.echo(json.dumps(made[of](), indent=2, ensure_ascii=False))


def doctor(json: Json = False) -> None:
    """Check this installation: libraries, cache, catalogues, fonts, terminal."""
    from drivesizer.commands.doctor import examined, print_findings

    found = examined()
    if json:
        from drivesizer.output.json import documents as json_documents

        typer.echo(
            json_documents.as_text(
                {"schema_version": json_documents.SCHEMA_VERSION, "findings": [f._asdict() for f in found]}
            )
        )
    else:
        print_findings(found)
    raise typer.Exit(0 if all(f.works for f in found) else 1)
