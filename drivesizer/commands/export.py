"""``drivesizer export``."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer

from drivesizer.commands.common import (
    DEFAULT,
    Chosen,
    More,
    NothingFitsError,
    OfAxis,
    Spec,
    file_option,
    load_whole,
    print_notes,
    whole_option,
    working,
)  # fmt: skip
from drivesizer.commands.machine import refuse_axis_options, sized_machine
from drivesizer.commands.validate import pick

__all__ = ["export"]


def export(
    output: Annotated[Path, file_option("--output", "-o", help="The file to write.")],
    form: Annotated[str, typer.Option("--format", metavar="NAME", help="mjcf, urdf, sdf, ros2_control, fmu or json.")],
    spec: Spec = DEFAULT,
    chosen: Chosen = None,
    axis: OfAxis = None,
    wheel: Annotated[
        int | None,
        whole_option(
            "--wheel", 1, metavar="N", meaning="Of a platform: the drive of one wheel; else the base with all."
        ),
    ] = None,
    catalogs: More = None,
) -> None:
    """Write a drive for a simulator: MuJoCo, URDF, Gazebo, ros2_control, an FMU, or plain JSON.

    As mjcf, urdf or ros2_control a whole machine in one file: of a platform the base with all its wheels; of several
    axes a robot's description with its drives, every other axis as a joint of its own whose names begin with the axis.
    """
    from drivesizer.output.export import accept, check_wheel
    from drivesizer.output.export.platform import write_drive

    robot = load_whole(spec, catalogs, axis)
    if hasattr(robot, "axes"):
        _machine(robot, output, form, {"--set": chosen, "--wheel": wheel})
        return
    accept(form, output)
    if wheel is not None:
        check_wheel(robot, wheel)  # before time is spent
    found = pick(robot, chosen)
    with working("designing the controller"):
        said, written = write_drive(robot, found, form, output, wheel)
    _printed(said, written)


def _machine(machine: Any, output: Path, form: str, given: dict[str, object]) -> None:
    """Write all axes of a machine."""
    from drivesizer.output.export.machine import accept_machine, machine_export, write_machine

    refuse_axis_options(given)
    accept_machine(form, output)
    result = sized_machine(machine, 1, None)
    without = next((one.name for one in result.axes if one.best is None), None)
    if without is not None:
        raise NothingFitsError(f"{without}: no drive meets all limits; `drivesizer size` shows the closest rejected")
    with working("designing the controllers"):
        record = machine_export(result, one_rate=form == "ros2_control")
        written = write_machine(record, form, output)
    _printed((*record.said, *record.notes), written)


def _printed(notes: tuple[str, ...], written: list[Path]) -> None:
    print_notes(notes)
    for path in written:
        typer.echo(path)
