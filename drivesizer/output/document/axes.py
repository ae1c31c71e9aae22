"""The document of a machine of several axes: what all of them are, then a chapter for each of the sections of one."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from drivesizer.control.validation import Validation
from drivesizer.output.document import SECTIONS, Chapter, printed, summary
from drivesizer.output.document import records as doc
from drivesizer.output.document.candidates import percentiles_table, short_drive, spreads_table
from drivesizer.output.document.content import Content, Reported, all_drives, driven_over
from drivesizer.output.document.rows import check_row, check_table, consumers_table, figures_table, smallest, tight_of
from drivesizer.output.parts import PartLine, SharedLine, Total, machine_parts_of_axes, parts_by_axis, totals_of_axes
from drivesizer.output.words import likely, number_of, varying_checks
from drivesizer.results.check import Reliability, gravest, sentence_case, tightest, worst
from drivesizer.results.check import Status as CheckStatus
from drivesizer.results.machine import AxisSizing, MachinePower, MachineSizing, of_one_axis
from drivesizer.results.sizing import SizingResult, ranked_by
from drivesizer.spec.machine import MachineSpec
from drivesizer.units import show

if TYPE_CHECKING:
    from drivesizer.catalog import Catalog
    from drivesizer.output.report.figures.field import Panel
    from drivesizer.output.report.figures.picture import Pictured


_FIELDS = 4  # of axes in one figure, which has room below a long table of contents
_PIECES = 2000  # of the power over time: finer than a screen


@dataclass(frozen=True, slots=True, kw_only=True)
class AxisContent:
    """An axis, with what a document of it alone would print."""

    key: str  # before the names of its figures and tables, which every axis has
    sizing: AxisSizing
    content: Content
    lines: list[PartLine]  # parts that are bought
    own_supply: bool  # whether what it regenerates is its own affair

    @property
    def name(self) -> str:
        """Name in the file."""
        return self.sizing.name

    @property
    def status(self) -> CheckStatus:
        """Verdict of its drive and its closed loop; a fail without one."""
        return self.content.status


@dataclass(frozen=True)
class MachineContent(Reported):
    """A sizing of a machine; each part that takes time is computed once, when it is used."""

    sizing: MachineSizing
    proofs: Mapping[str, Validation] = field(default_factory=dict)  # closed loops, by the name of the axis

    @property
    def contents(self) -> dict[str, Content]:
        """The content of each axis by its name."""
        return {axis.name: axis.content for axis in self.axes}

    @property
    def given(self) -> MachineSpec:
        """The machine's file."""
        return self.sizing.machine

    @property
    def alone(self) -> Content | None:
        """The content of a single axis, of which a document says what it says of a plain spec; None of several."""
        return self.axes[0].content if len(self.axes) == 1 else None

    @property
    def words(self) -> str:
        """The machine in a line."""
        names = [axis.name for axis in self.axes]
        return self.alone.words if self.alone else f"Machine of {len(names)} axes: {', '.join(names)}"

    @property
    def catalog(self) -> Catalog:
        """The catalogue of the first axis, by whose rates prices are summed."""
        return self.axes[0].content.result.catalog

    @property
    def status(self) -> CheckStatus:
        """The gravest of the machine's verdict and those of all closed loops."""
        return gravest([self.sizing.status, *(proof.status for proof in self.proofs.values())])

    @cached_property
    def axes(self) -> list[AxisContent]:
        """Every axis, in the order of the file; one of several without its front, which served the choice."""
        lines, specs = parts_by_axis(self.sizing), self.sizing.machine.axes
        unsaid: dict[str, Any] = {"front": (), "pareto": ()} if len(specs) > 1 else {}
        return [
            AxisContent(
                key=f"axis{number}-", sizing=sizing, lines=lines[sizing.name],
                own_supply=len(specs) == 1 or axis.own_supply,
                content=Content(replace(sizing.result, **unsaid), self.proofs.get(sizing.name)),
            )
            for number, (sizing, axis) in enumerate(zip(self.sizing.axes, specs, strict=True), 1)
        ]  # fmt: skip

    @cached_property
    def bought(self) -> list[SharedLine]:
        """The parts list of all axes."""
        return machine_parts_of_axes(self.sizing)

    @cached_property
    def totals(self) -> list[Total]:
        """Mass and price of all parts."""
        return totals_of_axes(self.bought)

    @property
    def drives(self) -> int:
        """Drives of all axes that have one."""
        return sum(axis.drives for axis in self.sizing.axes if axis.best)

    @cached_property
    def document(self) -> doc.Document:
        """The machine on paper, but for the figures."""
        return doc.Document(name=self.name, machine=self.words, block=self.title_block,
                            sections=[*printed(chapters(self))], has_drive=self.sizing.complete)  # fmt: skip

    @cached_property
    def loads(self) -> dict[str, Pictured]:
        """Figures with the field of every axis, as many on each as a page has room for."""
        from drivesizer.output.report.figures.field import torque_speed_panels
        from drivesizer.output.report.figures.picture import Pictured

        fields = [*self._fields()]
        parts = [fields[n : n + _FIELDS] for n in range(0, len(fields), _FIELDS)]
        return {f"loads{n}": Pictured(torque_speed_panels(part)) for n, part in enumerate(parts, 1)}

    def _fields(self) -> Iterator[Panel]:
        """The field of each axis' drive with its first load case, under the name of the axis."""
        from drivesizer.output.report.figures.field import panels

        for axis in self.axes:
            drive, result = axis.content.drive, axis.content.result
            drive_panels = panels(result.problem, drive, result.requirements) if drive else []
            for panel in drive_panels[:1]:
                number, _, field = panel.cases[0]
                yield replace(panel, cases=((number, axis.name, field),), points=())

    @cached_property
    def pictures(self) -> dict[str, Pictured]:
        """Every figure by name: those of all axes, then those of each."""
        from drivesizer.output.report.figures.machine import axes_power
        from drivesizer.output.report.figures.picture import pictured

        if self.alone:
            return self.alone.pictures
        figures, power = dict(self.loads), self.sizing.power
        if power is not None and len(power.unknown) < len(power.axes):
            figures["power"] = pictured(axes_power(power))
        return figures | {
            f"{axis.key}{name}": figure for axis in self.axes for name, figure in axis.content.pictures.items()
        }


