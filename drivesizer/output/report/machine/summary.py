"""The first page of a machine's report: its verdict, a row for each axis, all parts, and the machine's own checks."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from math import inf, isnan
from typing import Any

from drivesizer.output.counted import number_of
from drivesizer.output.part_totals import LEAST, Total, totals
from drivesizer.output.report.lines.drive import check_row, tight_of
from drivesizer.output.report.machine.content import AxisContent, MachineContent
from drivesizer.output.report.sections.blocks import Block, Bullets, Checks, Column, Row, Table, Tiles, Verdict
from drivesizer.output.report.sections.part_lines import shared_parts_table, total_of
from drivesizer.output.report.sections.summary import summed_tile
from drivesizer.output.report.sections.texts import Status, Strong, Text
from drivesizer.output.several_axes import choice_text, supply_texts
from drivesizer.results.check import tightest
from drivesizer.results.objectives import objective_figure
from drivesizer.units import show

__all__ = ["drive_name", "notes", "summary_blocks", "verdict_text"]


def summary_blocks(content: MachineContent) -> Iterator[Block]:
    """The answer."""
    sizing = content.sizing
    yield Verdict(sizing.status != "fail", [(Status(content.status), " ", *verdict_text(content))])
    yield _axes_table(content)
    if sizing.checks:
        yield Checks("Checks of all axes together", [*map(check_row, sizing.checks)], "machine_checks")
    yield Tiles([*_tiles(content)])
    if content.bought:
        axes = [one.name for one in content.axes if one.sizing.best]
        whole = f"{_drives(content)} of {len(axes)} axes" if len(axes) > 1 else f"{_drives(content)} of {axes[0]}"
        yield shared_parts_table(content.bought, content.totals, whole)
    if notes(content):
        yield Bullets("Of all axes together:", notes(content))


def verdict_text(content: MachineContent) -> tuple[Any, ...]:
    """Axes that have a drive, as a text with marks."""
    sizing = content.sizing
    without = [one.name for one in sizing.axes if one.best is None]
    drives = number_of(content.drives, "drive")
    ranked = f"ranked by {sizing.objective.replace('_', ' ')}"
    if without:
        others = f" The others: {drives}, {ranked}." if content.drives else ""
        return Strong(f"No drive for {', '.join(without)}."), *_simulated(content), others
    failed = ", ".join(check.title for check in sizing.checks if check.status == "fail" and not check.advice)
    together = (Strong(f" Together they fail on: {failed}."),) if failed else ()
    return (
        Strong("Every axis has a drive."),
        *together,
        *_simulated(content),
        f" {drives} on {number_of(len(sizing.axes), 'axis', 'axes')}, {ranked}.",
    )


def _simulated(content: MachineContent) -> tuple[Any, ...]:
    """Verdict of all closed loops: those that fail by name."""
    failed = [
        f"{name} fails on {proof.failed}".removesuffix(" on ")
        for name, proof in content.proofs.items()
        if proof.status == "fail"
    ]
    if failed:
        return (Strong(f" Simulated in its hardest load case, {'; '.join(failed)}."),)
    passed = all(proof.status == "pass" for proof in content.proofs.values())
    said = f" Simulated in its hardest load case, {'every axis passes' if passed else 'no axis fails'}."
    return (said,) if len(content.proofs) == len(content.axes) else ()


def notes(content: MachineContent) -> list[str]:
    """Power of the supply and choice of the drives, as sentences."""
    power = content.sizing.power
    found = [*(supply_texts(power) if power else ()), *content.sizing.notes, choice_text(content.sizing)]
    return [note for note in found if note]


# -- a row for each axis


def _axes_table(content: MachineContent) -> Table:
    columns = (Column("axis", "name", 0.7), Column("drive", width=1.2), Column("carries", "number"),
               Column("mass", "number"), Column("price", "number"), Column("energy", "number"),
               Column("margin", "number"), Column("tightest check", "small", 0.8), Column("", "status"))  # fmt: skip
    rows = [Row(_axis_cells(one), {"axis": one.name}, one.status) for one in content.axes]
    caption = ("The axes: mass of other axes' drives on each, mass and price of its own parts as far as known, "
               "energy of its cycle")  # fmt: skip
    return Table(caption, columns, rows, "axes", dense=True)


def _axis_cells(one: AxisContent) -> tuple[Any, ...]:
    drive, carried = one.content.drive, one.sizing.carried_mass
    riding = show(carried, "kg", "mass", 3) if one.sizing.carried else ""
    if drive is None:
        return one.name, "no candidate", riding, "", "", "", "", "", (Status("fail"),)
    tight, energy = tight_of(drive), objective_figure(drive, "energy").text
    sums = totals(one.lines)
    return (one.name, drive_name(one), riding, _sum(sums, "mass"), _sum(sums, "price"), energy,
            tight["margin"], tight["title"], (Status(one.status),))  # fmt: skip


def drive_name(one: AxisContent) -> Text:
    """The drive of an axis; of one without the closest rejected, and that it is."""
    assert one.content.drive is not None
    count = f"{one.sizing.drives} × " if one.sizing.drives > 1 else ""
    label = f"{count}{one.content.drive.label}"
    return label if one.sizing.best else (Strong("none; closest:"), f" {label}")


def _sum(sums: Sequence[Total], name: str) -> str:
    return " + ".join(total_of(total).replace(LEAST, "≥ ") for total in sums if total.name == name) or "–"


# -- figures in large letters


def _tiles(content: MachineContent) -> Iterator[tuple[str, str, str]]:
    checks = [(check, one.name) for one in content.axes if one.sizing.best
              for check in tightest(one.sizing.best.deciding, 1)]  # fmt: skip
    checks += [(check, "all axes") for check in tightest(content.sizing.checks, 1)]
    if checks:
        check, name = min(checks, key=lambda pair: -inf if isnan(pair[0].margin) else pair[0].margin)
        yield "Smallest margin", check_row(check)["margin"] or "none", f"{name}: {check.title}"
    for figure in ("mass", "price"):
        yield summed_tile(content.totals, figure, _drives(content))


def _drives(content: MachineContent) -> str:
    return "the one drive" if content.drives == 1 else f"all {content.drives} drives"
