"""``drivesizer commission``: the chosen drive's loops, limits and feed-forward in its controller's own units."""

from __future__ import annotations

from math import degrees, isnan
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from drivesizer.commands import common
from drivesizer.commands.common import DEFAULT, Chosen, More, OfAxis, Spec, file_option
from drivesizer.errors import InputError, quoted

if TYPE_CHECKING:
    from drivesizer.control.devices import Device
    from drivesizer.results.drive_set import DriveSet
    from drivesizer.simulate import Commissioned
    from drivesizer.spec.robot import RobotSpec

OfDevice = Annotated[
    str | None, typer.Option("--device", metavar="NAME", help="The controller, e.g. odrive-0.5, vesc.")
]
OfFirmware = Annotated[str | None, typer.Option("--firmware", metavar="V", help="Its firmware, where that decides.")]
Settings = Annotated[
    list[str] | None,
    typer.Option("--setting", metavar="NAME=VALUE", help="A figure of your board in SI, e.g. R_s=0.11; repeatable."),
]
_LONG = 20  # characters of a beginning that all parameters share, from which on it stands once
Unconfirmed = Annotated[bool, typer.Option("--unconfirmed", help="Also write what is known from memory alone.")]


def commission(
    spec: Spec = DEFAULT,
    device: OfDevice = None,
    firmware: OfFirmware = None,
    output: Annotated[Path | None, file_option("--output", "-o", help="The file to write.")] = None,
    unconfirmed: Unconfirmed = False,
    settings: Settings = None,
    chosen: Chosen = None,
    axis: OfAxis = None,
    catalogs: More = None,
) -> None:
    """Write the drive's gains and limits as its controller takes them, and what they stand for after rounding."""
    from drivesizer.files.writing import write_files
    from drivesizer.output.export import device_file
    from drivesizer.output.terminal.tables import bare, console
    from drivesizer.simulate import commissioned, hardest_case

    own, found = common.one_drive(spec, chosen, catalogs, axis, "a file is that of one drive")
    one, board = device_for(found, device, firmware), settings_of(found, device, firmware, settings)
    if axis:  # where the controller's form has the name of a joint
        named = (row._replace(name=row.name.replace("JOINT", axis)) for row in one.parameters)
        one = one._replace(parameters=tuple(named))
    if output:
        device_file.accept(one, output)
    with common.simulating("simulating the loop"):
        case = hardest_case(own, found)
        made = commissioned(own, found, one, settings=board, unconfirmed=unconfirmed, load_case=case)
    rows, proof = made.rows, made.rounded
    if output:
        common.print_written(write_files(device_file.files(one, rows, _remarks(one, made, board), output)))
    out = console()
    shared = rows[0].parameter.name.rpartition(".")[0] + "."
    if len(shared) < _LONG or not all(row.parameter.name.startswith(shared) for row in rows):
        shared = ""
    room = out.width - max(
        len(row.parameter.name) - len(shared) for row in rows
    )  # for what they stand for, and what they mean
    heads = (("in SI", "left"),) * (room > 60) + (("", "left"),) * (room > 100)
    table = bare(("parameter", "left"), ("value", "right"), ("unit", "left"), *heads)
    table.columns[0].no_wrap = True
    for row in rows:
        more = (row.in_si, row.parameter.meaning)[: len(heads)]
        table.add_row(row.parameter.name.removeprefix(shared), row.text, row.unit, *more)
    out.print(f"{one.title}: {found.label}", markup=False)
    if shared:
        out.print(f"below {shared.removesuffix('.')}:", markup=False)
    out.print(table)
    said = [*loops(made), *_warned(one, made, board), *(f"{word}: {one.words[word]}" for word in ("first", "load"))]
    for line in said:
        out.print(line, markup=False)
    raise typer.Exit(int(proof.status == "fail"))


def device_for(drive: DriveSet, name: str | None, firmware: str | None) -> Device:
    """The controller of the table that is named, or that of the drive."""
    from drivesizer.control.devices import device_of

    part = drive.actuator or drive.controller
    return device_of(name, f"{part.family} {part.part}" if part else "", firmware)


def settings_of(drive: DriveSet, name: str | None, firmware: str | None, words: list[str] | None) -> dict[str, float]:
    """Figures of the user's board, of those that the controller has."""
    device, found = device_for(drive, name, firmware), {}
    for word in words or ():
        figure, _, text = word.partition("=")
        try:
            found[figure] = float(text)
        except ValueError:
            text = ""
        if figure not in device.settings or not text or not 0.0 < found[figure] < 1e9:
            known = ", ".join(f"{name} ({what})" for name, (_, what) in device.settings.items()) or "none"
            raise InputError(f"--setting: {quoted(word)} is no setting of {device.title}; expected NAME=VALUE in SI, "
                             f"of {known}")  # fmt: skip
    return found


def proofs(
    axes: list[tuple[str, RobotSpec, DriveSet]], device: str | None, firmware: str | None, profile: str | None,
    case: str | None,
) -> dict[str, Commissioned]:  # fmt: skip
    """The drive of every axis behind a controller of the table, as ``validate --device`` simulates it."""
    from drivesizer.simulate import commissioned, hardest_case

    found = {}
    for name, spec, drive in axes:
        with common.simulating(f"simulating {name or 'the drive'} behind its controller"):
            made = commissioned(
                spec, drive, device_for(drive, device, firmware), unconfirmed=True, profile=profile,
                load_case=case or hardest_case(spec, drive),
            )  # fmt: skip
        found[name] = made
    return found


def loops(made: Commissioned) -> list[str]:
    """The loops as they are written: verdict over the motion, phase margins and what rounding took of them."""
    proof = made.rounded
    lines = [f"with these figures: {proof.status} over {proof.over}" + (f" ({proof.failed})" if proof.failed else "")]
    for exact, written in zip(made.exact.loops, proof.loops, strict=True):
        lost = max(0.0, degrees(exact.phase_margin - written.phase_margin))
        name = written.name if getattr(proof.gains, "kp", 1.0) else "position"  # which acts on the voltage by itself
        lines.append(f"{name} loop: phase margin {degrees(written.phase_margin):.1f}°, {lost:.2f}° lost by "
                     f"rounding; bandwidth {written.bandwidth:.3g} Hz")  # fmt: skip
    return lines


def _warned(device: Device, made: Commissioned, board: dict[str, float]) -> list[str]:
    """Notes on what is not written, what a setting decides, and what is to be known of the controller."""
    lines = [f"not written: {line}" for line in made.left_out]
    for name, (usual, what) in device.settings.items():
        value = board.get(name, usual)
        lines.append(f"setting: {name} = {'unknown' if isnan(value) else f'{value:g}'} {what} (--setting)")
    return lines + ([f"note: {device.words['note']}"] if device.words["note"] else [])


def _remarks(device: Device, made: Commissioned, board: dict[str, float]) -> list[str]:
    """Lines in the file beside its parameters: the table read back."""
    return [
        f"{device.title}, by drivesizer: {made.exact.drive_set.label}", f"source of units: {device.words['source']}",
        f"first: {device.words['first']}", f"load: {device.words['load']}", "",
        *(f"{f'{row.parameter.name} = {row.text} {row.unit}'.rstrip()}: {row.parameter.meaning}; "
          + f"{row.in_si}; " * bool(row.in_si) + f"exactly {row.exact:.8g}; {row.parameter.confidence}"
          for row in made.rows), "",
        *loops(made), *_warned(device, made, board),
    ]  # fmt: skip