# -- The first page: the verdict, a row for each axis, all parts, and the machine's own checks.


def _verdict(content: MachineContent) -> Iterator[Any]:
    sizing = content.sizing
    without = [axis.name for axis in sizing.axes if axis.best is None]
    best = [axis.best for axis in sizing.axes if axis.best]
    drives, ranked = number_of(content.drives, "drive"), ranked_by(sizing.objective, best)
    failed = [
        f"{name} fails on {proof.failed}".removesuffix(" on ")
        for name, proof in content.proofs.items()
        if proof.status == "fail"
    ]
    yield doc.Status(content.status)
    yield doc.Strong(f" No drive for {', '.join(without)}." if without else " Every axis has a drive.")
    together = ", ".join(check.title for check in sizing.checks if check.status == "fail" and not check.advice)
    if together and not without:
        yield doc.Strong(f" Together they fail on: {together}.")
    if failed:
        yield doc.Strong(f" Simulated in its hardest load case, {'; '.join(failed)}.")
    elif len(content.proofs) == len(content.axes):
        passed = all(proof.status == "pass" for proof in content.proofs.values())
        yield f" Simulated in its hardest load case, {'every axis passes' if passed else 'no axis fails'}."
    if not without:
        yield f" {drives} on {number_of(len(sizing.axes), 'axis', 'axes')}, {ranked}."
    elif content.drives:
        yield f" The others: {drives}, {ranked}."


