"""``drivesizer drive``."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer

from drivesizer.commands.common import DEFAULT, Chosen, Json, More, Spec, load, print_notes, progress, working
from drivesizer.commands.options import file_argument, file_option, whole_option
from drivesizer.errors import InputError

__all__ = ["drive"]


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
    from drivesizer.load_cases.platform_drive import driving, with_trajectory
    from drivesizer.machine.permitted_speed import permitted_speeds
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
        from drivesizer.output.json import documents as json_documents
        from drivesizer.output.json import driving as json_driving

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
    from drivesizer.commands.validate import pick
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
    from drivesizer.catalog.view.own_brake import OWN

    parts = {role: getattr(best, role) for role in ("encoder", "controller", "brake")}
    pinned = {
        role: getattr(on_path.select, role).model_copy(update={"family": None, "part": [part.part]})
        for role, part in parts.items()
        if part is not None and part.family != OWN and not getattr(part, "inside", "")
    }
    return on_path.alone(select=on_path.select.model_copy(update=pinned))
