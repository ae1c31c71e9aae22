"""Commands over all axes of a machine."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import typer

from drivesizer.commands.common import DEFAULT, NothingFitsError, print_notes, progress, proven_axes, working
from drivesizer.errors import InputError

__all__ = [
    "explain_axes",
    "refuse_axis_options",
    "report_machine",
    "size_machine_axes",
    "sized_machine",
    "validate_axes",
]


def size_machine_axes(
    machine: Any,
    spec: Path,
    csv: Path | None,
    pdf: Path | None,
    given: Mapping[str, object],
    top: int,
    objective: str | None,
    sampling: tuple[Any, ...],
    checks: bool,
    quiet: bool,
    json: bool,
) -> int:
    """Size all axes of a machine and print them; the exit status.

    Parameters
    ----------
    machine
        Of several axes.
    spec
        Its file as it was named.
    csv, pdf
        Files to write as well: the table of axes, and the report with all closed loops.
    given
        Options that are of a single axis, by name; a value that is not empty is refused.
    top, objective, sampling, checks, quiet, json
        As of ``drivesizer size``.

    Returns
    -------
    int
        0 where every axis has a drive and none of the machine's own checks fails, else 1.
    """
    from drivesizer.output.report import accept, write_machine

    refuse_axis_options(given)
    accept([path for path in (csv, pdf) if path])
    result = sized_machine(machine, top, objective, sampling)
    if csv:
        write_machine(result, {}, [csv])
    if pdf:
        simulated = proven_axes(result)
        with working("writing the report"):
            write_machine(*simulated, [pdf])
    if json:
        from drivesizer.output.json.documents import as_text, machine_document

        typer.echo(as_text(machine_document(result)))
    else:
        from drivesizer.output.terminal.several_axes import machine_sizing

        machine_sizing(result, spec="" if spec == DEFAULT else str(spec), checks=checks, quiet=quiet)
        if not quiet:
            print_notes(tuple(f"{axis.name}: {note}" for axis in result.axes for note in axis.result.warnings))
    return int(result.status == "fail")


def report_machine(
    machine: Any,
    output: Sequence[Path],
    given: Mapping[str, object],
    top: int,
    objective: str | None,
    sampling: tuple[Any, ...],
    profile: str | None,
    drawings: Path | None,
    paper: str,
    date: str | None,
) -> int:
    """Write the report of all axes of a machine; the exit status.

    Parameters
    ----------
    machine
        Of several axes.
    output
        Files to write.
    given
        Options that are of a single axis, by name; a value that is not empty is refused.
    top, objective, sampling
        As of ``drivesizer size``.
    profile
        As of ``drivesizer validate``.
    drawings
        A folder for every figure, where they are wanted.
    paper, date
        As of ``drivesizer report``.

    Returns
    -------
    int
        As of :func:`size_all`.
    """
    from drivesizer.output.report import write_machine, write_machine_figures

    refuse_axis_options(given)
    result, proofs = proven_axes(sized_machine(machine, top, objective, sampling), profile)
    with working("writing the report"):
        written = write_machine(result, proofs, output, paper=paper, date=date)
        if drawings:
            written += write_machine_figures(result, proofs, drawings)
    for path in written:
        typer.echo(path)
    return int(result.status == "fail")


def validate_axes(machine: Any, given: Mapping[str, object], profile: str | None, json: bool) -> int:
    """Simulate the drive of every axis in closed loop, in its hardest load case; the exit status.

    Parameters
    ----------
    machine
        Of several axes.
    given
        Options that are of a single axis, by name; a value that is not empty is refused.
    profile, json
        As of ``drivesizer validate``.

    Returns
    -------
    int
        0 where no axis fails, else 1.
    """
    refuse_axis_options(given)
    result = sized_machine(machine, 1, None)
    without = next((axis.name for axis in result.axes if axis.best is None), None)
    if without is not None:
        raise NothingFitsError(f"{without}: no drive meets all limits; `drivesizer size` shows the closest rejected")
    _, proofs = proven_axes(result, profile)
    if json:
        from drivesizer.output.json.documents import SCHEMA_VERSION, as_text, validation

        documents = {name: validation(proof) for name, proof in proofs.items()}
        typer.echo(as_text({"schema_version": SCHEMA_VERSION, "axes": documents}))
    else:
        from drivesizer.output.terminal.several_axes import machine_proofs

        machine_proofs(machine.name, proofs)
    return 1 if any(proof.status == "fail" for proof in proofs.values()) else 0


def explain_axes(
    machine: Any, motor: str, gearhead: str, sampling: tuple[int | None, int | None, int | None], json: bool
) -> int:
    """Show of which axes of a machine one combination of motor and gearhead meets all limits; the exit status.

    Parameters
    ----------
    machine
        Of several axes: each has the best drives of the others on it.
    motor, gearhead, json
        As of ``drivesizer explain``.
    sampling
        Samples, seed and samples in closed loop.

    Returns
    -------
    int
        0 where it does not fail on every axis, else 1.
    """
    from drivesizer.search.uncertainty.options import sampling_of
    from drivesizer.sizing import explained, load_parts

    samples, seed, loops = sampling
    result, found = sized_machine(machine, 1, None), {}
    for axis in result.axes:
        spec = axis.result.problem.machine
        with working(f"examining the drive on {axis.name}"):
            try:
                how = sampling_of(spec, samples=samples, seed=seed, loop=loops)
                found[axis.name] = explained(spec, motor, gearhead, catalog=load_parts(spec), sampling=how)
            except InputError as error:
                raise InputError(f"{axis.name}: {error}") from None
    if json:
        from drivesizer.output.json.documents import SCHEMA_VERSION, as_text, explanation

        documents = {name: explanation(one) for name, one in found.items()}
        typer.echo(as_text({"schema_version": SCHEMA_VERSION, "axes": documents}))
    else:
        from drivesizer.output.terminal.several_axes import machine_explained

        machine_explained(machine.name, found)
    return int(all(one.status == "fail" for pair in found.values() for one in pair.sets))


def refuse_axis_options(given: Mapping[str, object]) -> None:
    """Refuse options that are of a single axis.

    Parameters
    ----------
    given
        Values by option; one that is not empty is refused.

    Raises
    ------
    InputError
        One line.
    """
    refused = next((name for name, value in given.items() if value), None)
    if refused:
        raise InputError(f"{refused}: it is of a single axis; expected --axis beside it")


def sized_machine(machine: Any, top: int, objective: str | None, sampling: tuple[Any, ...] = ()) -> Any:
    """Size all axes of a machine.

    Parameters
    ----------
    machine
        Of several axes.
    top
        Drives of each axis.
    objective
        As the command line gives it.
    sampling
        Confidence, samples, seed, processes and samples in closed loop.

    Returns
    -------
    MachineSizing
        With the best drives of every axis.
    """
    from drivesizer.multi_axis.sizing import size_machine
    from drivesizer.search.ranking import objective_of
    from drivesizer.search.uncertainty.options import sampling_of

    rank = None if objective is None else objective_of(objective)
    with progress() as advance:
        return size_machine(
            machine, top=top, objective=rank, progress=advance, sampling=lambda spec: sampling_of(spec, *sampling)
        )