def answer(content: MachineContent) -> Iterator[doc.Block]:
    """The verdict, a row for each axis, all parts, and the machine's own checks."""
    sizing = content.sizing
    yield doc.Verdict(sizing.status != "fail", [tuple(_verdict(content))])
    caption = (
        "The axes: mass of other axes' drives on each, mass and price of one drive as far as known, energy of its cycle"
    )
    yield doc.table("axes", caption, map(_axis_row, content.axes))
    drives = [(axis.name, axis.content.drive) for axis in content.axes]
    tight = [
        doc.Row({**check_row(check).cells, "axis": name})
        for name, drive in drives
        for check in tightest(drive.deciding if drive else (), 1)
    ]
    by_axis = (doc.Column("axis", "axis", "name"), *doc.declared()["checks"][1])
    yield doc.Table("The smallest margin of each axis", by_axis, tight, "axes_tightest", media="terminal")
    if sizing.checks:
        yield check_table("Checks of all axes together", sizing.checks, "machine_checks")
    if content.bought:
        axes = [axis.name for axis in content.axes if axis.sizing.best]
        whole = f"{all_drives(content.drives)} of {f'{len(axes)} axes' if len(axes) > 1 else axes[0]}"
        lines = [(shared.line, ", ".join(shared.axes)) for shared in content.bought]
        yield summary.parts_table(f"Parts of {whole}", lines, content.totals)
        yield from summary.lacking_words(content.totals)
    power = sizing.power
    notes = [*(supply_texts(power) if power else ()), *sizing.notes, choice_text(sizing)]
    if any(notes):
        yield doc.Bullets("Of all axes together:", [note for note in notes if note])


def _axis_row(axis: AxisContent) -> doc.Row:
    """An axis by its drive, mass, price, energy and smallest margin, with what rides on it."""
    drive, sizing = axis.content.drive, axis.sizing
    names = ", ".join("its own" if riding.of == axis.name else riding.of for riding in sizing.carried)
    riding = f"on it {show(sizing.carried_mass, 'g', 'mass', 3)}: {names}" if sizing.carried else ""
    if drive is None:
        return doc.Row(
            {"axis": axis.name, "drive": ("no candidate", doc.Small(riding)), "status": (doc.Status("fail"),)},
            name=axis.name,
        )
    cells = dict(short_drive(drive).cells)
    label, *below = cells["drive"] if isinstance(cells["drive"], tuple) else (cells["drive"],)
    count = f"{sizing.drives} × " if sizing.drives > 1 else ""
    head = (doc.Strong("none; closest: "), label) if sizing.best is None else (count, label)
    margin, title = tight_of(drive, axis.content.validation)
    cells |= {"axis": axis.name, "drive": (*head, *below, doc.Small(riding)), "margin": margin, "tight": title,
              "status": (doc.Status(axis.status),)}  # fmt: skip
    return doc.Row(cells, name=axis.name, status=axis.status, data={"axis": axis.name})


def glance(content: MachineContent) -> Iterator[doc.Block]:
    """The figures that a reader wants first."""
    checks = [
        (c, axis.name) for axis in content.axes if axis.sizing.best for c in tightest(axis.sizing.best.deciding, 1)
    ]
    checks += [(c, f"{name}, {v.loop}") for name, v in content.proofs.items() for c in tightest(v.checks, 1)]
    checks += [(c, "all axes") for c in tightest(content.sizing.checks, 1)]
    tiles = []
    if checks:
        check, name = smallest(checks)
        margin = doc.Quantity(check.margin, "%", "margin").text
        tiles.append(("Smallest margin", margin or "none", f"{name}: {check.title}"))
    tiles += [summary.summed_tile(content.totals, figure, all_drives(content.drives)) for figure in ("mass", "price")]
    yield doc.Tiles(tiles)


# -- The axes as a tree, and how their drives were chosen.


class Branch(NamedTuple):
    """An axis in the tree of a machine: below the one that its drives ride on."""

    name: str
    depth: int  # 0 for one that rides on none
    on: str  # the axis that carries it; empty for one that rides on none


