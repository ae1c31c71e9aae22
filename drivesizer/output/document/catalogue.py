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
from drivesizer.catalog.query import OPTIONS, Coverage, PartRow, Row, Selection, coverage, families, pairs_of
from drivesizer.catalog.tables import CONFIDENCE
from drivesizer.errors import printable
from drivesizer.output.document import part
from drivesizer.output.document import records as doc
from drivesizer.output.words import figure, first_columns, number_of
from drivesizer.units import label, show

_PARTS_A_TABLE = 4  # parts side by side on 80 columns or a page
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
        hits = [hit for group in names.values() for hit in group]
        if not hits:
            continue
        yield doc.Heading(
            section, note=f"{number_of(len(hits), 'part')} in {number_of(len(names), 'family', 'families')}"
        )
        if len(shelf) > _FEW:
            counts: Mapping[str, int] = dict(Counter(hit["manufacturer"] for hit in hits).most_common())
        else:
            counts = {name: len(group) for name, group in sorted(names.items())}
        yield counts_words(counts)
        yield _APART
    if len(shelf) > _FEW:
        yield doc.Words("drivesizer catalog list --catalog maxon shows the families of one catalogue.")
    yield doc.Words("drivesizer catalog list motors --family 'RE 25' lists a family, '--power >=20W' more than one.")


def counts_words(counts: Mapping[str, int], head: str = "") -> doc.Words:
    """Names with their counts."""
    return doc.Words(head + ", ".join(f"{name or 'no family'} ({n})" for name, n in counts.items()), "names")


def listing(selections: Mapping[str, Selection], limit: int, named: Sequence[str]) -> doc.Document:
    """The parts of selections by their sections, a line each; with the columns that conditions name."""
    blocks = (block for section, selection in selections.items() for block in _list(section, selection, limit, named))
    return _document("Parts", "list of parts", blocks)


def _list(section: str, selection: Selection, limit: int, named: Sequence[str]) -> Iterator[doc.Block]:
    note, _ = first_columns(section)
    yield listed(section, selection.hits[:limit], named)
    count = len(selection.hits)
    more = f"the first {limit} of {count} {section}; --limit shows more" if count > limit else f"{count} {section}"
    yield doc.Words(f"{more}; {note}" if count and note else more)
    if selection.undecided:
        yield doc.Words(f"{selection.undecided} more may fit: a required figure is unknown")
    if selection.excluded:
        yield doc.Words(f"{selection.excluded} more are excluded from sizing by a note; --excluded lists them (×)")


def listed(section: str, hits: Sequence[PartRow], named: Sequence[str], *, makers: bool = False) -> doc.Table:
    """Parts, a line each, with the columns that conditions name; perhaps with their makers."""
    schema, (_, usual) = columns_of(section), first_columns(section)
    there = {column.name for _, column in usual} | {"part", "family", "manufacturer"}
    extra = [(name.replace("_", "\n"), schema[name]) for name in dict.fromkeys(named) if name in schema.keys() - there]
    columns = [doc.Column("part", "part", "name"), doc.Column("family", "family")]
    columns += [doc.Column("manufacturer", "maker")] if makers else []
    for place, (head, column) in enumerate([*usual, *extra]):  # requested columns go before the last of the usual ones
        form = "text" if column.kind == "text" else "number"
        columns.append(
            doc.Column(column.name, f"{head}\n{label(column.unit)}".rstrip(), form, yields=0 < place < len(usual))
        )
    rows = []
    for hit in hits:
        cells = {column.name: part.cell(hit[column.name], column, unit=False) for _, column in (*usual, *extra)}
        mark = doc.Mark(" ×" if hit.table.excluded[hit.row] else "")
        names = {name: str(hit[name]) for name in ("family", "manufacturer")}
        rows.append(doc.Row({"part": (hit.part, mark), **names, **cells}))
    return doc.Table("", columns, rows, look="listing", dense=True)


