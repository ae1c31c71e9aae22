"""Closed loops: ``drivesizer validate``, ``drive``, and ``commission`` in the units of the drive's controller."""

from __future__ import annotations

from math import degrees, isnan
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from drivesizer.commands import common
from drivesizer.errors import InputError, NoLoopError, quoted

if TYPE_CHECKING:
    from drivesizer.control.devices import Device
    from drivesizer.control.validation import Validation
    from drivesizer.results.drive_set import DriveSet
    from drivesizer.simulate import Commissioned
    from drivesizer.spec.machine import MachineSpec
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
    spec: common.Spec = common.DEFAULT,
    device: OfDevice = None,
    firmware: OfFirmware = None,
    output: Annotated[Path | None, common.file_option("--output", "-o", help="The file to write.")] = None,
    unconfirmed: Unconfirmed = False,
    settings: Settings = None,
    chosen: common.DriveOption = None,
    axis: common.OfAxis = None,
    catalogs: common.More = None,
) -> None:
    """Write the drive's gains and limits as its controller takes them, and what they stand for after rounding."""
    from drivesizer.files.writing import write_files
    from drivesizer.output.document import records as doc
    from drivesizer.output.export import device_file
    from drivesizer.simulate import commissioned, hardest_case

    own, drive = common.one_drive(spec, chosen, catalogs, axis, "a file is that of one drive")
    controller, board = device_for(drive, device, firmware), settings_of(drive, device, firmware, settings)
    if axis:  # where the controller's form has the name of a joint
        named = (row._replace(name=row.name.replace("JOINT", axis)) for row in controller.parameters)
        controller = controller._replace(parameters=tuple(named))
    if output:
        device_file.accept(controller, output)
    with common.simulating("simulating the loop"):
        case = hardest_case(own, drive)
        result = commissioned(own, drive, controller, settings=board, unconfirmed=unconfirmed, load_case=case)
    rows, proof = result.rows, result.rounded
    if output:
        common.print_written(
            write_files(device_file.files(controller, rows, _remarks(controller, result, board), output))
        )
    shared = rows[0].parameter.name.rpartition(".")[0] + "."
    if len(shared) < _LONG or not all(row.parameter.name.startswith(shared) for row in rows):
        shared = ""
    table = doc.table("device", "", [
        (row.parameter.name.removeprefix(shared), row.text, row.unit, row.in_si, row.parameter.meaning) for row in rows
    ])  # fmt: skip
    head = [f"{controller.title}: {drive.label}", *([f"below {shared.removesuffix('.')}:"] if shared else [])]
    notes = [
        *loops(result),
        *_warned(controller, result, board),
        *(f"{word}: {controller.words[word]}" for word in ("first", "load")),
    ]
    common.show_blocks([*map(doc.Words, head), table, *map(doc.Words, notes)])
    raise typer.Exit(int(proof.status == "fail"))


def device_for(drive: DriveSet, name: str | None, firmware: str | None) -> Device:
    """The controller of the table that is named, or that of the drive."""
    from drivesizer.control.devices import device_of

    part = drive.actuator or drive.controller
    return device_of(name, f"{part.family} {part.part}" if part else "", firmware)


def settings_of(drive: DriveSet, name: str | None, firmware: str | None, words: list[str] | None) -> dict[str, float]:
    """Figures of the user's board, of those that the controller has."""
    device, figures = device_for(drive, name, firmware), {}
    for word in words or ():
        figure, _, text = word.partition("=")
        try:
            figures[figure] = float(text)
        except ValueError:
            text = ""
        if figure not in device.settings or not text or not 0.0 < figures[figure] < 1e9:
            known = ", ".join(f"{name} ({what})" for name, (_, what) in device.settings.items()) or "none"
            raise InputError(f"--setting: {quoted(word)} is no setting of {device.title}; expected NAME=VALUE in SI, "
                             f"of {known}")  # fmt: skip
    return figures