def mass_tree(machine: MachineSpec) -> list[Branch]:
    """The axes of a machine from those that carry all others to the outermost."""
    riding = {axis.name: list(machine.carried(axis.name)) for axis in machine.axes}
    carried = {name for names in riding.values() for name in names}

    def below(name: str, depth: int, on: str) -> Iterator[Branch]:
        yield Branch(name, depth, on)
        further = {other for rider in riding[name] for other in riding[rider]}
        for other in riding[name]:
            if other not in further:
                yield from below(other, depth + 1, name)

    return [branch for axis in machine.axes if axis.name not in carried for branch in below(axis.name, 0, "")]


def choice_text(result: MachineSizing) -> str:
    """Whether another choice of the drives that ride on others can be better."""
    if not result.complete or not any(axis.carried for axis in result.axes):
        return ""
    words = "no other choice of the carried drives gives"
    words = words if result.certain else "another choice of the carried drives may give"
    return f"{words} less {result.objective.replace('_', ' ')} in all"


def supply_texts(power: MachinePower) -> Iterator[str]:
    """Power of all axes in a sentence each: peak, mean, what is regenerated and what burns it."""
    if power.unknown:
        yield f"power of all axes unknown: {'; '.join(power.unknown)}"
        return
    peak, mean = (show(value, "W", "power") for value in (power.peak, power.mean))
    moment = f"at {show(power.peak_time, 's', 'time')}" if power.synchronised else "at the worst phase"
    yield f"supply: {peak} at most, {moment}, most of it {power.peak_axis}; {mean} in the mean"
    if power.energy_left > 0.0:
        left, shared = (show(value, "J", "energy") for value in (power.energy_left, power.exchanged))
        resistor = power.braking.name if power.braking else ""
        burnt = f", brake resistor {resistor}" if resistor else ""
        balance = f"{left} that no axis draws, {shared} from axis to axis" if power.synchronised else f"{left} at most"
        yield f"regenerated per cycle: {balance}{burnt}"
    if power.reliability:
        yield sampled_text(power.reliability)
    if power.energy:
        yield f"battery: {show(power.energy.autonomy, 'h', 'time')} with all axes"


def sampled_text(reliability: Reliability) -> str:
    """The probability that no limit of the supply is exceeded, as a sentence without its point."""
    text = f"over tolerances no limit of the supply is exceeded with {likely(reliability.probability)}"
    error = f"{text} ± {100.0 * reliability.error:.2g} %, weakest: {sentence_case(reliability.weakest)}"
    return f"{error}; unknown: {', '.join(reliability.unknown)}" if reliability.unknown else error


# -- Chapters on all axes: their loads side by side, power, who carries whom, closed loops, assumptions, the appendix.


def loads(content: MachineContent) -> Iterator[doc.Block]:
    """The field of each axis with its load."""
    cases = any(len(axis.content.cycles) > 1 for axis in content.axes)
    first = " Of several load cases the first is drawn." if cases else ""
    lacking = [axis.name for axis in content.axes if axis.sizing.best is None and axis.content.drive]
    missed = f" Of {', '.join(lacking)} it is the closest rejected drive." if lacking else ""
    names = [*content.loads]
    for name in names:
        caption = doc.sentence("axes_fields", first=first, missed=missed)
        about = "sets the load of each axis against the limits of its motor." if name == names[0] else ""
        last = caption if name == names[-1] else "Continued below."
        yield doc.Picture(name, last, "torque-speed field of each axis with its cycle", about)


