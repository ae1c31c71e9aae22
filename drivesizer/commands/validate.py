"""``drivesizer validate``."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer

from drivesizer.commands.common import (
    DEFAULT,
    Chosen,
    Json,
    More,
    NothingFitsError,
    OfAxis,
    Profile,
    Spec,
    load_whole,
    print_notes,
    progress,
    simulating,
)
from drivesizer.commands.options import file_option, whole_option
from drivesizer.errors import InputError, quoted

__all__ = ["pick", "validate"]


def validate(
    spec: Spec = DEFAULT,
    profile: Profile = None,
    chosen: Chosen = None,
    json: Json = False,
    csv: Annotated[Path | None, file_option(help="Also write the time series to this CSV file.")] = None,
    drawings: Annotated[
        Path | None, file_option("--figures", metavar="FOLDER", help="Also draw the loop, Bode and step: SVG and PNG.")
    ] = None,
    case: Annotated[
        str | None, typer.Option(metavar="NAME", help="The load case to simulate; else the hardest.")
    ] = None,
    everything: Annotated[bool, typer.Option("--all", help="The best drives of the search, ranked anew.")] = False,
    top: Annotated[int, whole_option("--top", 5, 1, 100, meaning="How many, with --all; at most 100.")] = 5,
    axis: OfAxis = None,
    catalogs: More = None,
) -> None:
    """Simulate a drive over the profile in closed loop: every demand against its limit."""
    from drivesizer.output.report import accept
    from drivesizer.simulate import hardest_case, with_remedies
    from drivesizer.simulate import validate as validated
    from drivesizer.sizing import size as sized

    robot = load_whole(spec, catalogs, axis)
    accept([], tables=[csv] if csv else [])
    if hasattr(robot, "axes"):
        from drivesizer.commands.machine import validate_axes

        given = {"--set": chosen, "--csv": csv, "--figures": drawings, "--case": case, "--all": everything}
        raise typer.Exit(validate_axes(robot, given, profile, json))
    _known_case(robot, case)
    if everything:
        if chosen or csv or drawings:
            raise InputError("--all: it takes the drives of the search; --set, --csv and --figures are for one of them")
        raise typer.Exit(_all_of(robot, case, profile, top, json))
    found = pick(robot, chosen)
    with simulating("simulating the drive in closed loop"):
        proof = validated(robot, found, profile=profile, load_case=case or hardest_case(robot, found))
        if proof.status == "fail":
            proof = with_remedies(proof, robot, sized(robot, top=3).sets, profile=profile)
    if drawings:
        from drivesizer.output.report import write_loop_figures

        for path in write_loop_figures(proof, drawings):
            typer.echo(f"{path} written", err=True)
    if csv:
        from drivesizer.output.report import write_series

        write_series(proof, csv)
    if json:
        from drivesizer.output.json import documents as json_documents

        typer.echo(json_documents.as_text(json_documents.validation(proof)))
    else:
        from drivesizer.output.terminal import sizing as terminal

        terminal.validation(proof)
        print_notes(proof.warnings)
    raise typer.Exit(1 if proof.status == "fail" else 0)


def _known_case(robot: Any, name: str | None) -> None:
    """Refuse a name that none of the spec's load cases has."""
    from drivesizer.load_cases.of_machine import load_cases

    found = [case for _, case, _ in load_cases(robot)]
    if name is not None and name not in found:
        raise InputError(f"--case: {quoted(name)} is not known; expected {', '.join(filter(None, found)) or 'none'}")


def _all_of(robot: Any, case: str | None, profile: str | None, top: int, json: bool) -> int:
    """The best drives of the search in closed loop, those that pass first; the exit status."""
    from drivesizer.simulate import validate_all
    from drivesizer.sizing import size as sized

    with progress() as advance:
        result = sized(robot, top=top, progress=advance)
    if not result.sets:
        raise NothingFitsError("no drive meets all limits; `drivesizer size` shows the closest rejected")
    with simulating("simulating the drives in closed loop"):
        proofs, notes = validate_all(result, profile=profile, load_case=case)
    if json:
        from drivesizer.output.json import documents as json_documents

        documents = [json_documents.validation(proof) for proof in proofs]
        typer.echo(json_documents.as_text({"schema_version": json_documents.SCHEMA_VERSION, "validations": documents}))
    else:
        from drivesizer.output.terminal import sizing as terminal

        terminal.validations(proofs, result.objective)
    print_notes(tuple(notes))
    return 1 if all(proof.status == "fail" for proof in proofs) else 0


def pick(robot: Any, chosen: str | None) -> Any:
    """The drive that an option names by its parts, or the best of the search.

    Parameters
    ----------
    robot
        The spec.
    chosen
        MOTOR/GEARHEAD or ACTUATOR; None for the best.

    Returns
    -------
    DriveSet
        The drive.

    Raises
    ------
    NothingFitsError
        When no drive meets all limits.
    InputError
        When the option names no parts.
    """
    from drivesizer.results.check import GRAVEST
    from drivesizer.sizing import explain as explained
    from drivesizer.sizing import size as sized

    if chosen is None:
        with progress() as advance:
            result = sized(robot, top=1, progress=advance)
        if not result.sets:
            raise NothingFitsError(
                "no drive meets all limits; `drivesizer size` shows the closest rejected, --set names one to validate"
            )
        return result.sets[0]
    parts = [part.strip() for part in chosen.split("/")]
    if len(parts) > 2 or not all(parts):
        raise InputError(f"--set: {quoted(chosen)} is not MOTOR/GEARHEAD or ACTUATOR; expected e.g. 118752/406764")
    sets = explained(robot, *parts)
    return min(sets, key=lambda s: (GRAVEST[::-1].index(s.status), s.rank))
