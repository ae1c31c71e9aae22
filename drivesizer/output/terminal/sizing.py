"""Sizings, explanations, validations and machines at the terminal: the sections that answer, and what is wanted."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from rich.console import Console
from rich.text import Text

from drivesizer.catalog import Catalog
from drivesizer.output.document import SECTIONS, Chapter, at_work, candidates, machine, printed, summary
from drivesizer.output.document import records as doc
from drivesizer.output.document.content import Content, OfDrives, OfLoop
from drivesizer.output.document.rows import check_row
from drivesizer.output.terminal import render
from drivesizer.output.terminal.tables import MARK, STYLE, console, heading
from drivesizer.output.words import number_of
from drivesizer.results.check import gravest, tightest, worst
from drivesizer.results.check_kinds import missing_figures
from drivesizer.results.drive_set import DriveSet
from drivesizer.results.machine import MachineSizing
from drivesizer.results.sizing import Explanation, SizingResult
from drivesizer.units import show

if TYPE_CHECKING:
    from drivesizer.control.path_following import Followed
    from drivesizer.control.validation import Validation
    from drivesizer.load_cases.platform import Driving
    from drivesizer.machine.platform_budget import PermittedSpeeds


DETAILS = frozenset({"derivation", "checks", "paper", "ranking", "rejected"})
"""Details that :func:`sizing` shows on request beside the answer."""
_QUIET = {"summary", "changes", "confidence", "required", "pareto"}


def _selected(sections: Sequence[doc.Section], details: frozenset[str]) -> tuple[doc.Section, ...]:
    return tuple(section for section in sections if section.early == "answer" or section.early in details)


_BRIEF = ("axis", "quantity", "role", "order_number", "together", "missing")


def quote_in_brief(table: doc.Table) -> None:
    """Print a quote in the columns that a terminal has room for."""
    render.blocks(console(), [replace(table, columns=[column for column in table.columns if column.key in _BRIEF])])


def sizing(result: SizingResult, *, details: frozenset[str] = frozenset(), spec: str = "", quiet: bool = False) -> None:
    """Print a sizing: the drive, its verdict and tightest checks, alternatives, and the commands that lead on."""
    out, content = console(), Content(result)
    best = next(iter((*result.sets, *result.unsure)), None)
    heading(out, result.spec.name, *((MARK[best.status], STYLE[best.status]) if best else ("no drive", "")))
    sections = _selected(SECTIONS, details if best else details | {"rejected"})
    if quiet:
        sections = tuple(section for section in sections if section.name in _QUIET or section.early in details)
    render.sections(out, printed([Chapter(content, sections)], doc.TERMINAL))
    behind = f" {spec}" if spec else ""
    if not best and not quiet and "all" not in result.spec.select.catalogs:
        out.print(f"\nnext: drivesizer size{behind} --catalog all looks at the drives of all makers", soft_wrap=True)
    if best and not quiet:
        loop = "open loop" if best.steps else "closed loop"
        _next(
            out,
            f"drivesizer size{behind} --checks, or -v for all; drivesizer validate{behind}: {loop}",
            behind,
        )


def _next(out: Console, first: str, behind: str) -> None:
    """Print the commands that lead on."""
    out.print(f"\nnext: {first}", soft_wrap=True)
    out.print(f"      drivesizer report{behind} -o report.pdf, or .html, .xlsx, .csv, .json", soft_wrap=True)


_NO_CHANGE = {
    "physics": "None of the spec's figures, changed alone by up to a factor of 20, would let it pass.",
    "paper": "No other reduction of the gearhead's family would let it pass.",  # by that rule no figure is tried
}


def explained(pair: Explanation, catalog: Catalog) -> None:
    """Print a combination of motor and gearhead check by check, for every belt ratio, and its probabilities."""
    out = console()
    sections = [section for section in SECTIONS if section.of_drive and section.early in ("answer", "checks", "paper")]
    for drive in pair.sets:
        heading(out, drive.label, MARK[drive.status], STYLE[drive.status])
        of = OfDrives(catalog, tuple(dict.fromkeys(c.case for c in drive.own_checks if c.case)))
        render.sections(out, (doc.Printed(section, "", [*section.blocks(of, drive)]) for section in sections))
        if missing := missing_figures(drive):
            out.print(Text(f"missing: {', '.join(missing)}", style=STYLE["unknown"]))
        _changes(out, drive)
    if pair.uncertainty is not None:
        render.blocks(out, [
            candidates.probability_table("Probability that all checks pass",
                                         [drive for drive in pair.sets if drive.reliability], ""),
            candidates.uncertain_table(pair.uncertainty), candidates.sampled_words(pair.uncertainty),
        ])  # fmt: skip


def _changes(out: Console, drive: DriveSet) -> None:
    """Changes of the spec that would let a failing drive pass."""
    if drive.status != "fail":
        return
    if not drive.changes:
        out.print(_NO_CHANGE[drive.checks[0].method])
    for title, changes in summary.changes_by_outcome(drive.changes, "it"):
        out.print(title.removesuffix(":") + ", smallest first:")
        for change in changes:
            out.print(Text(f"  {change.field} {change.now} → {change.needed}"))


# -- closed loops


def validation(proof: Validation, *, checks: bool = False) -> None:
    """Print a validation: its verdict, the tightest checks and what helps; all checks, gains and loops on request."""
    out = console()
    heading(out, f"{proof.spec.name}: {proof.over}", MARK[proof.status], STYLE[proof.status])
    names = {"loop", "loop-details", "linear"} if checks else {"loop"}
    loop = (section for section in SECTIONS if section.name in names)
    render.sections(out, (doc.Printed(section, "", [*section.blocks(OfLoop(proof))]) for section in loop))
    if not checks:
        out.print(
            "\nnext: drivesizer validate --checks has every check, the figures, the gains and the loops", soft_wrap=True
        )


def validations(proofs: Sequence[Validation], objective: str) -> None:
    """Print several drives in closed loop, a line each, best first."""
    out, first = console(), proofs[0]
    heading(out, f"{first.spec.name}: {first.profile}", f"{number_of(len(proofs), 'drive')} in {first.loop}", "")
    rows = [_proof_row(proof, place=doc.Quantity(place), was=doc.Quantity(proof.drive_set.rank),
                       objective=candidates.objective_quantity(proof.drive_set, objective))
            for place, proof in enumerate(proofs, 1)]  # fmt: skip
    render.blocks(out, [doc.table("proofs", "", rows, heads={"objective": objective.replace("_", " ")})])


def _proof_row(proof: Validation, **cells: Any) -> doc.Row:
    """A closed loop by its tightest check."""
    tight = worst(proof.checks)
    margin = doc.Quantity(tight.margin, "%", "margin") if tight else ""
    return doc.row("proofs", proof, name="", title=tight.title if tight else "–", margin=margin, **cells)


# -- machines of several axes


def machine_sizing(
    result: MachineSizing, *, spec: str = "", checks: bool = False, quiet: bool = False, chapters: bool = True
) -> None:
    """Print the sizing of a machine, on request with all checks and a chapter of each axis."""
    from drivesizer.output.document import axes

    out = console()
    status = MARK[result.status] if result.complete else "no drive for every axis"
    heading(out, result.machine.name, status, STYLE[result.status])
    early = {"answer", "checks"} if checks else {"answer"}
    all_chapters = axes.chapters(axes.MachineContent(result))
    selection = [chapter._replace(sections=[section for section in chapter.sections if section.early in early])
             for chapter in all_chapters if not chapter.axis or (chapters and checks)]  # fmt: skip
    render.sections(out, printed(selection, doc.TERMINAL))
    if not quiet:
        name = next((axis.name for axis in result.axes if axis.best is None), result.axes[0].name)
        behind, axis = f" {spec}" if spec else "", f'"{name}"' if " " in name else name
        _next(
            out,
            f"drivesizer size{behind} --axis {axis}, one axis in full; drivesizer validate{behind}: closed loops",
            behind,
        )


def machine_explained(name: str, explanations: Mapping[str, Explanation]) -> None:
    """Print how one combination of motor and gearhead does on every axis of a machine, with its tightest check."""
    out, rows = console(), []
    heading(out, name, "")
    out.print(Text(next(explanation.sets[0].label for explanation in explanations.values()), style="bold"))
    for axis, pair in explanations.items():
        status = gravest([drive.status for drive in pair.sets])
        drive = next(drive for drive in pair.sets if drive.status == status)
        tight = next(iter(tightest(drive.deciding, 1)), None)
        cells = dict(check_row(tight).cells) if tight else {}
        belt = f", belt {drive.belt_ratio:g}:1" if len(pair.sets) > 1 else ""
        title = f"{tight.title if tight else '–'}{belt}"
        rows.append(doc.Row({**cells, "axis": axis, "title": title, "status": (doc.Status(status),)}))
    render.blocks(out, [doc.table("pairs", "", rows)])


def machine_proofs(name: str, proofs: Mapping[str, Validation]) -> None:
    """Print the closed loops of a machine's axes, and steppers behind their pulses, a line each."""
    out = console()
    failed = [axis for axis, proof in proofs.items() if proof.status == "fail"]
    loops = " and ".join(dict.fromkeys(proof.loop for proof in proofs.values()))
    heading(out, name, f"FAIL: {', '.join(failed)}" if failed else loops, STYLE["fail"] * bool(failed))
    rows = [_proof_row(proof, axis=axis) for axis, proof in proofs.items()]
    helping = [at_work.remedies(proof, axis) for axis, proof in proofs.items() if proof.tried]
    render.blocks(out, [doc.table("proofs", "", rows), *helping])


# -- a set at the bench, a platform on its path


def driven(
    driving: Driving, drive: DriveSet | None, runs: Mapping[str, Followed], speeds: PermittedSpeeds | None = None
) -> None:
    """Print the requirements at each wheel, the checks of a drive on the path, its speeds."""
    out, path = console(), driving.trajectory
    status = (MARK[drive.status], STYLE[drive.status]) if drive else ("no drive", "")
    heading(out, f"{driving.spec.name}: {show(path.length, 'm', 'length')} in {show(path.total, 's', 'time')}", *status)
    render.blocks(out, machine.driving_blocks(driving, drive, runs, speeds))
