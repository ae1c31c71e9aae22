"""``drivesizer export``."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from drivesizer.commands.common import DEFAULT, Chosen, More, OfAxis, Spec, load, print_notes, working
from drivesizer.commands.validate import pick

__all__ = ["export"]


def export(
    output: Annotated[Path, typer.Option("--output", "-o", help="The file to write.")],
    form: Annotated[str, typer.Option("--format", metavar="NAME", help="mjcf, urdf, sdf, ros2_control, fmu or json.")],
    spec: Spec = DEFAULT,
    chosen: Chosen = None,
    axis: OfAxis = None,
    catalogs: More = None,
) -> None:
    """Write a drive for a simulator: MuJoCo, URDF, Gazebo, ros2_control, an FMU, or plain JSON."""
    from drivesizer.output.export import accept, export_of, write

    robot = load(spec, catalogs, axis)
    accept(form, output)
    found = pick(robot, chosen)
    with working("designing the controller"):
        record = export_of(robot, found)
        written = write(record, form, output)
    print_notes(record.said)
    for path in written:
        typer.echo(path)
