"""Completeness, findings and imports of catalogues at the terminal."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from math import isnan
from pathlib import Path

from rich.console import Console
from rich.text import Text

from drivesizer.catalog import PARTS, Catalog, singular
from drivesizer.catalog.importing import Imported, lacking
from drivesizer.catalog.law_check import Finding
from drivesizer.catalog.parts import printed
from drivesizer.catalog.query import Coverage, coverage, pairs_of
from drivesizer.catalog.tables import CONFIDENCE
from drivesizer.errors import printable
from drivesizer.output import words
from drivesizer.output.document.part import family_count
from drivesizer.output.document.records import Table, listed
from drivesizer.output.terminal.catalog import counts_text
from drivesizer.output.terminal.render import blocks
from drivesizer.output.terminal.tables import console, heading
from drivesizer.units import show

_LEVELS = [(level, "right") for level in CONFIDENCE]  # heads of columns
_BESIDE = 5  # catalogues side by side on 80 columns


def statistics(shelf: Mapping[str, Catalog]) -> None:
    """Print the completeness of each catalogue, section by section, and the confidence of its figures."""
    out = console()
    found = {name: {s: one for s in PARTS if (one := coverage(c, s)).parts} for name, c in shelf.items()}
    if len(shelf) > _BESIDE:
        _summary(out, found)
        for section in PARTS:
            every = [one[section] for one in found.values() if section in one]
            if every:
                _completeness(out, {"all": _together(every)}, section)
                left = Counter(figure for one in every for figure, some in one.silent.items() for _ in some)
                whole = sum(one.families for one in every)
                said = ", ".join(f"{figure} {count}" for figure, count in left.most_common())
                out.print(Text(f"of {whole} families leave out decisive figures: {said}" if said else ""))
        out.print(Text("drivesizer catalog stats --catalog maxon shows one catalogue in detail"))
        return
    for name, sections in found.items():
        pairs = pairs_of(shelf[name]).items()
        heading(
            out, name, ", ".join(f"{count} combination{'s' * (count > 1)} of {what}" for what, count in pairs if count)
        )
        rows = [(section, str(one.parts), str(one.families), _priced([one]), *_confidences([one]))
                for section, one in sections.items()]  # fmt: skip
        heads = (("", "left"), ("parts", "right"), ("families", "right"), ("priced", "right"), *_LEVELS)
        blocks(out, [listed(heads, rows)])
        _currencies(out, {section: [one] for section, one in sections.items()})
    for section in PARTS:
        some = {name: sections[section] for name, sections in found.items() if section in sections}
        _completeness(out, some, section)
        for name, one in some.items():
            _silent(out, name, one)


def _summary(out: Console, found: Mapping[str, Mapping[str, Coverage]]) -> None:
    """Many catalogues, a line each, and their sum by section."""
    rows, whole, every = [], [], dict[str, list[Coverage]]()
    for section in PARTS:
        some = [one[section] for one in found.values() if section in one]
        every[section] = some
        count = str(sum(one.parts for one in some))
        rows.append((section, count, str(len(some)), _priced(some), *_confidences(some)))
    for name, sections in found.items():
        parts = "\n".join(
            f"{one.parts} {section if one.parts > 1 else singular(section)}" for section, one in sections.items()
        )
        whole.append((name, parts, _priced(list(sections.values())), *_confidences(list(sections.values()))))
    price = ("priced", "right")
    blocks(out, [listed((("", "left"), ("parts", "right"), ("makers", "right"), price, *_LEVELS), rows),
                 listed((("catalogue", "left"), ("parts", "left"), price, *_LEVELS), whole)])  # fmt: skip
    _currencies(out, every)


def _priced(some: Sequence[Coverage]) -> str:
    """The share of parts that have a price."""
    return _share(sum(one.priced for one in some), sum(one.parts for one in some))


def _currencies(out: Console, by_section: Mapping[str, Sequence[Coverage]]) -> None:
    """The currencies of the prices, with the number of parts that have one in each."""
    said = []
    for section, some in by_section.items():
        count: Counter[str] = sum((Counter(one.prices) for one in some), Counter())
        if count:
            said.append(f"{section} {', '.join(f'{number} in {code}' for code, number in count.most_common())}")
    if said:
        out.print(Text(f"prices: {'; '.join(said)}"))


def _silent(out: Console, name: str, one: Coverage) -> None:
    """The figures that decide in a sizing and that a family gives of none of its parts."""
    said = []
    for figure, families in one.silent.items():
        some = ", ".join(families[:_BESIDE]) + (f" and {len(families) - _BESIDE} more" if families[_BESIDE:] else "")
        said.append(f"{figure} ({'all families' if len(families) == one.families else some})")
    if said:
        out.print(Text(printable(f"{name}, decisive figures that families leave out: {'; '.join(said)}")))


def _confidences(some: Sequence[Coverage]) -> list[str]:
    """The share of each confidence among all known figures."""
    counts = {level: sum(one.sure[level] for one in some) for level in CONFIDENCE}
    shares = {level: _share(counts[level], sum(counts.values())) for level in CONFIDENCE}
    if not counts["measured"]:  # of own parts alone
        shares["measured"] = ""
    return [*shares.values()]


def _together(some: Sequence[Coverage]) -> Coverage:
    """Several catalogues' parts of one kind as one."""

    def total(counts: Sequence[dict[str, int]]) -> dict[str, int]:
        return {name: sum(one[name] for one in counts) for name in counts[0]} if counts else {}

    return Coverage(
        parts=sum(one.parts for one in some), families=sum(one.families for one in some),
        excluded=sum(one.excluded for one in some), known=total([one.known for one in some]),
        sure=total([one.sure for one in some]), priced=sum(one.priced for one in some), prices={}, silent={},
    )  # fmt: skip


