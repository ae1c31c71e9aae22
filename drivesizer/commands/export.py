"""``drivesizer export``."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from drivesizer.commands import common
from drivesizer.commands.common import DEFAULT, Chosen, More, OfAxis, Spec, file_option
from drivesizer.errors import InputError


def export(
    output: Annotated[Path, file_option("--output", "-o", help="The file to write.")],
    form: Annotated[str, typer.Option("--format", metavar="NAME", help="mjcf, urdf, sdf, ros2_control, fmu or json.")],
    spec: Spec = DEFAULT,
    chosen: Chosen = None,
    axis: OfAxis = None,
    wheel: Annotated[
        int | None,
        common.whole_option(
            "--wheel", 1, metavar="N", meaning="Of a platform: the drive of one wheel; else the base with all."
        ),
    ] = None,
    catalogs: More = None,
) -> None:
    """Write a drive for a simulator: MuJoCo, URDF, Gazebo, ros2_control, an FMU, or plain JSON.

    A machine of several axes is one file, each axis a joint of its own whose names begin with the axis, but an FMU is
    one of an axis. mjcf, urdf and ros2_control have bodies: the base of a platform with all its wheels, and the links
    of a robot's description with its drives.
    """
    from drivesizer.output import export as exports

    robot, drives = common.load_chosen(spec, chosen, catalogs, axis)
    exports.accept(form, output)
    bodies, several = exports.FORMATS[form].bodies, robot.is_several
    if wheel is not None and several:
        raise InputError("--wheel: it is of a single axis; expected --axis beside it")
    if wheel is not None:
        exports.check_wheel(robot.axes[0].spec, wheel)  # before time is spent
    ((_, one, found), *_), result = common.with_drives(robot, drives)
    with common.working("designing the controller"):
        if several and result:
            of = exports.machine_export(result, one_rate=form == "ros2_control", bodies=bodies)
        else:
            of = exports.drive_export(one, found, wheel=wheel, bodies=bodies)
        written = exports.write(of, form, output)
    common.print_notes((*of.notes, *of.assumptions))
    for path in written:
        typer.echo(path)