def searched(
    groups: Mapping[str, Mapping[str, Sequence[PartRow]]], parts: Sequence[PartRow], limit: int
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


def page(hit: PartRow, *, sources: bool = False) -> doc.Document:
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


def comparison(hits: Sequence[PartRow], rows: Sequence[Row]) -> doc.Document:
    """Parts side by side; a row in which they differ is marked, ? where some are unknown."""
    return _document(
        " and ".join(hit.part for hit in hits), "parts side by side", part.comparison(hits, rows, _PARTS_A_TABLE)
    )


# -- completeness of catalogues


_SHARES = [doc.Column(name, name, "number") for name in ("priced", *CONFIDENCE)]


def statistics(shelf: Mapping[str, Catalog]) -> doc.Document:
    """The completeness of each catalogue, section by section, and the confidence of its figures."""
    coverages = {name: {s: figures for s in PARTS if (figures := coverage(c, s)).parts} for name, c in shelf.items()}
    blocks = (
        _of_many(coverages) if len(shelf) > _FEW else _of_few(coverages, {n: pairs_of(c) for n, c in shelf.items()})
    )
    return _document("Catalogues", "figures known", blocks)


def _of_many(coverages: Mapping[str, Mapping[str, Coverage]]) -> Iterator[doc.Block]:
    by_section = {s: [sections[s] for sections in coverages.values() if s in sections] for s in PARTS}
    rows = [
        (section, _number(makers, "parts"), str(len(makers)), *_shares(makers))
        for section, makers in by_section.items()
    ]
    yield doc.table("coverage", "", rows, more=[doc.Column("makers", "makers", "number"), *_SHARES])
    whole = []
    for name, sections in coverages.items():
        parts = [f"{coverage.parts} {s if coverage.parts > 1 else singular(s)}" for s, coverage in sections.items()]
        whole.append((name, "\n".join(parts), *_shares([*sections.values()])))
    yield doc.table("coverage", "", whole, heads={"title": "catalogue"}, without=["number"],
                    more=[doc.Column("parts", "parts"), *_SHARES])  # fmt: skip
    yield from _currencies(by_section)
    for section, makers in by_section.items():
        if makers:
            yield from _completeness({"all": makers}, section)
            left = Counter(name for coverage in makers for name, families in coverage.silent.items() for _ in families)
            words = ", ".join(f"{name} {count}" for name, count in left.most_common())
            if words:
                yield doc.Words(f"of {_number(makers, 'families')} families leave out decisive figures: {words}")
    yield doc.Words("drivesizer catalog stats --catalog maxon shows one catalogue in detail")


def _of_few(
    coverages: Mapping[str, Mapping[str, Coverage]], pairs: Mapping[str, Mapping[str, int]]
) -> Iterator[doc.Block]:
    for name, sections in coverages.items():
        fits = ", ".join(f"{count} combination{'s' * (count > 1)} of {what}"
                         for what, count in pairs[name].items() if count)  # fmt: skip
        yield doc.Heading(name, note=fits)
        rows = [
            (section, str(coverage.parts), str(coverage.families), *_shares([coverage]))
            for section, coverage in sections.items()
        ]
        yield doc.table("coverage", "", rows, more=[doc.Column("families", "families", "number"), *_SHARES])
        yield from _currencies({section: [coverage] for section, coverage in sections.items()})
    for section in PARTS:
        by_catalogue = {name: sections[section] for name, sections in coverages.items() if section in sections}
        yield from _completeness({name: [coverage] for name, coverage in by_catalogue.items()}, section)
        for name, figures in by_catalogue.items():
            texts = []
            for decisive, left in figures.silent.items():
                first = ", ".join(left[:_FEW]) + (f" and {len(left) - _FEW} more" if left[_FEW:] else "")
                texts.append(f"{decisive} ({'all families' if len(left) == figures.families else first})")
            if texts:
                words = f"{name}, decisive figures that families leave out: {'; '.join(texts)}"
                yield doc.Words(printable(words))


def _number(coverages: Sequence[Coverage], name: str) -> str:
    return str(sum(getattr(coverage, name) for coverage in coverages))


def _shares(coverages: Sequence[Coverage]) -> list[str]:
    """The share of parts that have a price, and that of each confidence among all known figures."""
    counts = {level: sum(coverage.sure[level] for coverage in coverages) for level in CONFIDENCE}
    shares = {level: _share(count, sum(counts.values())) for level, count in counts.items()}
    if not counts["measured"]:  # of own parts alone
        shares["measured"] = ""
    return [
        _share(sum(coverage.priced for coverage in coverages), sum(coverage.parts for coverage in coverages)),
        *shares.values(),
    ]


def _currencies(by_section: Mapping[str, Sequence[Coverage]]) -> Iterator[doc.Block]:
    """The currencies of the prices, with the number of parts that have one in each."""
    texts = []
    for section, coverages in by_section.items():
        count: Counter[str] = sum((Counter(coverage.prices) for coverage in coverages), Counter())
        if count:
            texts.append(f"{section} {', '.join(f'{number} in {code}' for code, number in count.most_common())}")
    if texts:
        yield doc.Words(f"prices: {'; '.join(texts)}")


def _completeness(coverages: Mapping[str, Sequence[Coverage]], section: str) -> Iterator[doc.Block]:
    """Of each figure the share of parts that have it; of several catalogues together, or of each beside the others."""

    def known(column: str, group: Sequence[Coverage]) -> int:
        return sum(coverage.known[column] for coverage in group)

    columns = [column for column in printed(section) if any(known(column, group) for group in coverages.values())]
    for start in range(0, len(coverages), _FEW):
        catalogues = dict(list(coverages.items())[start : start + _FEW])
        rows = [(column.replace("_", " "), *(_share(known(column, group), sum(coverage.parts for coverage in group))
                                             for group in catalogues.values())) for column in columns]  # fmt: skip
        yield doc.table("across", f"{section}: figures known", rows, heads={"title": section},
                        more=[doc.Column(name, name, "number") for name in catalogues])  # fmt: skip
    never = [column.replace("_", " ") for column in printed(section) if column not in columns]
    if coverages and never:
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


def imported(table: Imported, *, guessed: bool = False) -> Iterator[doc.Block]:
    """The parts and columns that an import read, those that it left out, and what a sizing still lacks."""
    parts = sum(table.families.values())
    kind = table.section if parts > 1 else singular(table.section)
    count = number_of(len(table.families), "family", "families")
    yield counts_words(table.families, f"{parts} {kind} in {count}: ")
    rows = [
        (printable(head.theirs), head.column.replace(" ", ", "), head.unit if head.unit != "1" else "",
         printable(first))
        for head, first in zip(table.heads, table.examples, strict=True) if head.column not in ("", head.theirs)
    ]  # fmt: skip
    yield doc.table("read_columns", "guessed by name and unit, to be looked at" if guessed else "columns", rows)
    yield from map(doc.Words, (*import_words(table), *still_needed(table.catalog, table.section)))


def import_words(table: Imported) -> list[str]:
    """Names that an import took by itself, assumed, left out and skipped, a line each."""
    same = [head.theirs for head in table.heads if head.column == head.theirs != ""]
    left = [f"{head.theirs} ({head.lacks})" if head.lacks else head.theirs
            for head in table.heads if head.theirs and not head.column]  # fmt: skip
    remarks = {"columns with matching names": same, "assumed": table.assumed, "left out": left,
            "not understood, unknown now": table.cells, "columns without a value": table.empty,
            "rows skipped": table.skipped}  # fmt: skip
    return [printable(f"{what}: {'; '.join(names)}") for what, names in remarks.items() if names]


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


def findings(findings: Sequence[Finding], *, everything: bool = False) -> Iterator[doc.Block]:
    """Figures that contradict one another, by the identity that they break."""
    groups: dict[tuple[str, ...], list[Finding]] = {}
    for finding in findings:
        if finding.unexplained or everything:
            groups.setdefault(
                (finding.file, finding.section, finding.identity, finding.meaning, finding.accepted), []
            ).append(finding)
    for (file, section, identity, meaning, accepted), group in groups.items():
        yield doc.Words((doc.Strong(f"{file}, {section}: {identity}"),))
        yield doc.Words(f"  {meaning}")
        if accepted:
            yield doc.Words(f"  accepted: {accepted}")
        if group[0].kind:
            yield doc.table("broken", "", map(_broken, group))
        else:
            yield doc.Words("  " + ", ".join(finding.part for finding in group))
    wrong = sum(finding.unexplained for finding in findings)
    accepted_too = sum(bool(finding.accepted) for finding in findings)
    words = f"{wrong} unexplained, {accepted_too} accepted, {len(findings) - wrong - accepted_too} informational"
    yield doc.Words(words if everything or wrong == len(findings) else f"{words}; --all shows them")


def _broken(finding: Finding) -> tuple[str, ...]:
    value, expected = (show(x, finding.unit, finding.kind) for x in (finding.found, finding.expected))
    shares = ("" if isnan(share) else f"{100 * share:.1f} %" for share in (finding.deviation, finding.tolerance))
    return finding.part, finding.family, value, f"{finding.relation.removeprefix('=')} {expected}".strip(), *shares