def supply(content: MachineContent) -> Iterator[doc.Block]:
    """Power of all axes over time, its limits, and the battery."""
    power = content.sizing.power
    if power is None:
        return
    if power.unknown:
        yield doc.Bullets("Of some axes the power is unknown, and with it the sum:", list(power.unknown), "alarm")
    together = "" if power.synchronised else " Every axis starts at any time; here all their peaks fall together."
    case = f" Load case {power.case}." if power.case else ""
    yield doc.picture("power", case=case, together=together)
    yield figures_table("All axes on one supply", power.figures, "power", name="machine_figures", halves=True)
    if power.exceeded:
        titles = {check.name: check.title for check in power.checks}
        caption = "Share of the time in which axes at random phases draw more than the supply gives"
        rows = [doc.row("exceeded", excess, name=excess.check, title=titles.get(excess.check, excess.check))
                for excess in power.exceeded]  # fmt: skip
        yield doc.table("exceeded", caption, rows)
    if power.braking and any(figure.value for figure in power.braking.figures):
        of = f" with brake resistor {power.braking.name}" if power.braking.name else ""
        yield figures_table(f"What is regenerated, stored and burnt{of}", power.braking.figures, "braking")
    if power.energy:
        yield doc.Pair([consumers_table(power.energy)], [figures_table("The battery", power.energy.figures, "battery")])
    if power.reliability:
        reliability, text = power.reliability, sampled_text(power.reliability)
        yield doc.Words(f"{text[0].upper()}{text[1:]}.")
        if varying_checks(reliability):
            caption = "Limits of the supply that samples change: share that passes, and quantiles of the margin"
            yield spreads_table(caption, varying_checks(reliability), "supply-checks")
        yield percentiles_table("All axes over the samples: percentiles", reliability, "supply-figures")
    texts = dict.fromkeys(
        text for record in (power, power.braking, power.energy) if record for text in record.assumptions
    )
    yield doc.Bullets("Assumptions:", list(texts))
    yield doc.Series(
        "Power", "power", power_columns(power), note="mean powers, each from its time to that of the next row"
    )


def power_columns(power: MachinePower) -> dict[str, tuple[Any, str, str]]:
    """Mean powers, each from its time to that of the next row; the last row repeats them at the end."""
    course = power.course(_PIECES)
    rows = {f"{name} drawn": values for name, values in zip(power.axes, course.drawn, strict=True)}
    rows |= {f"{name} returned": values for name, values in zip(power.axes, course.returned, strict=True)}
    rows |= {"out of the source": course.total, "left": course.left}
    columns = {name: (np.append(values, values[-1:]), "power", "W") for name, values in rows.items()}
    return {"time": (course.time, "time", "s"), **columns}


def riding_drives(content: MachineContent) -> Iterator[doc.Block]:
    """Axes below those that carry their drives."""
    sizing, rows = content.sizing, []
    if not any(axis.carried for axis in sizing.axes):
        return
    for branch in mass_tree(sizing.machine):
        axis = sizing.axis(branch.name)
        if not (branch.on or axis.carried):
            continue
        above = sizing.axis(branch.on).carried if branch.on else ()
        rider = next((rider for rider in above if rider.of == branch.name), None)
        indent = f"└{'──' * (branch.depth - 1)} " if branch.depth else ""
        cells: dict[str, doc.Cell] = {"axis": indent + branch.name, "drive": axis.best.label if axis.best else "none"}
        if rider:
            mass = doc.Quantity(rider.mass, "g", "mass")
            cells["own"] = replace(mass, own=f"at least {mass.text}") if rider.lacking else mass
            cells |= {"distance": doc.Quantity(rider.distance, "mm", "length")} if rider.distance is not None else {}
        cells |= {"on": doc.Quantity(axis.carried_mass, "g", "mass")} if axis.carried else {}
        rows.append(doc.Row(cells, name=branch.name))
    caption = "Each axis below the one that carries its drives; masses are in the load of the carrying axis"
    turning = any("distance" in row.cells for row in rows)
    yield doc.table("carried", caption, rows, without=() if turning else ["distance"], look="wide carried")
    yield doc.Words(doc.sentence("cabinet"), "note")


def closed_loops(content: MachineContent) -> Iterator[doc.Block]:
    """A row for each axis with a drive: what it was simulated over, and its tightest check."""
    if not content.proofs:
        return
    rows = [_loop_row(axis) for axis in content.axes if axis.sizing.best]
    caption = "Every axis simulated in its hardest load case, with the drives that ride on it"
    yield doc.table("axes_loops", caption, rows)
    yield doc.Words("Figures, gains and the loop over time are in the chapter of each axis.", "note")


