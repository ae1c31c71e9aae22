"""``drivesizer commission``: the chosen drive's loops, limits and feed-forward in its controller's own units."""

from __future__ import annotations

from dataclasses import replace
from math import degrees
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from drivesizer.commands import common
from drivesizer.commands.common import DEFAULT, Chosen, More, OfAxis, Spec, file_option
from drivesizer.errors import InputError

if TYPE_CHECKING:
    from drivesizer.control.devices import Device, Written
    from drivesizer.control.validation import Validation


def commission(
    spec: Spec = DEFAULT,
    device: Annotated[
        str | None, typer.Option(metavar="NAME", help="The controller; else by the one that was chosen.")
    ] = None,
    output: Annotated[Path | None, file_option("--output", "-o", help="The file to write.")] = None,
    unconfirmed: Annotated[
        bool, typer.Option("--unconfirmed", help="Also write what is known from memory alone.")
    ] = False,
    chosen: Chosen = None,
    axis: OfAxis = None,
    catalogs: More = None,
) -> None:
    """Write the drive's gains and limits as its controller takes them, and what they stand for after rounding."""
    from drivesizer.control import devices
    from drivesizer.files.writing import write_files
    from drivesizer.output.export import device_file
    from drivesizer.output.terminal.tables import bare, console
    from drivesizer.simulate import validate

    fields, drives = common.fields_and_drives(chosen)
    robot = common.load(spec, catalogs, axis, fields)
    axes = common.with_drives(robot, drives)[0]
    if len(axes) > 1:
        raise InputError(
            f"--axis: expected one of {', '.join(name for name, _, _ in axes)}; a file is that of one drive"
        )
    _, own, found = axes[0]
    controller = found.controller
    one = devices.device_of(device, f"{controller.family} {controller.part}" if controller else "")
    if output:
        device_file.accept(one, output)
    if controller:
        current, velocity, position = one.rates
        at_rates = replace(controller, current_loop=current, speed_loop=velocity, position_loop=position)
        found = replace(found, controller=at_rates)
    with common.simulating("simulating the loop"):
        proof = validate(own.model_copy(update={"control": devices.loops_of(one, own.control)}), found)
        rows, left_out = devices.written(one, devices.figures(proof, one))
        recalled = [row for row in rows if row.parameter.confidence == "recalled" and not unconfirmed]
        rows = [row for row in rows if row not in recalled]
        if recalled:
            names = (f"{row.parameter.name} = {row.text} {row.parameter.unit}".strip() for row in recalled)
            left_out.append(f"{', '.join(names)}: known from memory alone (--unconfirmed)")
        again = validate(own.model_copy(update={"control": devices.as_written(one, rows, proof)}), found)
    remarks = _remarks(one, rows, left_out, proof, again)
    if output:
        for path in write_files(device_file.files(one, rows, remarks, output)):
            typer.echo(f"{path} written", err=True)
    out = console()
    said = out.width - max((len(row.parameter.name) for row in rows), default=0) > 60  # room for what it means
    table = bare(("parameter", "left"), ("value", "right"), ("unit", "left"), *((("", "left"),) if said else ()))
    table.columns[0].no_wrap = True
    for row in rows:
        meaning = (row.parameter.meaning,) if said else ()
        table.add_row(row.parameter.name, row.text, row.parameter.unit, *meaning)
    out.print(f"{one.title}: {found.label}", markup=False)
    out.print(table)
    for line in _loops(proof, again):
        out.print(line, markup=False)
    for line in left_out:
        out.print(f"not written: {line}", markup=False)
    for word in ("first", "load", "note"):
        if one.words[word]:
            out.print(f"{word}: {one.words[word]}", markup=False)
    raise typer.Exit(int(again.status == "fail"))


def _loops(proof: Validation, again: Validation) -> list[str]:
    """The loops as they are written: verdict over the motion, phase margins and what rounding took of them."""
    lines = [f"with these gains: {again.status} over {again.over}" + (f" ({again.failed})" if again.failed else "")]
    for exact, written in zip(proof.loops, again.loops, strict=True):
        lost = max(0.0, degrees(exact.phase_margin - written.phase_margin))
        lines.append(f"{written.name} loop: phase margin {degrees(written.phase_margin):.1f}°, {lost:.2f}° lost by "
                     f"rounding; bandwidth {written.bandwidth:.3g} Hz")  # fmt: skip
    return lines


def _remarks(
    device: Device, rows: list[Written], left_out: list[str], proof: Validation, again: Validation
) -> list[str]:
    """Lines in the file beside its parameters."""
    return [
        f"{device.title}, by drivesizer: {proof.drive_set.label}", f"source of units: {device.words['source']}",
        f"first: {device.words['first']}", f"load: {device.words['load']}",
        *([device.words["note"]] if device.words["note"] else []), "",
        *(f"{row.parameter.name} = {row.text} {row.parameter.unit}: {row.parameter.meaning}; exactly {row.exact:.8g}; "
          f"{row.parameter.confidence}" for row in rows), "",
        *_loops(proof, again), *(f"not written: {one}" for one in left_out),
    ]  # fmt: skip
