"""Catalogues as documents: families, lists of parts, a data sheet, parts side by side, figures known, faults."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from math import isnan
from pathlib import Path

from drivesizer.catalog import PARTS, Catalog, columns_of, singular
from drivesizer.catalog.importing import Imported, lacking
from drivesizer.catalog.laws import Finding
from drivesizer.catalog.parts import printed
from drivesizer.catalog.query import OPTIONS, Coverage, Hit, Row, Selection, coverage, families, pairs_of
from drivesizer.catalog.tables import CONFIDENCE
from drivesizer.errors import printable
from drivesizer.output.document import part
from drivesizer.output.document import records as doc
from drivesizer.output.words import figure, first_columns, number_of
from drivesizer.units import label, show

_BESIDE = 4  # parts side by side on 80 columns or a page
_FEW = 5  # catalogues of which the families are named, else their makers; or beside one another
_APART = doc.Words("", media="terminal")  # an empty line


def _document(name: str, subject: str, blocks: Iterator[doc.Block]) -> doc.Document:
    sections = [doc.section("parts", subject.capitalize(), blocks)]
    return doc.Document(name=name, subject=subject, headed=False, sections=sections)


# -- overview, lists, search


def overview(shelf: Mapping[str, Catalog]) -> doc.Document:
    """The families of each section; of many catalogues the makers."""
    return _document("Catalogues", "families", _overview(shelf))


def _overview(shelf: Mapping[str, Catalog]) -> Iterator[doc.Block]:
    for section, names in families(shelf).items():
        hits = [hit for some in names.values() for hit in some]
        if not hits:
            continue
        yield doc.Heading(
            section, note=f"{number_of(len(hits), 'part')} in {number_of(len(names), 'family', 'families')}"
        )
        if len(shelf) > _FEW:
            counts: Mapping[str, int] = dict(Counter(hit["manufacturer"] for hit in hits).most_common())
        else:
            counts = {name: len(some) for name, some in sorted(names.items())}
        yield counts_words(counts)
        yield _APART
    if len(shelf) > _FEW:
        yield doc.Words("drivesizer catalog list --catalog maxon shows the families of one catalogue.")
    yield doc.Words("drivesizer catalog list motors --family 'RE 25' lists a family, '--power >=20W' more than one.")


def counts_words(counts: Mapping[str, int], head: str = "") -> doc.Words:
    """Names with their counts."""
    return doc.Words(head + ", ".join(f"{name or 'no family'} ({n})" for name, n in counts.items()), "names")


def listing(found: Mapping[str, Selection], limit: int, named: Sequence[str]) -> doc.Document:
    """The parts of selections by their sections, a line each; with the columns that conditions name."""
    every = (block for section, some in found.items() for block in _list(section, some, limit, named))
    return _document("Parts", "list of parts", every)


def _list(section: str, found: Selection, limit: int, named: Sequence[str]) -> Iterator[doc.Block]:
    note, _ = first_columns(section)
    yield listed(section, found.hits[:limit], named)
    count = len(found.hits)
    more = f"the first {limit} of {count} {section}; --limit shows more" if count > limit else f"{count} {section}"
    yield doc.Words(f"{more}; {note}" if count and note else more)
    if found.undecided:
        yield doc.Words(f"{found.undecided} more may fit: a required figure is unknown")
    if found.excluded:
        yield doc.Words(f"{found.excluded} more are excluded from sizing by a note; --excluded lists them (×)")


def listed(section: str, hits: Sequence[Hit], named: Sequence[str], *, makers: bool = False) -> doc.Table:
    """Parts, a line each, with the columns that conditions name; perhaps with their makers."""
    schema, (_, usual) = columns_of(section), first_columns(section)
    there = {column.name for _, column in usual} | {"part", "family", "manufacturer"}
    wanted = [(name.replace("_", "\n"), schema[name]) for name in dict.fromkeys(named) if name in schema.keys() - there]
    columns = [doc.Column("part", "part", "name"), doc.Column("family", "family")]
    columns += [doc.Column("manufacturer", "maker")] if makers else []
    for place, (head, one) in enumerate([*usual, *wanted]):  # requested columns go before the last of the usual ones
        form = "text" if one.kind == "text" else "number"
        columns.append(doc.Column(one.name, f"{head}\n{label(one.unit)}".rstrip(), form, yields=0 < place < len(usual)))
    rows = []
    for hit in hits:
        cells = {one.name: part.cell(hit[one.name], one, unit=False) for _, one in (*usual, *wanted)}
        mark = doc.Mark(" ×" if hit.table.excluded[hit.row] else "")
        names = {name: str(hit[name]) for name in ("family", "manufacturer")}
        rows.append(doc.Row({"part": (hit.part, mark), **names, **cells}))
    return doc.Table("", columns, rows, look="listing", dense=True)


def searched(
    groups: Mapping[str, Mapping[str, Sequence[Hit]]], parts: Sequence[Hit], limit: int
) -> Iterator[doc.Block]:
    """The families and parts in which a text was found."""
    rows = []
    for section, names in groups.items():
        for name, hits in sorted(names.items()):
            kinds = Counter(hit[OPTIONS["kind"][section]] for hit in hits)
            makers = dict.fromkeys(hit.catalogue for hit in hits)
            rows.append((section, name, doc.Quantity(len(hits), own=str(len(hits))), ", ".join(filter(None, kinds)),
                         ", ".join(makers)))  # fmt: skip
    yield doc.table("families_found", "", rows)
    yield doc.table("parts_found", "",
                    [(hit.section, hit.part, hit["family"], hit.catalogue) for hit in parts[:limit]])  # fmt: skip
    if len(parts) > limit:
        yield doc.Words(f"the first {limit} of {number_of(len(parts), 'part')}; --limit shows more")


# -- one part as a data sheet, several side by side


def page(hit: Hit, *, sources: bool = False) -> doc.Document:
    """One part as a data sheet: figures, curves, what goes with it, tolerances, sources."""
    from drivesizer.output.report.figures.parts import part_plots
    from drivesizer.output.report.figures.picture import Pictured, on_paper

    plots = {f"part-{name}": plot for name, plot in part_plots(hit).items()}

    def blocks() -> Iterator[doc.Block]:
        yield part.figures_of(hit, sources=sources)
        for block in part.behaviour(hit):
            if isinstance(block, doc.Picture) and block.name in plots:
                block = replace(block, caption=plots[block.name].title)
            yield block
        yield _APART
        for line, partners in part.partner_lines(hit):
            yield counts_words(partners, line)
        yield from part.remarks(hit, sources=sources)
        yield _APART

    return doc.Document(
        name=part.head(hit), machine=f"{hit.part} · {singular(hit.section)} in {hit.catalogue}", subject="data sheet",
        sections=[doc.section("part", "Data sheet", blocks())],
        pictures={name: Pictured(on_paper(plot), [plot.titled("")]) for name, plot in plots.items()},
    )  # fmt: skip


def comparison(hits: Sequence[Hit], rows: Sequence[Row]) -> doc.Document:
    """Parts side by side; a row in which they differ is marked, ? where some are unknown."""
    return _document(" and ".join(hit.part for hit in hits), "parts side by side", part.comparison(hits, rows, _BESIDE))


# -- completeness of catalogues


_SHARES = [doc.Column(name, name, "number") for name in ("priced", *CONFIDENCE)]


def statistics(shelf: Mapping[str, Catalog]) -> doc.Document:
    """The completeness of each catalogue, section by section, and the confidence of its figures."""
    found = {name: {s: one for s in PARTS if (one := coverage(c, s)).parts} for name, c in shelf.items()}
    blocks = _of_many(found) if len(shelf) > _FEW else _of_few(found, {n: pairs_of(c) for n, c in shelf.items()})
    return _document("Catalogues", "figures known", blocks)


def _of_many(found: Mapping[str, Mapping[str, Coverage]]) -> Iterator[doc.Block]:
    by_section = {s: [one[s] for one in found.values() if s in one] for s in PARTS}
    rows = [(section, _number(some, "parts"), str(len(some)), *_shares(some)) for section, some in by_section.items()]
    yield doc.table("coverage", "", rows, more=[doc.Column("makers", "makers", "number"), *_SHARES])
    whole = []
    for name, sections in found.items():
        parts = [f"{one.parts} {s if one.parts > 1 else singular(s)}" for s, one in sections.items()]
        whole.append((name, "\n".join(parts), *_shares([*sections.values()])))
    yield doc.table("coverage", "", whole, heads={"title": "catalogue"}, without=["number"],
                    more=[doc.Column("parts", "parts"), *_SHARES])  # fmt: skip
    yield from _currencies(by_section)
    for section, every in by_section.items():
        if every:
            yield from _completeness({"all": every}, section)
            left = Counter(name for one in every for name, some in one.silent.items() for _ in some)
            said = ", ".join(f"{name} {count}" for name, count in left.most_common())
            if said:
                yield doc.Words(f"of {_number(every, 'families')} families leave out decisive figures: {said}")
    yield doc.Words("drivesizer catalog stats --catalog maxon shows one catalogue in detail")


def _of_few(found: Mapping[str, Mapping[str, Coverage]], pairs: Mapping[str, Mapping[str, int]]) -> Iterator[doc.Block]:
    for name, sections in found.items():
        fits = ", ".join(f"{count} combination{'s' * (count > 1)} of {what}"
                         for what, count in pairs[name].items() if count)  # fmt: skip
        yield doc.Heading(name, note=fits)
        rows = [(section, str(one.parts), str(one.families), *_shares([one])) for section, one in sections.items()]
        yield doc.table("coverage", "", rows, more=[doc.Column("families", "families", "number"), *_SHARES])
        yield from _currencies({section: [one] for section, one in sections.items()})
    for section in PARTS:
        some = {name: sections[section] for name, sections in found.items() if section in sections}
        yield from _completeness({name: [one] for name, one in some.items()}, section)
        for name, one in some.items():
            said = []
            for decisive, left in one.silent.items():
                first = ", ".join(left[:_FEW]) + (f" and {len(left) - _FEW} more" if left[_FEW:] else "")
                said.append(f"{decisive} ({'all families' if len(left) == one.families else first})")
            if said:
                words = f"{name}, decisive figures that families leave out: {'; '.join(said)}"
                yield doc.Words(printable(words))


def _number(some: Sequence[Coverage], name: str) -> str:
    return str(sum(getattr(one, name) for one in some))


def _shares(some: Sequence[Coverage]) -> list[str]:
    """The share of parts that have a price, and that of each confidence among all known figures."""
    counts = {level: sum(one.sure[level] for one in some) for level in CONFIDENCE}
    shares = {level: _share(count, sum(counts.values())) for level, count in counts.items()}
    if not counts["measured"]:  # of own parts alone
        shares["measured"] = ""
    return [_share(sum(one.priced for one in some), sum(one.parts for one in some)), *shares.values()]


def _currencies(by_section: Mapping[str, Sequence[Coverage]]) -> Iterator[doc.Block]:
    """The currencies of the prices, with the number of parts that have one in each."""
    said = []
    for section, some in by_section.items():
        count: Counter[str] = sum((Counter(one.prices) for one in some), Counter())
        if count:
            said.append(f"{section} {', '.join(f'{number} in {code}' for code, number in count.most_common())}")
    if said:
        yield doc.Words(f"prices: {'; '.join(said)}")


def _completeness(found: Mapping[str, Sequence[Coverage]], section: str) -> Iterator[doc.Block]:
    """Of each figure the share of parts that have it; of several catalogues together, or of each beside the others."""

    def known(column: str, some: Sequence[Coverage]) -> int:
        return sum(one.known[column] for one in some)

    columns = [column for column in printed(section) if any(known(column, some) for some in found.values())]
    for start in range(0, len(found), _FEW):
        beside = dict(list(found.items())[start : start + _FEW])
        rows = [(column.replace("_", " "), *(_share(known(column, some), sum(one.parts for one in some))
                                             for some in beside.values())) for column in columns]  # fmt: skip
        yield doc.table("across", f"{section}: figures known", rows, heads={"title": section},
                        more=[doc.Column(name, name, "number") for name in beside])  # fmt: skip
    never = [column.replace("_", " ") for column in printed(section) if column not in columns]
    if found and never:
        yield doc.Words(f"never known: {', '.join(never)}")


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


# -- imports, and figures that contradict one another


def imported(found: Imported, *, guessed: bool = False) -> Iterator[doc.Block]:
    """The parts and columns that an import read, those that it left out, and what a sizing still lacks."""
    parts = sum(found.families.values())
    kind = found.section if parts > 1 else singular(found.section)
    count = number_of(len(found.families), "family", "families")
    yield counts_words(found.families, f"{parts} {kind} in {count}: ")
    rows = [
        (printable(head.theirs), head.column.replace(" ", ", "), head.unit if head.unit != "1" else "",
         printable(first))
        for head, first in zip(found.heads, found.examples, strict=True) if head.column not in ("", head.theirs)
    ]  # fmt: skip
    yield doc.table("read_columns", "guessed by name and unit, to be looked at" if guessed else "columns", rows)
    yield from map(doc.Words, (*import_words(found), *still_needed(found.catalog, found.section)))


def import_words(found: Imported) -> list[str]:
    """Names that an import took by itself, assumed, left out and skipped, a line each."""
    same = [head.theirs for head in found.heads if head.column == head.theirs != ""]
    left = [f"{head.theirs} ({head.lacks})" if head.lacks else head.theirs
            for head in found.heads if head.theirs and not head.column]  # fmt: skip
    said = {"columns with matching names": same, "assumed": found.assumed, "left out": left,
            "not understood, unknown now": found.cells, "columns without a value": found.empty,
            "rows skipped": found.skipped}  # fmt: skip
    return [printable(f"{what}: {'; '.join(names)}") for what, names in said.items() if names]


def added(catalog: Catalog, section: str, target: Path) -> Iterator[doc.Block]:
    """The known figures of a part that was added to a catalogue file, and those that a sizing still lacks."""
    table, confidence = catalog.table(section), catalog.confidence(section, 0)
    known = [f"{name.replace('_', ' ')} {figure(table[name][0].item(), column)}"
             + (" (derived)" if confidence.get(name) == "derived" else "")
             for name, column in printed(section).items() if name in confidence and column.kind != "text"]  # fmt: skip
    yield doc.Words(printable(f"{singular(section)} {table['part'][0]} added to {target}: {', '.join(known)}"))
    yield from map(doc.Words, still_needed(catalog, section))


def still_needed(catalog: Catalog, section: str) -> list[str]:
    """The figures that a sizing needs and parts lack, in a line; none where they lack nothing."""
    count = len(catalog.table(section))
    need = [f"{names} ({purpose}{'' if lack == count else f'; {lack} of {count}'})"
            for names, purpose, lack in lacking(catalog, section)]  # fmt: skip
    return [printable(f"a sizing still needs: {'; '.join(need)}")] if need else []


def findings(found: Sequence[Finding], *, everything: bool = False) -> Iterator[doc.Block]:
    """Figures that contradict one another, by the identity that they break."""
    groups: dict[tuple[str, ...], list[Finding]] = {}
    for one in found:
        if one.unexplained or everything:
            groups.setdefault((one.file, one.section, one.identity, one.meaning, one.accepted), []).append(one)
    for (file, section, identity, meaning, accepted), some in groups.items():
        yield doc.Words((doc.Strong(f"{file}, {section}: {identity}"),))
        yield doc.Words(f"  {meaning}")
        if accepted:
            yield doc.Words(f"  accepted: {accepted}")
        if some[0].kind:
            yield doc.table("broken", "", map(_broken, some))
        else:
            yield doc.Words("  " + ", ".join(one.part for one in some))
    wrong = sum(one.unexplained for one in found)
    accepted_too = sum(bool(one.accepted) for one in found)
    said = f"{wrong} unexplained, {accepted_too} accepted, {len(found) - wrong - accepted_too} informational"
    yield doc.Words(said if everything or wrong == len(found) else f"{said}; --all shows them")


def _broken(one: Finding) -> tuple[str, ...]:
    value, expected = (show(x, one.unit, one.kind) for x in (one.found, one.expected))
    shares = ("" if isnan(share) else f"{100 * share:.1f} %" for share in (one.deviation, one.tolerance))
    return one.part, one.family, value, f"{one.relation.removeprefix('=')} {expected}".strip(), *shares
