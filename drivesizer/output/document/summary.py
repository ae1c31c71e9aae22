"""The first pages: the outcome, the drive with its parts, where it is tight, how certain that is, what would help."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import replace
from math import isfinite, isnan
from typing import Any

from drivesizer.machine.battery import lacking, pack_of
from drivesizer.output.derivation import margin
from drivesizer.output.document import records as doc
from drivesizer.output.document import rows as tables
from drivesizer.output.document.content import Content, OfDrives, Reported, driven_over, machine_words
from drivesizer.output.parts import OWN_SUPPLY, PartLine, Total, part_figures, totals
from drivesizer.output.words import about, confidence, likely, meeting, not_quoted, number_of, reported
from drivesizer.results.check import GRAVEST, Check, sentence_case, verdict, worst
from drivesizer.results.check_kinds import CHECKS, marked_figures, missing_figures, part_of, unknown_figures
from drivesizer.results.drive_set import BrakingBudget, DriveSet, Relaxation
from drivesizer.results.sizing import SizingResult, ranked_by
from drivesizer.units import show_band

# -- The parts list of the machine: families large, order numbers small, masses and prices with their totals.


def parts_table(caption: str, lines: Sequence[tuple[PartLine, str]], totals: Sequence[Total]) -> doc.Table:
    """Parts to order with the axes that need them, and the totals of mass and price."""
    dated = (f"{x.price_date}{f' at {x.seller}' * bool(x.seller)}" for x, _ in lines if x.price_date)
    dates = ", ".join(dict.fromkeys(dated))
    remarks = [f"prices of {dates}"] if dates else []
    remarks += ["without cables, connectors and couplings"]
    remarks += ["≈ estimated"] if any(total.estimated for total in totals) else []
    single = all(line.quantity == 1 for line, _ in lines)
    price = "price" if single else "prices"
    mass, prices = (next((t for t in totals if t.name == "mass"), None), _of_all_currencies(totals))
    sums: dict[str, doc.Cell] = {"role": "total", "masses": total_of(mass) if mass else "unknown"}
    sums[price] = total_of(prices[0]) if len(prices) == 1 else (
        " + ".join(total_of(price).text for price in prices) or "unknown")  # fmt: skip
    rows = [*(_part_row(line, axes) for line, axes in lines), doc.Row(sums, name="total", total=True)]
    left_out = [key for key, out in (("axes", not any(axes for _, axes in lines)), ("prices", single)) if out]
    table = doc.table("parts", (caption, doc.Note("; ".join(remarks))), rows, without=left_out)
    columns = [replace(c, yields=c.key == "price" and not single) for c in table.columns]
    return replace(table, columns=columns)


def _of_all_currencies(totals: Sequence[Total]) -> list[Total]:
    """The totals of price, of which each lacks what has a price in no currency."""
    prices = [total for total in totals if total.name == "price"]
    return [replace(price, lacks=tuple(role for role in price.lacks if all(role in other.lacks for other in prices)))
            for price in prices]  # fmt: skip


def total_of(total: Total) -> doc.Quantity:
    """A total: at least that where something is unknown, and with a digit less where it is estimated."""
    unit, kind = ("g", "mass") if total.name == "mass" else (total.unit, "money")
    bare = doc.Quantity(total.value, unit, kind, 3 if total.estimated else 4)
    return replace(bare, own=f"≥ {bare.text}" if total.lacks else "")


def lacking_words(totals: Sequence[Total]) -> Iterator[doc.Block]:
    """The band of what is estimated in the totals, and the parts that they leave out."""
    texts, prices = [], _of_all_currencies(totals)
    for total in (*(total for total in totals if total.name != "price"), *prices[:1]):
        if total.estimated:
            texts.append(f"{total.name} {show_band(total.low, total.high, 'g', 'mass')}, by estimates")
        texts += [f"no {total.name} of {', '.join(total.lacks)}"] if total.lacks else []
    if texts:
        yield doc.Words(f"In all: {'; '.join(texts)}.", "note")


def _part_row(line: PartLine, axes: str) -> doc.Row:
    guessed = not isnan(line.mass_low)
    masses = doc.Quantity(line.quantity * line.mass, "g", "mass", 2 if guessed else 4)
    low, high = (doc.Quantity(end, "g", "mass") if guessed else "" for end in (line.mass_low, line.mass_high))
    return doc.row(
        "parts", line, name=line.role.replace(" ", "_"), axes=axes, named=named_part(line),
        quantity=doc.Quantity(line.quantity, own=f"{line.quantity} ×"), mass_low=low, mass_high=high,
        masses=replace(masses, digits=4, own=f"≈ {masses.text}") if guessed else masses,
what=line.said if line.part and not line.said.endswith(OWN_SUPPLY) else "",
    )  # fmt: skip


def named_part(line: PartLine) -> doc.Text:
    """Maker, family and ratio in large letters; below it the order number, and what the part is."""
    if not line.part:
        return line.said or "none is listed for this motor"
    maker = "" if line.maker in line.family else line.maker
    ratio = line.said.partition(",")[0] if line.role in ("gearhead", "actuator") and ":" in line.said else ""
    part = "" if line.part == line.family else f"{line.part}, "
    number = line.order_number or f"{part}no order number"
    supply = f", {line.said}" if line.said.endswith(OWN_SUPPLY) else ""
    return (
        doc.Strong(" ".join(filter(None, (maker, line.family, ratio)))),
        supply,
        doc.Small("" if number == line.family else number),
    )


# -- The answer: the outcome, the parts, the smallest margins.


OUTCOMES = {
    "found": "the selected drive",
    "unsure": "the most probable drive: below the required confidence",
    "missed": "the closest rejected drive: it fails",
}


def summary(content: Content) -> Iterator[doc.Block]:
    """The outcome, the parts to order, the smallest margins."""
    result, best = content.result, content.drive
    yield doc.Verdict(bool(result.sets), [tuple(outcome_texts(content))])
    yield _title_table(content)
    if best is None:
        return
    caption = f"Parts of {content.drives}: {OUTCOMES[content.outcome]}"
    parts = parts_table(caption, [(line, "") for line in content.bought], totals(content.bought))
    yield replace(parts, media="print", file="") if content.outcome == "missed" else parts  # it is not bought
    yield from lacking_words(totals(content.bought))
    if content.outcome == "missed":
        failed = [c for c in best.deciding if c.status == "fail"] or [c for c in best.deciding if c.status != "pass"]
        yield replace(tables.check_table("The checks that it fails", failed, "failed"), media="shown")
    else:
        count = number_of(len(best.deciding), "check")
        yield tables.tightest_table(
            (f"The smallest margins of {count}", doc.TableLink("checks", "; all are in ")), best.deciding
        )


def _title_table(content: Content) -> doc.Table:
    """The machine in a workbook, which has no title page."""
    result = content.result
    notes: dict[str, doc.Text] = {"Machine": result.spec.name, "Kind": machine_words(result.spec)}
    notes |= dict(content.title_block)
    notes |= {"Ranked by": f"{result.objective.replace('_', ' ')}, method of {result.method}"}
    notes |= {"Verdict": (doc.Status(content.status),)}
    return doc.table("notes", "Drive sizing", notes.items(), media="book", look="wide")


def outcome_texts(content: Content) -> Iterator[Any]:
    """Result of the search, and whether the closed loop passes."""
    yield from _drive_texts(content) if content.outcome != "missed" else _rejection_texts(content)
    v = content.validation
    if v:
        yield from (
            f" {v.loop.capitalize()} over {driven_over(v)}: ",
            doc.Status(v.status),
            f" {v.failed}" if v.failed else "",
        )


def _drive_texts(content: Content) -> Iterator[Any]:
    result, best, sampled, v = content.result, content.drive, content.result.uncertainty, content.validation
    assert best is not None
    counts = result.counts
    partly = 0 < counts.judged < counts.feasible
    numbers = (
        f"Of {number_of(counts.considered, 'drive')} {meeting(counts, best.status, ' of the drive' if partly else '')}"
    )
    numbers += f", {counts.judged:,} were checked in the machine" if partly else ""
    required = confidence(sampled.confidence) if sampled and sampled.confidence is not None else ""
    if content.outcome == "unsure":
        yield doc.Strong(f"No drive reaches the confidence of {required}.")
        yield f" {numbers}, at nominal figures; {best.label} is the most probable."
        return
    undecided = [check.title for check in best.deciding if check.status in ("unknown", "open")]
    but = (
        f", which fails in {v.loop}" if v and v.failed else ", with figures unknown" if best.status == "unknown" else ""
    )
    but = f", by estimates: {', '.join(undecided)}" if not but and best.status == "open" else but
    if sampled and required:
        reach = "reaches" if sampled.reached == 1 else "reach"
        numbers += f", at nominal figures; {sampled.reached} of {sampled.examined} sampled {reach} the confidence of "
        numbers += required
    yield from (doc.Status(content.status), " ", doc.Strong(f"A drive was found{but}."))
    yield f" {numbers}; {ranked_by(result.objective, result.sets[:1])}."


def _rejection_texts(content: Content) -> Iterator[Any]:
    best, counts = content.drive, content.result.counts
    yield doc.Strong("No drive meets all limits.")
    if not counts.considered:
        named = content.result.problem.spec.select.is_restricted
        left = "makers, families and parts that the spec names leave" if named else "catalogues list"
        yield f" The {left} no combination of motor and gearhead."
    elif best:
        failed = ", ".join(c.title for c in best.deciding if c.status == "fail")
        yield f" {number_of(counts.considered, 'drive')} considered. {most_fail_on(content.result)}"
        yield f" The closest rejected drive is {best.label}" + (f"; it fails on: {failed}." if failed else ".")


def glance(content: Content) -> Iterator[doc.Block]:
    """The figures that a reader wants first."""
    behaviour, best, lines = content.behaviour, content.drive, content.bought
    if behaviour is None or best is None:
        return
    several = ", as specified" if len(content.result.problem.cases) > 1 else ""
    tight, title = tables.tight_of(best, content.validation)
    yield doc.Tiles([
        ("Smallest margin", tight, title),
        summed_tile(totals(lines), "mass", content.drives),
        summed_tile(totals(lines), "price", content.drives),
        ("Energy per cycle", behaviour.cost,
         f"drawn from the supply, {content.drives}" + (", each at its wheel" if content.wheel else several)),
        ("Total ratio", f"{best.total_ratio:.4g}", f"motor turns per turn of the {content.shaft}"),
    ])  # fmt: skip


def summed_tile(totals: Sequence[Total], name: str, drives: str) -> tuple[str, str, str]:
    """A total of the parts list: its name, its value, and the parts that it leaves out or estimates."""
    sums = [total for total in totals if total.name == name]
    lacks = [role for role in sums[0].lacks if all(role in t.lacks for t in sums)] if sums else []
    least = ", at least" if lacks else ""
    notes = [f"without {', '.join(lacks)}"] if least else []
    notes += [f"estimated: {', '.join(total.estimated)}" for total in sums if total.estimated]
    value = " + ".join(total_of(total).text.removeprefix("≥ ") for total in sums) or "unknown"
    return f"{name.capitalize()} of {drives}{least}", value, "; ".join(notes)


def required(content: Content) -> Iterator[doc.Block]:
    """Requirements on the machine, and by what margin they are met."""
    if content.drive and (
        table := tables.required_table(
            "Requirements on the machine, what is reached, and by what margin", content.drive
        )
    ):
        yield table


# -- Why no drive meets all limits, and changes of the spec that would let a rejected one pass.


def most_fail_on(result: SizingResult) -> str:
    """The check that rejects most drives: of the machine where some meet their own limits; empty without any."""
    counts = result.counts
    if counts.failed_by_budget:
        name, _ = max(counts.failed_by_budget.items(), key=lambda item: item[1])
        those = "1 drive meets its" if counts.judged == 1 else f"{counts.judged:,} drives meet their"
        fails = "it fails" if counts.judged == 1 else "they fail"
        return f"{those} own limits; in the machine {fails} on {sentence_case(CHECKS['budget'][name].title)}."
    if not counts.failed_by:
        return ""
    name, count = max(counts.failed_by.items(), key=lambda item: item[1])
    title = sentence_case(CHECKS[result.method][name].title)
    return f"Most frequent failure: {title}, in {count:,} of {number_of(counts.considered, 'drive')}."


def not_enough(result: SizingResult) -> str:
    """The figures of the spec of which none, moved alone, lets a drive pass; first what is not known of any drive."""
    if undecided := _undecided(result):
        return undecided
    if not result.tried:
        return "The spec has no single figure whose change was tried."
    return f"None of these figures is enough, changed alone by up to a factor of 20: {', '.join(result.tried)}."


def changes_by_outcome(changes: Sequence[Relaxation], of: str) -> Iterator[tuple[str, list[Relaxation]]]:
    """Changes of a spec after which a drive passes, then those after which it fails nothing and figures are missing."""
    passing = [change for change in changes if change.status == "pass"]
    rest = [change for change in changes if change.status != "pass"]
    if passing:
        yield f"Any one of these changes alone would let {of} pass:", passing
    if rest:
        yield f"Any one of these changes alone would leave no check of {of} failing, figures missing:", rest


_OF_THE_BATTERY = {  # figures that its limits need, where the drive gives and takes what it may
    "continuous_current", "peak_current", "max_charge_current", "charge_voltage", "cutoff_voltage", "resistance",
    "open_circuit",
}  # fmt: skip


def _undecided(result: SizingResult) -> str:
    """Unknown figures that leave drives out where the spec rejects such: the battery's first, then the drives'."""
    spec, left_out = result.spec, result.counts.left_out
    if spec.select.unknown != "reject":
        return ""
    battery, texts = spec.battery, list[str]()
    if battery is not None and battery.part is None:
        lacking = [f"battery.{name}" for name in type(battery).model_fields if name in _OF_THE_BATTERY]
        lacking = [name for name in lacking if getattr(battery, name.removeprefix("battery.")) is None]
        if lacking:
            texts.append(f"The battery is not wholly known, so no drive is: give {', '.join(lacking)}.")
    texts += _of_the_machine(result)
    if left_out:
        fail = "1 drive fails nothing" if left_out == 1 else f"{left_out:,} drives fail nothing"
        texts.append(f"{fail}, but figures are missing: select: {{unknown: allow}} shows which.")
    return " ".join(texts)


def _of_the_machine(result: SizingResult) -> Iterator[str]:
    """Unknown checks of the machine that reject its best drives, where none of theirs fails."""
    closest = next(iter(result.misses), None)
    if closest is None or any(check.status == "fail" for check in closest.deciding):
        return
    unknown = [check for check in closest.budget if check.status == "unknown" and part_of(check.name) != "Battery"]
    if unknown:
        titles = "; ".join(check.title + (f" ({check.note})" if check.note else "") for check in unknown)
        yield f"Unknown of {closest.label} in the machine: {titles}."


def changes(content: Content) -> Iterator[doc.Block]:
    """Changes of the spec after which a drive passes, where none does, and those after which the closest one does."""
    result = content.result
    if content.outcome != "missed":
        return
    if result.relaxations:
        yield tables.changes_table("Changes after which a drive passes, one figure at a time", result.relaxations)
    elif result.counts.considered:
        yield doc.Words(not_enough(result))
    if content.drive and content.drive.changes:
        yield tables.changes_table(
            "Changes after which the closest rejected drive passes, one figure at a time", content.drive.changes
        )


# -- Confidence in the verdict: checks by status, estimated figures, tolerances and the closed loop.


def grounds(content: Content) -> Iterator[doc.Block]:
    """Grounds of the verdict: checks by status, estimates, tolerances, the closed loop."""
    if content.drive:
        number = Counter(check.status for check in content.drive.deciding)
        share = f"{number['pass']} of {number_of(len(content.drive.deciding), 'check')} pass"
        rows = _grounds(content, content.drive)
        yield doc.table("notes", f"Confidence in the verdict: {share}", rows, name="confidence")


def _grounds(content: Content, best: DriveSet) -> Iterator[tuple[str, doc.Text]]:
    result = content.result
    for status in GRAVEST[:-1]:
        checks = [check for check in best.deciding if check.status == status]
        if checks:
            yield status, ((doc.Status(status), " ", _decided_by(checks, best, content)))
    if missing := missing_figures(best):
        yield "missing", ", ".join(missing)
    if best.estimated:
        hanging = any(check.status == "open" for check in best.deciding)
        remark = "they decide the open checks" if hanging else "no check turns within their bands"
        yield "estimated figures", f"{', '.join(estimate.title for estimate in best.estimated)}; {remark}"
    counts = {role: Counter(not_quoted(part, role, best, result.catalog).values())
              for role, part in best.parts.items() if part is not None}  # fmt: skip
    doubts = [
        f"{role} {', '.join(f'{n} {level}' for level, n in levels.items())}"
        for role, levels in counts.items()
        if levels
    ]
    if doubts:
        yield "not quoted", f"{'; '.join(doubts)}: to be confirmed"
    sampled_drive = reported(result)
    if result.uncertainty and sampled_drive and sampled_drive.reliability:
        reliability = sampled_drive.reliability
        claim = "no check fails" if reliability.unknown else "all checks pass"
        count = "1 check is" if len(reliability.unknown) == 1 else f"{len(reliability.unknown)} checks are"
        unknown = f"; {count} unknown: {'; '.join(reliability.unknown)}" if reliability.unknown else ""
        yield "tolerances", (f"{claim} with a probability of {likely(reliability.probability)} "
                             f"± {100 * reliability.error:.2g} %; "
                             f"weakest check: {reliability.weakest}{unknown}")  # fmt: skip
    if result.method == "paper" and best.beside:
        status = verdict(best.beside)
        which = ", ".join(check.title for check in best.beside if check.status == status != "pass")
        yield (
            "by physics",
            ("ranked by the paper's equations and rule; by physics ", doc.Status(status), f" {which}".rstrip()),
        )
    v = content.validation
    if v is not None:
        tight, unknown = worst(v.checks), ", ".join(c.title for c in v.checks if c.status == "unknown" and not c.advice)
        smallest = f" smallest margin {margin(tight.margin)}, {tight.title}" if tight else ""
        yield (
            v.loop,
            (doc.Status(v.status), f"{smallest}{f'; unknown: {unknown}' if unknown else ''}; over {driven_over(v)}"),
        )


def _decided_by(checks: Sequence[Check], best: DriveSet, content: Content) -> str:
    """Checks by their titles, with what would decide them; those of the battery in one, with the fields that do."""
    battery, texts = content.result.problem.spec.battery, []
    of_battery = [check for check in checks if check.status == "unknown" and part_of(check.name) == "Battery"]
    if battery and len(of_battery) > 1:
        fields = ", ".join(lacking(pack_of(battery, content.result.catalog)))
        texts.append(
            f"{len(of_battery)} checks of the battery" + (f"; the spec's battery gives no {fields}" if fields else "")
        )
        checks = [check for check in checks if check not in of_battery]
    for check in checks:
        if check.status == "open":
            texts.append(
                f"{check.title} {check.note}" + (f" ({about(check.probability)})" if about(check.probability) else "")
            )
        elif check.name == "bus_voltage" and check.note and best.braking and check.status == "unknown":
            texts.append(f"{check.title}; decided by {_deciding(best.braking)}")
        elif (check.name, check.method) == ("price", "budget"):
            texts.append(f"{check.title} ({check.note})")
        else:
            texts.append(check.title)
    return "; ".join(texts)


def _deciding(braking: BrakingBudget) -> str:
    """Fields of a spec that decide whether the bus holds, with what they would have to be."""
    needed = next(figure for figure in braking.figures if figure.name == "capacitance_needed")
    least = f" of {needed.text} or more" if isfinite(needed.value) else ""
    return f"brake_resistor: any, supply.capacitance{least}, or supply.accepts: all of a battery"


# -- The reported drive part by part, its checks, estimated figures, and the same drive by the other method.


def drive(of: OfDrives, drive: DriveSet) -> Iterator[doc.Block]:
    """A drive part by part; for other programs its ratios, mass and price."""
    yield doc.Words((f"{drive.label}: ", doc.Status(drive.status)), media="paper")
    rows: list[tuple[doc.Cell, ...]] = []
    for role, part in drive.parts.items():
        if part is None:
            why = drive.without_controller if role == "controller" else ""
            rows.append((role, "unknown", why or "none is listed for this motor"))
        else:
            name, number, figures, doubt = part_figures(role, part, of.catalog, drive)
            note: doc.Text = (figures, doc.Small(doubt)) if doubt else figures
            rows.append((role, (doc.Strong(name), doc.Small(number)), note))
    if "gearhead" not in drive.parts and "motor" in drive.parts:
        rows.insert(1, ("gearhead", "none", "the motor drives the load itself"))
    if drive.belt_ratio != 1.0 and not drive.belt_drive:
        efficient = doc.Quantity(drive.belt_efficiency, "%", "dimensionless").text
        place = 1 + next((n for n, (role, *_) in enumerate(rows) if role in ("gearhead", "actuator")), 0)
        rows.insert(place, ("belt", f"{drive.belt_ratio:g}", f"{efficient} efficient"))
    yield doc.table("drive", "", rows)
    yield _identity(drive)
    if any(r.declared for r in drive.requirements):
        yield tables.requirements_table(f"At the motor, for {drive.label}", drive.requirements, media="wide")


def _identity(s: DriveSet) -> doc.Table:
    """A drive for other programs: its parts, ratios, mass, price, objective and verdict."""
    parts = {name: getattr(s, name) for name in ("motor", "gearhead", "encoder", "controller")}
    parts |= {"brake": s.brake} if s.brake else {}
    parts |= s.belt_drive.parts if s.belt_drive else {}
    parts |= {"screw": s.chosen_screw.screw} if s.chosen_screw else {}
    rows = [
        doc.Row({"title": f"{part.manufacturer} {part.family}", "value": part.part, "status": ""} if part
                else {"title": "", "value": "", "status": (doc.Status("unknown"),)}, name=role.replace(" ", "_"))
        for role, part in parts.items()
    ]  # fmt: skip
    guessed = f"; estimated: {', '.join(s.mass_estimated)}" if s.mass_estimated else ""
    notes = {"mass": f"sum of {', '.join(s.mass_of)}{guessed}", "objective": f"of {', '.join(s.objective_of)}",
             "price": f"sum of {', '.join(s.price_of)}" if s.price_of else ""}  # fmt: skip
    for name, title, figure, unit, kind in doc.texts("identity"):
        if (value := doc.attribute(s, figure)) is not None:
            quantity = doc.Quantity(value, unit or s.currency, kind)
            rows.append(doc.Row({"title": title, "value": quantity, "note": notes.get(name, "")}, name=name))
    rows.append(doc.Row({"title": "All checks", "status": (doc.Status(s.status),)}, name="verdict"))
    return doc.table("identity", "Parts, ratios, mass and price", rows)


def checks(of: OfDrives, drive: DriveSet) -> Iterator[doc.Block]:
    """Every check under the part that it concerns."""
    worst = of.of_machine(
        "; each at its worst wheel", "; each in its worst load case, the one as specified where none is named"
    )
    yield tables.check_table(
        (f"All checks of {drive.label}{worst}",
         doc.Note(doc.sentence("bars"))),
        drive.checks, "checks", grouped=True,
    )  # fmt: skip


def estimates(_: OfDrives, drive: DriveSet) -> Iterator[doc.Block]:
    """Figures that no data sheet gives, with their bands, and the checks that hang on them."""
    if not drive.estimated:
        return
    yield doc.Words(doc.sentence("estimates"), "note")
    rows = [doc.row("estimates", estimate, name=f"{estimate.part}_{estimate.figure}",
                    note=estimate.law.removeprefix("; "))
            for estimate in drive.estimated]  # fmt: skip
    yield doc.table("estimates", "Estimates and their bands", rows)
    hanging = [check for check in drive.own_checks if check.status == "open"]
    if hanging:
        yield doc.table("open", "Open checks", [(c.title, about(c.probability), c.note) for c in hanging])


def physics(_: OfDrives, drive: DriveSet) -> Iterator[doc.Block]:
    """The drive by the other method; on paper only where the method of the paper ranked."""
    if not drive.beside:
        return
    by_paper = drive.checks[0].method == "paper"
    other = "physics: the whole load cycle, no factors of the paper" if by_paper else "the paper's equations and rule"
    media: doc.Media = "all" if by_paper else "listed"
    if by_paper:
        yield doc.Words(doc.sentence("by_paper"))
    checks = tables.check_table(f"The same drive by {other}", drive.beside, "beside", grouped=True)
    yield replace(checks, media=media)
    rows = [
        doc.row("methods", pair, name=pair.paper.name,
                paper=doc.Quantity(pair.paper.demand, pair.paper.unit, pair.paper.kind),
                physics=doc.Quantity(pair.physics.demand, pair.physics.unit, pair.physics.kind))
        for pair in drive.comparison
    ]  # fmt: skip
    if rows:
        yield doc.table("methods", "Both methods where they check the same limit", rows, media=media)


# -- Assumptions and warnings, and the figures that are unknown or not from a document.


def assumptions(content: Reported) -> Iterator[doc.Block]:
    """Assumptions, warnings, and figures to be confirmed."""
    contents = content.contents
    for intro, look, name in (("Assumptions of the sizing:", "", "assumptions"), ("Warnings:", "alarm", "warnings")):
        axes: dict[str, list[str]] = {}  # those of all axes once, those of some with their names
        for axis, axis_content in contents.items():
            for text in getattr(axis_content.result, name):
                axes.setdefault(text, []).append(axis)
        texts = [f"{', '.join(names)}: {text}" if len(names) < len(contents) else text for text, names in axes.items()]
        if texts:
            yield doc.Bullets((doc.Strong(intro),) if look else intro, texts, look)
    if isinstance(content, Content):
        yield from unknown_blocks(content)


def unknown_blocks(content: Content) -> Iterator[doc.Block]:
    """Checks that are unknown, and figures behind checks that are from no document."""
    best = content.drive
    if best is None:
        return
    unknown = unknown_figures(best)
    yield doc.table("unknown", f"Unknown checks{', and the figures that they lack' if unknown else ': none'}", unknown)
    marked = [(name, value, (doc.Mark(mark),), checks) for name, value, mark, checks in marked_figures(best)]
    if marked:
        yield doc.table("marked", doc.sentence("to_confirm"), marked)
    else:
        yield doc.Words("No check rests on a figure that is derived, recalled or estimated.")
