"""Catalogues at the terminal: overview, lists, comparison, a part as a data sheet, completeness, findings, imports."""

from __future__ import annotations

import textwrap
from collections import Counter
from collections.abc import Mapping, Sequence
from math import isnan
from pathlib import Path
from typing import Any

import numpy as np
from rich.console import Console
from rich.table import Table
from rich.text import Text

from drivesizer.catalog import PARTS, Catalog, columns_of, singular
from drivesizer.catalog.importing import Imported, lacking
from drivesizer.catalog.law_check import Finding
from drivesizer.catalog.parts import Column, printed
from drivesizer.catalog.query import OPTIONS, Coverage, Hit, Row, Selection, coverage, families, pairs_of
from drivesizer.catalog.tables import CONFIDENCE
from drivesizer.errors import printable
from drivesizer.output import part_curves
from drivesizer.output.document import part
from drivesizer.output.document.records import Picture, listed
from drivesizer.output.document.records import Table as Listed
from drivesizer.output.terminal.render import blocks
from drivesizer.output.terminal.tables import Axis, Series, bare, chart, console, heading, width_of
from drivesizer.output.words import figure, first_columns, number_of
from drivesizer.units import from_si, label, show

# -- Catalogues at the terminal: overview, lists of parts, comparison, search.


_BESIDE = 4  # parts side by side on 80 columns


_FEW = 5  # catalogues of which the families are named, else their makers


def overview(shelf: Mapping[str, Catalog]) -> None:
    """Print the families of each section; of many catalogues the makers."""
    out = console()
    for section, names in families(shelf).items():
        hits = [hit for some in names.values() for hit in some]
        if not hits:
            continue
        heading(out, section, f"{number_of(len(hits), 'part')} in {part.family_count(len(names))}")
        if len(shelf) > _FEW:
            counts: Mapping[str, int] = dict(Counter(hit["manufacturer"] for hit in hits).most_common())
        else:
            counts = {name: len(some) for name, some in sorted(names.items())}
        out.print(counts_text(counts, out.width))
        out.print()
    if len(shelf) > _FEW:
        out.print(Text("drivesizer catalog list --catalog maxon shows the families of one catalogue."))
    out.print(Text("drivesizer catalog list motors --family 'RE 25' lists a family, '--power >=20W' more than one."))


def counts_text(counts: Mapping[str, int], width: int, head: str = "") -> Text:
    """Names with their counts as wrapped text; no line breaks inside a name."""
    glue = "\u00a0"  # no line ends here
    items = [
        f"{name or 'no family'} ({count})".replace(" ", glue).replace("-", "\u2011") for name, count in counts.items()
    ]
    text = textwrap.fill(f"{head}{', '.join(items)}", width, break_long_words=False)
    return Text(text.replace(glue, " ").replace("\u2011", "-"))


def listing(section: str, found: Selection, limit: int, extra: Sequence[str]) -> None:
    """Print the parts of a selection, a line each."""
    out, schema = console(), columns_of(section)
    note, usual = first_columns(section)
    there = {column.name for _, column in usual} | {"part", "family", "manufacturer"}
    requested = [(name.replace("_", "\n"), schema[name]) for name in dict.fromkeys(extra) if name not in there]
    hits = found.hits[:limit]
    while len(usual) > 1 and width_of(_table(hits, usual + requested)) > out.width:
        usual.pop()  # requested columns go before the last of the usual ones
    if hits:
        out.print(_table(hits, usual + requested))
    for line in _footer(section, found, limit, note):
        out.print(Text(line))


def _table(hits: Sequence[Hit], shown: Sequence[tuple[str, Column]]) -> Table:
    heads = [(f"{head}\n{label(c.unit)}".rstrip(), "left" if c.kind == "text" else "right") for head, c in shown]
    table = bare(("part", "left"), ("family", "left"), *heads)
    table.padding = (0, 1, 0, 0)
    for hit in hits:
        mark = Text(" ×" if hit.table.excluded[hit.row] else "", style="red")
        table.add_row(Text(hit.part) + mark, Text(hit["family"]), *(_short(hit[c.name], c) for _, c in shown))
    return table


def _short(value: Any, column: Column) -> Text:
    text = figure(value, column, unit=False)
    return Text("–", style="dim") if text == "unknown" else Text(text)


def _footer(section: str, found: Selection, limit: int, note: str) -> list[str]:
    count = len(found.hits)
    more = f"the first {limit} of {count} {section}; --limit shows more" if count > limit else f"{count} {section}"
    said = [f"{more}; {note}" if count and note else more]
    if found.undecided:
        said.append(f"{found.undecided} more may fit: a required figure is unknown")
    if found.excluded:
        said.append(f"{found.excluded} more are excluded from sizing by a note; --excluded lists them (×)")
    return said


