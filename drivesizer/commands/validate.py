"""``drivesizer validate`` and ``drivesizer drive``."""

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
    file_argument,
    file_option,
    load,
    load_whole,
    print_notes,
    progress,
    simulating,
    whole_option,
    working,
)
from drivesizer.errors import InputError, quoted

__all__ = ["pick"]


# -- ``drivesizer validate``.


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


# -- ``drivesizer drive``.


def drive(
    spec: Spec = DEFAULT,
    trajectory: Annotated[
        Path | None, file_argument(metavar="TRAJECTORY.CSV", help="t, x, y, heading; or waypoints; else the spec's.")
    ] = None,
    chosen: Chosen = None,
    json: Json = False,
    follow: Annotated[
        bool, typer.Option("--follow", help="Also simulate path following: both robot models, slip, poses fed back.")
    ] = False,
    failed: Annotated[
        list[int] | None,
        whole_option("--failed", 2, metavar="WHEEL", meaning="A wheel whose motor has failed; may be repeated."),
    ] = None,
    csv: Annotated[Path | None, file_option(help="Also write posture, speeds and torques over time.")] = None,
    drawings: Annotated[
        Path | None, file_option("--figures", metavar="FOLDER", help="Also draw path and errors (--follow): SVG, PNG.")
    ] = None,
    catalogs: More = None,
) -> None:
    """Drive a platform along a trajectory: requirements at each wheel, checks of a drive, speeds that it permits."""
    from drivesizer.load_cases.platform import driving, with_trajectory
    from drivesizer.machine.platform_budget import permitted_speeds
    from drivesizer.output.report import accept

    if drawings and not follow:
        raise InputError("--figures: it draws what --follow simulates; expected both, or none")
    robot = load(spec, catalogs)
    accept([], tables=[csv] if csv else [])
    on_path = with_trajectory(robot, trajectory, failed or ())
    found = driving(on_path)
    one = _drive_on_path(robot, on_path, chosen)
    if csv:
        from drivesizer.output.report import write_driving

        write_driving(found, csv)
    runs = _followed(found, one, drawings) if follow else {}
    speeds = permitted_speeds(on_path, one) if one else None
    if json:
        from drivesizer.output.json import behaviour as json_driving
        from drivesizer.output.json import documents as json_documents

        typer.echo(json_documents.as_text(json_driving.driving(found, one, runs, speeds)))
    else:
        from drivesizer.output.terminal import driving as terminal_driving

        terminal_driving.driven(found, one, runs, speeds)
        if not one:
            print_notes(("no drive meets all limits for the spec's own motion; see `drivesizer size`",))
    raise typer.Exit(0 if one and one.status != "fail" else 1)


def _followed(found: Any, one: Any, drawings: Path | None) -> Any:
    """Simulate the runs along the path, and draw them where a folder is given."""
    from drivesizer.control.path_following.runs import drawn, follow_runs

    with working("simulating the platform on its path"):
        runs = follow_runs(found, one)
    if drawings:
        from drivesizer.output.report import write_path

        for path in write_path(drawn(runs), drawings):
            typer.echo(f"{path} written", err=True)
    return runs


def _drive_on_path(robot: Any, on_path: Any, chosen: str | None) -> Any:
    """The drive with its checks on the path: named by its parts, or the best for the spec's own motion; or None."""
    from drivesizer.sizing import explain, size

    if chosen:
        return pick(on_path, chosen)
    with progress() as advance:
        best = size(robot, top=1, progress=advance).sets
    if not best or (robot.motion == on_path.motion and robot.platform == on_path.platform):
        return best[0] if best else None
    motor, gearhead = (best[0].actuator or best[0].motor).part, best[0].gearhead.part
    return next(
        s for s in explain(_with_parts_of(best[0], on_path), motor, gearhead) if s.belt_ratio == best[0].belt_ratio
    )


def _with_parts_of(best: Any, on_path: Any) -> Any:
    """The spec of the path, with encoder, controller and brake of a drive as the only ones to choose from."""
    from drivesizer.catalog.view.mounted import OWN

    parts = {role: getattr(best, role) for role in ("encoder", "controller", "brake")}
    pinned = {
        role: getattr(on_path.select, role).model_copy(update={"family": None, "part": [part.part]})
        for role, part in parts.items()
        if part is not None and part.family != OWN and not getattr(part, "inside", "")
    }
    return on_path.alone(select=on_path.select.model_copy(update=pinned))
