"""``drivesizer validate`` and ``drivesizer drive``."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from drivesizer.commands import commission, common
from drivesizer.commands.commission import OfDevice, OfFirmware
from drivesizer.commands.common import DEFAULT, Chosen, Json, More, OfAxis, Profile, Spec, file_argument, file_option
from drivesizer.errors import InputError, NoLoopError, quoted

if TYPE_CHECKING:
    from drivesizer.control.validation import Validation
    from drivesizer.results.drive_set import DriveSet
    from drivesizer.spec.machine import MachineSpec
    from drivesizer.spec.robot import RobotSpec


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
    top: Annotated[int, common.whole_option("--top", 5, 1, 100, meaning="How many, with --all; at most 100.")] = 5,
    checks: Annotated[bool, typer.Option("--checks", help="Also every check, the gains, and the loops.")] = False,
    device: OfDevice = None,
    firmware: OfFirmware = None,
    axis: OfAxis = None,
    catalogs: More = None,
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
    axes, several = common.with_drives(robot, drives)[0], robot.is_several
    if device or firmware:
        made = commission.proofs(axes, device, firmware, profile, case)
        proofs = {name: one.rounded for name, one in made.items()}
    else:
        proofs = _proofs(axes, case, profile)
    for name, proof in proofs.items():
        if drawings:
            folder = drawings.with_name(f"{drawings.name}_{name}") if several else drawings
            common.print_written(reports.write_loop_figures(proof, folder))
        if csv:
            reports.write_series(proof, csv.with_name(f"{csv.stem}_{name}{csv.suffix}") if several else csv)
    if json:
        each = [{"name": name or robot.name, "validations": [proof]} for name, proof in proofs.items()]
        common.print_json({"axes": each})
    elif several:
        sizing.machine_proofs(robot.name, proofs)
    else:
        sizing.validation(proofs[""], checks=checks)
        common.print_notes(proofs[""].warnings)
    if device or firmware:
        common.print_notes(tuple(dict.fromkeys(proof.assumptions[0] for proof in proofs.values())))
    raise typer.Exit(int(any(proof.status == "fail" for proof in proofs.values())))


def _proofs(
    axes: list[tuple[str, RobotSpec, DriveSet]], case: str | None, profile: str | None
) -> dict[str, Validation]:
    """The drive of every axis in closed loop; of several without those that cannot be simulated, with a note."""
    proofs = {}
    for name, spec, found in axes:
        try:
            proofs[name] = common.in_closed_loop(name, spec, found, profile=profile, case=case)
        except NoLoopError as error:
            if not name:
                raise
            common.print_notes((f"{name}: not simulated in {'open' if found.steps else 'closed'} loop: {error}",))
    return proofs


def _cases(spec: RobotSpec) -> list[str]:
    from drivesizer.load_cases.of_machine import load_cases

    return [case for _, case, _ in load_cases(spec)]


def _known_case(machine: MachineSpec, name: str | None) -> None:
    """Refuse a name that no load case has; of several axes those that lack it are simulated in their hardest."""
    if name is None:
        return
    found = dict.fromkeys(case for one in machine.axes if not one.is_joint for case in _cases(one.spec))
    if name not in found and not machine.robot:
        raise InputError(f"--case: {quoted(name)} is not known; expected {', '.join(filter(None, found)) or 'none'}")


def _all_of(machine: MachineSpec, case: str | None, profile: str | None, top: int, json: bool) -> int:
    """The best drives of the search in closed loop, of every axis those that pass first; the exit status."""
    from drivesizer.output.terminal import sizing as terminal
    from drivesizer.simulate import validate_all

    result = common.with_drives(machine, None, top)[1]
    assert result is not None  # nothing is named
    each, failing, several = [], False, machine.is_several
    for axis in result.axes:
        with common.simulating("simulating the drives in closed loop"):
            own = case if case in _cases(axis.spec) else None
            proofs, notes = validate_all(axis.result, profile=profile, load_case=own)
        failing |= all(proof.status == "fail" for proof in proofs)
        each.append({"name": axis.name, "validations": proofs})
        if not json:
            if several:
                typer.echo(f"\n{axis.name}\n")
            terminal.validations(proofs, axis.result.objective)
        common.print_notes(notes, axis.name if several else "")
    if json:
        common.print_json({"axes": each})
    return int(failing)


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
        common.whole_option("--failed", 2, metavar="WHEEL", meaning="A wheel whose motor has failed; may be repeated."),
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
    fields, drives = common.fields_and_drives(chosen)
    robot = common.load_axis(spec, catalogs, None, fields)
    accept([], tables=[csv] if csv else [])
    on_path = with_trajectory(robot, trajectory, failed or ())
    found = driving(on_path)
    one = _drive_on_path(robot, on_path, drives)
    if csv:
        from drivesizer.output.report import write_driving

        write_driving(found, csv)
    runs = _followed(found, one, drawings) if follow else {}
    speeds = permitted_speeds(on_path, one) if one else None
    if json:
        from drivesizer.output.json.documents import driving as document

        common.print_json(document(found, one, runs, speeds))
    else:
        from drivesizer.output.terminal import sizing as terminal

        terminal.driven(found, one, runs, speeds)
        if not one:
            common.print_notes(("no drive meets all limits for the spec's own motion; see `drivesizer size`",))
    raise typer.Exit(0 if one and one.status != "fail" else 1)


def _followed(found: Any, one: Any, drawings: Path | None) -> Any:
    """Simulate the runs along the path, and draw them where a folder is given."""
    from drivesizer.control.path_following import drawn, follow_runs

    with common.working("simulating the platform on its path"):
        runs = follow_runs(found, one)
    if drawings:
        from drivesizer.output.report import write_path

        common.print_written(write_path(drawn(runs), drawings))
    return runs


def _drive_on_path(robot: Any, on_path: Any, chosen: list[str] | None) -> Any:
    """The drive with its checks on the path: named by its parts, or the best for the spec's own motion; or None."""
    from drivesizer.catalog.view.mounted import OWN
    from drivesizer.sizing import explain
    from drivesizer.spec.machine import machine_of

    if chosen:
        return common.with_drives(machine_of(on_path), chosen)[0][0][2]
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
    found = explain(spec, (best.actuator or best.motor).part, best.gearhead.part)
    return next(one for one in found if one.belt_ratio == best.belt_ratio)