def comparison(hits: Sequence[Hit], rows: Sequence[Row]) -> None:
    """Print parts side by side; a row in which they differ is marked, ? where some are unknown."""
    blocks(console(), part.comparison(hits, rows, _BESIDE))


def searched(groups: Mapping[str, Mapping[str, Sequence[Hit]]], parts: Sequence[Hit], limit: int) -> None:
    """Print the families and parts in which a text was found."""
    out = console()
    rows = [(section, name, str(len(hits)), _kinds(hits), _catalogues(hits))
            for section, names in groups.items() for name, hits in sorted(names.items())]  # fmt: skip
    heads = (("", "left"), ("family", "left"), ("parts", "right"), ("kind", "left"), ("catalogue", "left"))
    blocks(out, [listed(heads, rows)])
    of_parts = (("", "left"), ("part", "left"), ("family", "left"), ("catalogue", "left"))
    blocks(out, [listed(of_parts, [(hit.section, hit.part, hit["family"], hit.catalogue) for hit in parts[:limit]])])
    if len(parts) > limit:
        out.print(Text(f"the first {limit} of {number_of(len(parts), 'part')}; --limit shows more"))


def _kinds(hits: Sequence[Hit]) -> str:
    column = OPTIONS["kind"][hits[0].section]
    return ", ".join(kind for kind in Counter(hit[column] for hit in hits) if kind)


def _catalogues(hits: Sequence[Hit]) -> str:
    return ", ".join(dict.fromkeys(hit.catalogue for hit in hits))


# -- One part at the terminal as a data sheet: figures, torque and speed, heat, matching parts, tolerances, sources.


_LOOKS: dict[str, dict[str, Any]] = {  # of a curve in the chart
    "line": {}, "continuous": {"gap": 2, "style": "green"}, "peak": {"gap": 4, "style": "yellow"},
    "nominal": {"mark": "●", "style": "green"},
}  # fmt: skip
_WIDEST = 160  # columns of the chart, however wide the terminal
_HEIGHT = 8  # columns of the terminal to a line of the chart's field


def page(hit: Hit, *, sources: bool = False) -> None:
    """Print one part as a data sheet."""
    out = console()
    heading(out, part.head(hit), f"{hit.part} · {singular(hit.section)} in {hit.catalogue}")
    blocks(out, [part.figures_of(hit, sources=sources)])
    for block in part.behaviour(hit):
        if isinstance(block, Picture):
            chart_of(out, hit)
        else:
            blocks(out, [block])
    out.print()
    for line, partners in part.partner_lines(hit):
        out.print(counts_text(partners, out.width, line) if partners else Text(line))
    blocks(out, part.remarks(hit, sources=sources))
    out.print()