def with_device(
    axes: list[tuple[str, RobotSpec, DriveSet]], device: str | None, firmware: str | None, profile: str | None,
    case: str | None,
) -> dict[str, Commissioned]:  # fmt: skip
    """The drive of every axis behind a controller of the table, as ``validate --device`` simulates it."""
    from drivesizer.simulate import commissioned, hardest_case

    results = {}
    for name, spec, drive in axes:
        with common.simulating(f"simulating {name or 'the drive'} behind its controller"):
            result = commissioned(
                spec, drive, device_for(drive, device, firmware), unconfirmed=True, profile=profile,
                load_case=case or hardest_case(spec, drive),
            )  # fmt: skip
        results[name] = result
    return results


def loops(result: Commissioned) -> list[str]:
    """The loops as they are written: verdict over the motion, phase margins and what rounding took of them."""
    proof = result.rounded
    lines = [f"with these figures: {proof.status} over {proof.over}" + (f" ({proof.failed})" if proof.failed else "")]
    for exact, written in zip(result.exact.loops, proof.loops, strict=True):
        lost = max(0.0, degrees(exact.phase_margin - written.phase_margin))
        name = written.name if getattr(proof.gains, "kp", 1.0) else "position"  # which acts on the voltage by itself
        lines.append(f"{name} loop: phase margin {degrees(written.phase_margin):.1f}°, {lost:.2f}° lost by "
                     f"rounding; bandwidth {written.bandwidth:.3g} Hz")  # fmt: skip
    return lines


def _warned(device: Device, result: Commissioned, board: dict[str, float]) -> list[str]:
    """Notes on what is not written, what a setting decides, and what is to be known of the controller."""
    lines = [f"not written: {line}" for line in result.left_out]
    for name, (usual, what) in device.settings.items():
        value = board.get(name, usual)
        lines.append(f"setting: {name} = {'unknown' if isnan(value) else f'{value:g}'} {what} (--setting)")
    return lines + ([f"note: {device.words['note']}"] if device.words["note"] else [])


def _remarks(device: Device, result: Commissioned, board: dict[str, float]) -> list[str]:
    """Lines in the file beside its parameters: the table read back."""
    return [
        f"{device.title}, by drivesizer: {result.exact.drive_set.label}", f"source of units: {device.words['source']}",
        f"first: {device.words['first']}", f"load: {device.words['load']}", "",
        *(f"{f'{row.parameter.name} = {row.text} {row.unit}'.rstrip()}: {row.parameter.meaning}; "
          + f"{row.in_si}; " * bool(row.in_si) + f"exactly {row.exact:.8g}; {row.parameter.confidence}"
          for row in result.rows), "",
        *loops(result), *_warned(device, result, board),
    ]  # fmt: skip