def _loop_row(axis: AxisContent) -> doc.Row:
    v = axis.content.validation
    if v is None:
        return doc.Row(
            {"axis": axis.name, "over": "not simulated, see its warnings", "status": (doc.Status("unknown"),)},
            name=axis.name,
        )
    tight = worst(v.checks)
    cells: dict[str, doc.Cell] = dict(check_row(tight).cells) if tight else {}
    cells |= {"axis": axis.name, "over": f"{v.loop}, {driven_over(v)}", "title": tight.title if tight else ""}
    return doc.Row(cells | {"status": (doc.Status(v.status),)}, name=axis.name, data={"axis": axis.name})


# -- The chapter of one axis: its answer, then sections of a document of it alone, without what the machine has once.


_ELSEWHERE = {  # sections of one axis that the machine prints once, or that `--axis` alone prints
    "heat", "candidates", "ranking", "rejected", "specification", "pieces", "assumptions", "physics", "repeat",
    "datasheets",
}  # fmt: skip


def _chapter(axis: AxisContent) -> list[doc.Section]:
    left = _ELSEWHERE | (set() if axis.own_supply else {"braking"})
    left |= {"derivation"} if axis.content.result.method == "paper" else set()
    riding = ", ".join(f"{rider.of} ({show(rider.mass, 'g', 'mass')})" for rider in axis.sizing.carried)

    def opening(content: Content) -> Iterator[doc.Block]:
        yield from summary.summary(content)
        if riding:
            yield doc.Words(f"In its load are the drives of other axes: {riding}.")

    unknown = doc.Section(
        name="unknown", title="Unknown and unquoted figures", blocks=summary.unknown_blocks, level=2, early="never"
    )
    first = replace(_AXIS, title=f"Axis {axis.name}", blocks=opening)
    return [first, *(replace(section, level=2) for section in SECTIONS[1:] if section.name not in left), unknown]


FRONT, BACK = doc.sections("machine before its axes"), doc.sections("machine behind its axes")
_AXIS = doc.Section(name="axis", title="", blocks=lambda _: (), early="checks")


# -- A machine for all kinds of reports; one of a single axis gives the document of a plain spec.


def chapters(content: MachineContent, *, of_all_drives: bool = False) -> list[Chapter]:
    """Sections of all axes, and a chapter of each, or those of a single axis; of all drives for wide media."""
    if content.alone:
        return [Chapter(content.alone)]
    if not of_all_drives:
        axes = [Chapter(axis.content, _chapter(axis), axis.key) for axis in content.axes]
        return [Chapter(content, FRONT), *axes, Chapter(content, BACK)]
    own = [section for section in SECTIONS if section.name not in ("repeat", "summary")]
    return [Chapter(content, (*FRONT, *BACK)), *(Chapter(axis.content, own, axis.name) for axis in content.axes)]


Reportable = MachineContent | doc.Document  # of which there are reports


def document_of(content: Reportable) -> doc.Document:
    """The machine on paper, but for the figures; what is no sizing is one already."""
    return content if isinstance(content, doc.Document) else content.document


def wide_of(content: Reportable, media: frozenset[str]) -> Iterable[doc.Printed]:
    """Sections of workbook and CSV."""
    return (
        content.sections
        if isinstance(content, doc.Document)
        else printed(chapters(content, of_all_drives=True), media, of_all_drives=True)
    )


def content_of(
    result: SizingResult | MachineSizing, proof: Validation | Mapping[str, Validation] | None = None
) -> MachineContent:
    """Content of a report on a sizing, with the closed loop of each axis by its name."""
    sizing = result if isinstance(result, MachineSizing) else of_one_axis(result)
    proofs = {sizing.axes[0].name: proof} if isinstance(proof, Validation) else proof
    return MachineContent(sizing, proofs or {})