def chart_of(out: Console, hit: Hit) -> None:
    """Print speed over torque; nothing where neither a line nor a continuous region is known."""
    if hit.section not in ("motors", "actuators"):
        return
    torque, speed = (columns_of(hit.section)[name] for name in ("nominal_torque", "no_load_speed"))
    series = [
        Series(one.name, from_si(np.asarray(one.torque), torque.unit, torque.kind).tolist(),
               from_si(np.asarray(one.speed), speed.unit, speed.kind).tolist(), **_LOOKS[one.kind])
        for one in part_curves.speed_torque(hit)
    ]  # fmt: skip
    if not series:
        return
    width = min(out.width, _WIDEST)
    level = Axis("torque", label(torque.unit), from_si(part_curves.reach_of(hit), torque.unit, torque.kind))
    upright = Axis("speed", label(speed.unit), max(y for one in series for y in one.y))
    out.print()
    out.print(*chart(series, level, upright, width, width // _HEIGHT), sep="\n")


# -- Completeness, findings and imports of catalogues.


_SHARES = [("priced", "right"), *((level, "right") for level in CONFIDENCE)]  # heads of columns
_SIDES = 5  # catalogues side by side on 80 columns


def statistics(shelf: Mapping[str, Catalog]) -> None:
    """Print the completeness of each catalogue, section by section, and the confidence of its figures."""
    out = console()
    found = {name: {s: one for s in PARTS if (one := coverage(c, s)).parts} for name, c in shelf.items()}
    by_section = {s: [one[s] for one in found.values() if s in one] for s in PARTS}
    if len(shelf) > _SIDES:
        rows = [
            (section, _number(some, "parts"), str(len(some)), *_shares(some)) for section, some in by_section.items()
        ]
        whole = []
        for name, sections in found.items():
            parts = [f"{one.parts} {s if one.parts > 1 else singular(s)}" for s, one in sections.items()]
            whole.append((name, "\n".join(parts), *_shares([*sections.values()])))
        heads = ("", "left"), ("parts", "right"), ("makers", "right"), *_SHARES
        blocks(out, [listed(heads, rows), listed((("catalogue", "left"), ("parts", "left"), *_SHARES), whole)])
        _currencies(out, by_section)
        for section, every in by_section.items():
            if every:
                _completeness(out, {"all": every}, section)
                left = Counter(name for one in every for name, some in one.silent.items() for _ in some)
                said = ", ".join(f"{name} {count}" for name, count in left.most_common())
                families = _number(every, "families")
                out.print(Text(f"of {families} families leave out decisive figures: {said}" if said else ""))
        out.print(Text("drivesizer catalog stats --catalog maxon shows one catalogue in detail"))
        return
    for name, sections in found.items():
        pairs = pairs_of(shelf[name]).items()
        heading(
            out, name, ", ".join(f"{count} combination{'s' * (count > 1)} of {what}" for what, count in pairs if count)
        )
        rows = [(section, str(one.parts), str(one.families), *_shares([one])) for section, one in sections.items()]
        blocks(out, [listed((("", "left"), ("parts", "right"), ("families", "right"), *_SHARES), rows)])
        _currencies(out, {section: [one] for section, one in sections.items()})
    for section in PARTS:
        some = {name: sections[section] for name, sections in found.items() if section in sections}
        _completeness(out, {name: [one] for name, one in some.items()}, section)
        for name, one in some.items():
            _silent(out, name, one)


def _number(some: Sequence[Coverage], name: str) -> str:
    return str(sum(getattr(one, name) for one in some))


def _shares(some: Sequence[Coverage]) -> list[str]:
    """The share of parts that have a price, and that of each confidence among all known figures."""
    counts = {level: sum(one.sure[level] for one in some) for level in CONFIDENCE}
    shares = {level: _share(count, sum(counts.values())) for level, count in counts.items()}
    if not counts["measured"]:  # of own parts alone
        shares["measured"] = ""
    return [_share(sum(one.priced for one in some), sum(one.parts for one in some)), *shares.values()]


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
    for decisive, some in one.silent.items():
        first = ", ".join(some[:_SIDES]) + (f" and {len(some) - _SIDES} more" if some[_SIDES:] else "")
        said.append(f"{decisive} ({'all families' if len(some) == one.families else first})")
    if said:
        out.print(Text(printable(f"{name}, decisive figures that families leave out: {'; '.join(said)}")))


def _completeness(out: Console, found: Mapping[str, Sequence[Coverage]], section: str) -> None:
    """Of each figure the share of parts that have it; of several catalogues together, or of each beside the others."""

    def known(column: str, some: Sequence[Coverage]) -> int:
        return sum(one.known[column] for one in some)

    columns = [column for column in printed(section) if any(known(column, some) for some in found.values())]
    for start in range(0, len(found), _SIDES):
        beside = dict(list(found.items())[start : start + _SIDES])
        rows = [(column.replace("_", " "), *(_share(known(column, some), sum(one.parts for one in some))
                                             for some in beside.values())) for column in columns]  # fmt: skip
        heads = ((section, "left"), *((name, "right") for name in beside))
        blocks(out, [listed(heads, rows, f"{section}: figures known")])
    never = [column.replace("_", " ") for column in printed(section) if column not in columns]
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
    out.print(counts_text(found.families, out.width, f"{parts} {kind} in {part.family_count(len(found.families))}: "))
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
    """Names that an import took by itself, assumed, left out and skipped, a line each."""
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
    known = [f"{name.replace('_', ' ')} {figure(table[name][0].item(), column)}"
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


def _broken(some: Sequence[Finding]) -> Listed:
    heads = (("part", "left"), ("family", "left"),
             *((head, "right") for head in ("found", "expected", "off by", "tolerance")))  # fmt: skip
    rows = []
    for one in some:
        numbers = [show(value, one.unit, one.kind) for value in (one.found, one.expected)]
        numbers[1] = f"{one.relation.removeprefix('=')} {numbers[1]}".strip()
        shares = ["" if isnan(share) else f"{100 * share:.1f} %" for share in (one.deviation, one.tolerance)]
        rows.append((one.part, one.family, *numbers, *shares))
    return listed(heads, rows)
