"""``drivesizer drive``."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer

from drivesizer.commands.common import DEFAULT, Chosen, Json, More, Spec, load, progress, tell, working
from drivesizer.errors import InputError

__all__ = ["drive"]


def drive(
    spec: Spec = DEFAULT,
    trajectory: Annotated[
        Path | None, typer.Argument(metavar="TRAJECTORY.CSV", help="t, x, y, heading; or waypoints; else the spec's.")
    ] = None,
    chosen: Chosen = None,
    json: Json = False,
    follow: Annotated[
        bool, typer.Option("--follow", help="Also simulate how it follows: both robot models, slip, poses fed back.")
    ] = False,
    failed: Annotated[
        list[int] | None, typer.Option(metavar="WHEEL", help="A wheel whose motor has failed; may be repeated.")
    ] = None,
    csv: Annotated[Path | None, typer.Option(help="Also write posture, speeds and torques over time.")] = None,
    drawings: Annotated[
        Path | None, typer.Option("--figures", metavar="FOLDER", help="Also draw path and errors (--follow): SVG, PNG.")
    ] = None,
    catalogs: More = None,
) -> None:
    """Drive a platform along a trajectory: what each wheel is asked for, and whether a set does it."""
    from drivesizer.loads.platform_drive import driving, on_the_way
    from drivesizer.output.report import accept

    if drawings and not follow:
        raise InputError("--figures: it draws what --follow simulates; expected both, or none")
    robot = load(spec, catalogs)
    accept([], tables=[csv] if csv else [])
    way = on_the_way(robot, trajectory, failed or ())
    found = driving(way)
    one = _on_the_way(robot, way, chosen)
    if csv:
        from drivesizer.output.report import write_driving

        write_driving(found, csv)
    runs = _followed(found, one, drawings) if follow else {}
    if json:
        from drivesizer.output.json import documents as json_documents
        from drivesizer.output.json import driving as json_driving

        typer.echo(json_documents.as_text(json_driving.driving(found, one, runs)))
    else:
        from drivesizer.output.terminal import driving as terminal_driving

        terminal_driving.driven(found, one, runs)
        tell(() if one else ("no set stands for the spec's own motion; `drivesizer size` shows the nearest misses",))
    raise typer.Exit(0 if one and one.status != "fail" else 1)


def _followed(found: Any, one: Any, drawings: Path | None) -> Any:
    """The runs along the way, drawn where that is asked for."""
    from drivesizer.control.path_following.runs import drawn, follow_all

    with working("driving the platform along its way"):
        runs = follow_all(found, one)
    if drawings:
        from drivesizer.output.report import write_path

        for path in write_path(drawn(runs), drawings):
            typer.echo(f"{path} written", err=True)
    return runs


def _on_the_way(robot: Any, way: Any, chosen: str | None) -> Any:
    """A set with its checks on the way: named by its parts, or the best for the spec's own motion; None without."""
    from drivesizer.commands.validate import pick
    from drivesizer.sizing import explain, size

    if chosen:
        return pick(way, chosen)
    with progress() as told:
        best = size(robot, top=1, progress=told).sets
    if not best or (robot.motion == way.motion and robot.platform == way.platform):
        return best[0] if best else None
    motor, gearhead = (best[0].actuator or best[0].motor).part, best[0].gearhead.part
    return next(s for s in explain(_with_its(best[0], way), motor, gearhead) if s.belt_ratio == best[0].belt_ratio)


def _with_its(best: Any, way: Any) -> Any:
    """The way's spec with the encoder and the controller of a set and no other to choose from."""
    parts = {role: getattr(best, role) for role in ("encoder", "controller")}
    pinned = {
        role: getattr(way.select, role).model_copy(update={"family": None, "part": [part.part]})
        for role, part in parts.items()
        if part is not None and not part.inside
    }
    return way.alone(select=way.select.model_copy(update=pinned))
