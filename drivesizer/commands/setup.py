"""``drivesizer init``, ``schema``, ``equations`` and ``doctor``."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from drivesizer.commands.common import DEFAULT, Json
from drivesizer.errors import InputError, quoted

__all__ = ["doctor", "equations", "init", "schema"]


_STARTERS = Path(__file__).parents[1] / "spec" / "starters"
_KINDS = sorted(path.stem for path in _STARTERS.glob("*.yaml"))


def equations(
    number: Annotated[str | None, typer.Argument(help="The paper's number, or a requirement's name.")] = None,
) -> None:
    """List the paper's equations, or show one: as printed, as computed, why they differ, units, source."""
    from drivesizer.output import formula
    from drivesizer.output.terminal import equations as terminal_equations
    from drivesizer.platform import printed_forms
    from drivesizer.platform.matrix_equation import PLATFORM

    if number is None:
        terminal_equations.equations()
        return
    sizing, platform = formula.find(number), printed_forms.find(number)
    if sizing is not None:
        terminal_equations.equation(sizing)
    elif platform is not None:
        terminal_equations.platform_equation(platform)
    else:
        raise InputError(f"there is no equation {quoted(number)}; expected 1 to {max(PLATFORM)}")


def init(
    kind: Annotated[str, typer.Option(help=f"Kind of load: {', '.join(_KINDS)}.")] = "wheeled_vehicle",
    output: Annotated[Path, typer.Option("--output", "-o", help="The file to write; - prints it.")] = DEFAULT,
    urdf: Annotated[
        Path | None, typer.Option("--from-urdf", metavar="FILE", help="Masses, wheels and limits of a URDF.")
    ] = None,
    joint: Annotated[str | None, typer.Option(metavar="NAME", help="With --from-urdf: the joint of an arm.")] = None,
) -> None:
    """Write a commented robot.yaml to start from."""
    if joint is not None and urdf is None:
        raise InputError("--joint: it names a joint of --from-urdf; expected both")
    if urdf is not None:
        from drivesizer.spec.from_urdf import spec_of

        _start(spec_of(urdf, joint), output)
        return
    _start(_starter(kind), output)


def _starter(kind: str) -> str:
    """The text that ships for a kind of load."""
    if kind not in _KINDS:
        raise InputError(f"--kind: {quoted(kind)} is not known; expected {', '.join(_KINDS)}")
    return (_STARTERS / f"{kind}.yaml").read_text(encoding="utf-8")


def _start(text: str, output: Path) -> None:
    """Write a spec where no file is yet, or print it."""
    if str(output) == "-":
        typer.echo(text, nl=False)
        return
    from drivesizer.files.writing import new

    new(output, text.encode())
    typer.echo(f"{output} written; now: drivesizer size{'' if output == DEFAULT else f' {output}'}")


def schema(
    of: Annotated[
        str, typer.Argument(metavar="WHAT", help="spec, study, catalog, report, prediction or export.")
    ] = "spec",
) -> None:
    """Print the JSON Schema of robot.yaml, a study or a catalogue, for editors, or of a JSON document, for programs."""
    import json

    from drivesizer.catalog.schema import catalog_schema
    from drivesizer.output.export.json_document import export_schema
    from drivesizer.output.json.prediction import prediction_schema
    from drivesizer.output.json.schema import report_schema
    from drivesizer.spec.robot import RobotSpec
    from drivesizer.study.schema import StudyFile

    made = {"spec": RobotSpec.model_json_schema, "catalog": catalog_schema, "report": report_schema}
    made |= {"study": StudyFile.model_json_schema, "prediction": prediction_schema, "export": export_schema}
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