def _completeness(out: Console, found: Mapping[str, Coverage], section: str) -> None:
    known = [column for column in printed(section) if any(one.known[column] for one in found.values())]
    for start in range(0, len(found), _BESIDE):
        some = dict(list(found.items())[start : start + _BESIDE])
        rows = [(column.replace("_", " "), *(_share(one.known[column], one.parts) for one in some.values()))
                for column in known]  # fmt: skip
        heads = ((section, "left"), *((name, "right") for name in some))
        blocks(out, [listed(heads, rows, f"{section}: figures known")])
    never = [column.replace("_", " ") for column in printed(section) if column not in known]
    if found and never:
        out.print(Text(f"never known: {', '.join(never)}"))


def _share(count: int, total: int) -> str:
    """A share in percent that is 0 or 100 only where it is none or all.

    >>> _share(1, 646), _share(645, 646), _share(0, 646), _share(0, 0)
    ('<1 %', '>99 %', '0 %', '–')
    """
    if not total:
        return "–"
    percent = 100 * count / total
    if 0 < percent < 1 or 99 < percent < 100:
        return "<1 %" if percent < 1 else ">99 %"
    return f"{percent:.0f} %"


def imported(found: Imported, *, guessed: bool = False) -> None:
    """Print the parts and columns that an import read, those that it left out, and what a sizing still lacks."""
    out = console()
    parts = sum(found.families.values())
    kind = found.section if parts > 1 else singular(found.section)
    out.print(counts_text(found.families, out.width, f"{parts} {kind} in {family_count(len(found.families))}: "))
    rows = [
        (
            printable(head.theirs),
            head.column.replace(" ", ", "),
            head.unit if head.unit != "1" else "",
            printable(first),
        )
        for head, first in zip(found.heads, found.examples, strict=True)
        if head.column not in ("", head.theirs)
    ]
    heads = (("head", "left"), ("is", "left"), ("in", "left"), ("first", "right"))
    if rows:
        blocks(out, [listed(heads, rows, "guessed by name and unit, to be looked at" if guessed else "columns")])
    for line in (*import_words(found), *still_needed(found.catalog, found.section)):
        out.print(Text(line))


def import_words(found: Imported) -> list[str]:
    """What an import took by its own name, assumed, left out and skipped, a line each."""
    same = [head.theirs for head in found.heads if head.column == head.theirs != ""]
    left = [f"{head.theirs} ({head.lacks})" if head.lacks else head.theirs
            for head in found.heads if head.theirs and not head.column]  # fmt: skip
    said = {"columns with matching names": same, "assumed": found.assumed, "left out": left,
            "not understood, unknown now": found.cells, "columns without a value": found.empty,
            "rows skipped": found.skipped}  # fmt: skip
    return [printable(f"{what}: {'; '.join(names)}") for what, names in said.items() if names]


def added(catalog: Catalog, section: str, target: Path) -> None:
    """Print what is known of a part that was added to a catalogue file, and what a sizing still lacks."""
    table, out = catalog.table(section), console()
    confidence = catalog.confidence(section, 0)
    known = [f"{name.replace('_', ' ')} {words.figure(table[name][0].item(), column)}"
             + (" (derived)" if confidence.get(name) == "derived" else "")
             for name, column in printed(section).items() if name in confidence and column.kind != "text"]  # fmt: skip
    out.print(Text(printable(f"{singular(section)} {table['part'][0]} added to {target}: {', '.join(known)}")))
    for line in still_needed(catalog, section):
        out.print(Text(line))


def still_needed(catalog: Catalog, section: str) -> list[str]:
    """The figures that a sizing needs and parts lack, in a line; none where they lack nothing."""
    count = len(catalog.table(section))
    need = [f"{names} ({purpose}{'' if lack == count else f'; {lack} of {count}'})"
            for names, purpose, lack in lacking(catalog, section)]  # fmt: skip
    return [printable(f"a sizing still needs: {'; '.join(need)}")] if need else []


def findings(found: Sequence[Finding], *, everything: bool = False) -> None:
    """Print figures that contradict one another, by the identity that they break."""
    out = console()
    groups: dict[tuple[str, ...], list[Finding]] = {}
    for one in found:
        if one.unexplained or everything:
            groups.setdefault((one.file, one.section, one.identity, one.meaning, one.accepted), []).append(one)
    for (file, section, identity, meaning, accepted), some in groups.items():
        out.print(Text(f"{file}, {section}: {identity}", style="bold"), Text(f"  {meaning}"), sep="\n")
        if accepted:
            out.print(Text(f"  accepted: {accepted}", style="green"))
        if some[0].kind:
            blocks(out, [_broken(some)])
        else:
            out.print(Text("  " + ", ".join(one.part for one in some)))
    wrong = sum(one.unexplained for one in found)
    accepted_too = sum(bool(one.accepted) for one in found)
    said = f"{wrong} unexplained, {accepted_too} accepted, {len(found) - wrong - accepted_too} informational"
    out.print(Text(said if everything or wrong == len(found) else f"{said}; --all shows them"))


def _broken(some: Sequence[Finding]) -> Table:
    heads = (("part", "left"), ("family", "left"),
             *((head, "right") for head in ("found", "expected", "off by", "tolerance")))  # fmt: skip
    rows = []
    for one in some:
        numbers = [show(value, one.unit, one.kind) for value in (one.found, one.expected)]
        numbers[1] = f"{one.relation.removeprefix('=')} {numbers[1]}".strip()
        shares = ["" if isnan(share) else f"{100 * share:.1f} %" for share in (one.deviation, one.tolerance)]
        rows.append((one.part, one.family, *numbers, *shares))
    return listed(heads, rows)