def validate(
    spec: common.Spec = common.DEFAULT,
    profile: common.Profile = None,
    chosen: common.DriveOption = None,
    json: common.Json = False,
    csv: Annotated[Path | None, common.file_option(help="Also write the time series to this CSV file.")] = None,
    drawings: Annotated[
        Path | None,
        common.file_option("--figures", metavar="FOLDER", help="Also draw the loop, Bode and step: SVG and PNG."),
    ] = None,
    case: Annotated[
        str | None, typer.Option(metavar="NAME", help="The load case to simulate; else the hardest.")
    ] = None,
    everything: Annotated[bool, typer.Option("--all", help="The best drives of the search, ranked anew.")] = False,
    top: Annotated[int, common.whole_option("--top", 5, 1, 100, meaning="How many, with --all; at most 100.")] = 5,
    checks: Annotated[bool, typer.Option("--checks", help="Also every check, the gains, and the loops.")] = False,
    device: OfDevice = None,
    firmware: OfFirmware = None,
    axis: common.OfAxis = None,
    catalogs: common.More = None,
) -> None:
    """Simulate a drive over the profile in closed loop: every demand against its limit."""
    from drivesizer.output import report as reports
    from drivesizer.output.terminal import sizing

    robot, drives = common.load_chosen(spec, chosen, catalogs, axis)
    reports.accept([], tables=[csv] if csv else [])
    _known_case(robot, case)
    if everything:
        if drives or csv or drawings or device or firmware:
            raise InputError("--all: it takes the drives of the search; --set, --csv, --figures and --device are for "
                             "one of them")  # fmt: skip
        raise typer.Exit(_all_of(robot, case, profile, top, json))
    axes = common.with_drives(robot, drives)[0]
    if device or firmware:
        results = with_device(axes, device, firmware, profile, case)
        proofs = {name: result.rounded for name, result in results.items()}
    else:
        proofs = _proofs(axes, case, profile)
    for name, proof in proofs.items():
        if drawings:
            folder = drawings.with_name(f"{drawings.name}_{name}") if name else drawings
            common.print_written(reports.write_loop_figures(proof, folder))
        if csv:
            reports.write_series(proof, csv.with_name(f"{csv.stem}_{name}{csv.suffix}") if name else csv)
    if json:
        records = [{"name": name or robot.name, "validations": [proof]} for name, proof in proofs.items()]
        common.print_json({"axes": records})
    elif alone := proofs.get(""):
        sizing.validation(alone, checks=checks)
        common.print_notes(alone.warnings)
    else:
        sizing.machine_proofs(robot.name, proofs)
    if device or firmware:
        common.print_notes(tuple(dict.fromkeys(proof.assumptions[0] for proof in proofs.values())))
    raise typer.Exit(int(any(proof.status == "fail" for proof in proofs.values())))


def _proofs(
    axes: list[tuple[str, RobotSpec, DriveSet]], case: str | None, profile: str | None
) -> dict[str, Validation]:
    """The drive of every axis in closed loop; of several without those that cannot be simulated, with a note."""
    proofs = {}
    for name, spec, drive in axes:
        try:
            proofs[name] = common.in_closed_loop(name, spec, drive, profile=profile, case=case)
        except NoLoopError as error:
            if not name:
                raise
            common.print_notes((f"{name}: not simulated in {'open' if drive.steps else 'closed'} loop: {error}",))
    return proofs


def _cases(spec: RobotSpec) -> list[str]:
    from drivesizer.load_cases.of_machine import load_cases

    return [case for _, case, _ in load_cases(spec)]


def _known_case(machine: MachineSpec, name: str | None) -> None:
    """Refuse a name that no load case has; of several axes those that lack it are simulated in their hardest."""
    if name is None:
        return
    cases = dict.fromkeys(case for axis in machine.axes if not axis.is_joint for case in _cases(axis.spec))
    if name not in cases and not machine.robot:
        raise InputError(f"--case: {quoted(name)} is not known; expected {', '.join(filter(None, cases)) or 'none'}")


def _all_of(machine: MachineSpec, case: str | None, profile: str | None, top: int, json: bool) -> int:
    """The best drives of the search in closed loop, of every axis those that pass first; the exit status."""
    from drivesizer.output.terminal import sizing as terminal
    from drivesizer.simulate import validate_all

    result = common.with_drives(machine, None, top)[1]
    assert result is not None  # nothing is named
    records, failing = [], False
    for axis in result.axes:
        with common.simulating("simulating the drives in closed loop"):
            own = case if case in _cases(axis.spec) else None
            proofs, notes = validate_all(axis.result, profile=profile, load_case=own)
        failing |= all(proof.status == "fail" for proof in proofs)
        records.append({"name": axis.name, "validations": proofs})
        name = "" if result.alone else axis.name
        if not json:
            if name:
                typer.echo(f"\n{name}\n")
            terminal.validations(proofs, axis.result.objective)
        common.print_notes(notes, name)
    if json:
        common.print_json({"axes": records})
    return int(failing)


# -- ``drivesizer drive``.


def drive(
    spec: common.Spec = common.DEFAULT,
    trajectory: Annotated[
        Path | None,
        common.file_argument(metavar="TRAJECTORY.CSV", help="t, x, y, heading; or waypoints; else the spec's."),
    ] = None,
    chosen: common.DriveOption = None,
    json: common.Json = False,
    follow: Annotated[
        bool, typer.Option("--follow", help="Also simulate path following: both robot models, slip, poses fed back.")
    ] = False,
    failed: Annotated[
        list[int] | None,
        common.whole_option("--failed", 2, metavar="WHEEL", meaning="A wheel whose motor has failed; may be repeated."),
    ] = None,
    csv: Annotated[Path | None, common.file_option(help="Also write posture, speeds and torques over time.")] = None,
    drawings: Annotated[
        Path | None,
        common.file_option("--figures", metavar="FOLDER", help="Also draw path and errors (--follow): SVG, PNG."),
    ] = None,
    catalogs: common.More = None,
) -> None:
    """Drive a platform along a trajectory: requirements at each wheel, checks of a drive, speeds that it permits."""
    from drivesizer.load_cases.platform import driving, with_trajectory
    from drivesizer.machine.platform_budget import permitted_speeds
    from drivesizer.output.report import accept

    if drawings and not follow:
        raise InputError("--figures: it draws what --follow simulates; expected both, or none")
    fields, drives = common.fields_and_drives(chosen)
    robot = common.load_axis(spec, catalogs, None, fields)
    accept([], tables=[csv] if csv else [])
    on_path = with_trajectory(robot, trajectory, failed or ())
    demands = driving(on_path)
    drive = _drive_on_path(robot, on_path, drives)
    if csv:
        from drivesizer.output.report import write_driving

        write_driving(demands, csv)
    runs = _followed(demands, drive, drawings) if follow else {}
    speeds = permitted_speeds(on_path, drive) if drive else None
    if json:
        from drivesizer.output.json.documents import driving as document

        common.print_json(document(demands, drive, runs, speeds))
    else:
        from drivesizer.output.terminal import sizing as terminal

        terminal.driven(demands, drive, runs, speeds)
        if not drive:
            common.print_notes(("no drive meets all limits for the spec's own motion; see `drivesizer size`",))
    raise typer.Exit(0 if drive and drive.status != "fail" else 1)


def _followed(demands: Any, drive: Any, drawings: Path | None) -> Any:
    """Simulate the runs along the path, and draw them where a folder is given."""
    from drivesizer.control.path_following import follow_runs, runs_of_figure

    with common.working("simulating the platform on its path"):
        runs = follow_runs(demands, drive)
    if drawings:
        from drivesizer.output.report import write_path

        common.print_written(write_path(runs_of_figure(runs), drawings))
    return runs


def _drive_on_path(robot: Any, on_path: Any, words: list[str] | None) -> Any:
    """The drive with its checks on the path: named by its parts, or the best for the spec's own motion; or None."""
    from drivesizer.catalog.view import OWN
    from drivesizer.sizing import explain
    from drivesizer.spec.machine import machine_of

    if words:
        return common.with_drives(machine_of(on_path), words)[0][0][2]
    sets = common.sized(machine_of(robot), 1).axes[0].result.sets
    if not sets or (robot.motion == on_path.motion and robot.platform == on_path.platform):
        return sets[0] if sets else None
    best = sets[0]
    parts = {role: getattr(best, role) for role in ("encoder", "controller", "brake")}
    pinned = {  # the only ones to choose from
        role: getattr(on_path.select, role).model_copy(update={"family": None, "part": [part.part]})
        for role, part in parts.items()
        if part is not None and part.family != OWN and not getattr(part, "inside", "")
    }
    spec = on_path.alone(select=on_path.select.model_copy(update=pinned))
    drives = explain(spec, (best.actuator or best.motor).part, best.gearhead.part)
    return next(drive for drive in drives if drive.belt_ratio == best.belt_ratio)
