"""``drivesizer catalog``: look into catalogues, check them, carry parts in and out.

Exit status as everywhere: 0, 1 nothing found (or a finding), 2 the input is wrong. Whatever takes time to import is
imported by the command that needs it.
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from drivesizer.commands.catalog_files import (
    Names,
    Section,
    export,
    known_section,
    open_named,
    print_document,
    take_in,
    write_csv,
)
from drivesizer.commands.options import file_option, whole_option
from drivesizer.errors import InputError, nearest, quoted

if TYPE_CHECKING:
    from drivesizer.catalog import Catalog
    from drivesizer.catalog.query import Hit, Selection

__all__ = ["app"]

app = typer.Typer(
    no_args_is_help=True,
    rich_markup_mode=None,
    pretty_exceptions_enable=False,
    help="Look into the catalogues, check them, carry parts in and out.",
)

Json = Annotated[bool, typer.Option("--json", help="Print one JSON document and nothing else, figures in SI.")]
Csv = Annotated[Path | None, file_option("--csv", metavar="FILE", help="Also write the parts to this CSV file.")]
Limit = Annotated[
    int, whole_option("--limit", 100, 1, meaning="How many parts the table shows; JSON and CSV hold all.")
]


@app.command("list", epilog="Example: drivesizer catalog list motors --voltage '24 V' --power '>=20 W' --sort mass")
def listed(
    section: Section = None,
    catalog: Names = None,
    family: Annotated[str | None, typer.Option(help="A family; * stands for anything.")] = None,
    voltage: Annotated[str | None, typer.Option(help="With its unit: '24 V', '<=24 V'; controllers: supply.")] = None,
    diameter: Annotated[str | None, typer.Option(help="Such as '<=26 mm'.")] = None,
    power: Annotated[str | None, typer.Option(help="Such as '>=20 W'.")] = None,
    kind: Annotated[str | None, typer.Option(help="Such as brushed or planetary; * stands for anything.")] = None,
    where: Annotated[list[str] | None, typer.Option(help="A column: 'max_speed>=8000 rpm'. May be repeated.")] = None,
    sort: Annotated[str, typer.Option(help="A column, -column for the largest first; the unknown last.")] = "",
    excluded: Annotated[bool, typer.Option("--excluded", help="Also parts excluded from sizing.")] = False,
    limit: Limit = 40,
    json: Json = False,
    csv: Csv = None,
) -> None:
    """List the parts that meet conditions, or all families."""
    shelf = open_named(catalog)
    options = {"family": family, "voltage": voltage, "diameter": diameter, "power": power, "kind": kind}
    wanted = [*filter(None, options.values()), *(where or ()), sort]
    if section is None and not any(wanted) and not (json or csv):
        from drivesizer.output.terminal import catalog as terminal_catalog

        terminal_catalog.overview(shelf)
        return
    found = _selected(shelf, section, options, where or [], sort=sort, excluded=excluded)
    hits = [hit for selection in found.values() for hit in selection.hits]
    if csv:
        write_csv(csv, hits)
    if json:
        _print_parts(shelf, hits, sum(selection.undecided for selection in found.values()))
    else:
        _print_lists(found, limit, [*_columns(where or []), sort.removeprefix("-")], section is None)
    raise typer.Exit(0 if hits else 1)


def _columns(conditions: list[str]) -> list[str]:
    """The columns that conditions name, to be shown as well."""
    from drivesizer.catalog.conditions import name_of

    return [name_of(text) for text in conditions]


def _selected(
    shelf: dict[str, Catalog], section: str | None, options: dict[str, str | None], where: list[str], **how: Any
) -> dict[str, Selection]:
    """Parts that meet the conditions, by section: the named one, or all that have the figures."""
    from drivesizer.catalog import PARTS
    from drivesizer.catalog.conditions import conditions, has
    from drivesizer.catalog.query import select

    names = [known_section(section)] if section else [s for s in PARTS if has(s, where, how["sort"])] or list(PARTS)
    required = {name: conditions(name, options, where) for name in names}
    found = {name: select(shelf, name, some, **how) for name, some in required.items() if some is not None}
    if not found:
        given = ", ".join(f"--{name}" for name, text in options.items() if text is not None)
        raise InputError(f"{given}: {section or 'no section'} has no such figure; --where takes any column")
    return found


def _print_lists(found: dict[str, Selection], limit: int, extra: list[str], several: bool) -> None:
    from drivesizer.catalog import columns_of
    from drivesizer.output.terminal import catalog as terminal_catalog

    for section, selection in found.items():
        if selection.hits or not several or not any(one.hits for one in found.values()):
            terminal_catalog.listing(section, selection, limit, [n for n in extra if n in columns_of(section)])


def _print_parts(shelf: dict[str, Catalog], hits: list[Hit], undecided: int) -> None:
    from drivesizer.catalog.exchange.exporting import as_document

    print_document({"found": len(hits), "undecided": undecided} | as_document(shelf, hits))


@app.command(epilog="Example: drivesizer catalog show 118752 --source")
def show(
    part: Annotated[str, typer.Argument(help="A part number.")],
    catalog: Names = None,
    source: Annotated[bool, typer.Option("--source", help="Source and confidence of each figure.")] = False,
    json: Json = False,
) -> None:
    """Show one part as a data sheet, with matching parts."""
    from drivesizer.catalog.lookup import find, partners

    shelf = open_named(catalog)
    hits = find(shelf, part)
    if json:
        from drivesizer.catalog.estimates import as_records
        from drivesizer.catalog.estimates.family_limits import limit_records
        from drivesizer.catalog.exchange.exporting import as_document

        document = as_document(shelf, hits, sources=True)
        for one, hit in zip(document["parts"], hits, strict=True):
            one["goes_with"] = partners(hit)
            one["estimates"] = as_records(hit.table, hit.row) + limit_records(hit.table, hit.row)
        print_document(document)
        return
    from drivesizer.output.terminal import part as terminal_part

    for hit in hits:
        terminal_part.page(hit, sources=source)


@app.command(epilog="Example: drivesizer catalog compare 118752 118743")
def compare(
    parts: Annotated[list[str], typer.Argument(metavar="PART PART ...", help="Two or more part numbers.")],
    catalog: Names = None,
    differing: Annotated[bool, typer.Option("--differing", help="Only rows that differ, or may.")] = False,
    json: Json = False,
) -> None:
    """Set parts side by side, the rows that differ marked."""
    from drivesizer.catalog.compare import side_by_side
    from drivesizer.catalog.lookup import find

    shelf = open_named(catalog)
    hits = [hit for part in dict.fromkeys(parts) for hit in find(shelf, part)]
    if len(hits) < 2:
        raise InputError(f"{quoted(' '.join(parts))} is one part; expected two or more to compare")
    rows = [row for row in side_by_side(hits) if row.differs is not False or not differing]
    if json:
        from drivesizer.catalog.exchange.exporting import as_document

        print_document(as_document(shelf, hits) | {"differs": {row.column.name: row.differs for row in rows}})
        return
    from drivesizer.output.terminal import catalog as terminal_catalog

    terminal_catalog.comparison(hits, rows)


@app.command(epilog="Example: drivesizer catalog search 'RE 25'")
def search(
    text: Annotated[str, typer.Argument(help="A piece of a part number, family or kind.")],
    catalog: Names = None,
    limit: Limit = 40,
    json: Json = False,
) -> None:
    """Find parts and families by a piece of their number, name or kind."""
    from drivesizer.catalog.lookup import families, look
    from drivesizer.catalog.query import every

    shelf = open_named(catalog)
    groups, parts = look(shelf, text)
    found = bool(parts or any(groups.values()))
    if json:
        names = {section: {name: len(hits) for name, hits in group.items()} for section, group in groups.items()}
        print_document({"families": names, "parts": [{"section": h.section, "part": h.part} for h in parts]})
    elif found:
        from drivesizer.output.terminal import catalog as terminal_catalog

        terminal_catalog.searched(groups, parts, limit)
    else:
        known = {name for group in families(shelf).values() for name in group} | {hit.part for hit in every(shelf)}
        typer.echo(f"drivesizer: {quoted(text)} is in no number, family or kind{nearest(text, known)}", err=True)
    raise typer.Exit(0 if found else 1)


@app.command(epilog="Example: drivesizer catalog stats --catalog maxon")
def stats(catalog: Names = None, json: Json = False) -> None:
    """Show the completeness of the catalogues and the confidence of their figures."""
    shelf = open_named(catalog)
    if json:
        from drivesizer.catalog import PARTS
        from drivesizer.catalog.coverage import coverage, pairs_of

        sections = {name: {s: coverage(c, s)._asdict() for s in PARTS} for name, c in shelf.items()}
        print_document({"catalogs": {n: {"pairs": pairs_of(c), **sections[n]} for n, c in shelf.items()}})
        return
    from drivesizer.output.terminal import findings as terminal_findings

    terminal_findings.statistics(shelf)


@app.command(epilog="Example: drivesizer catalog check --catalog my_parts.yaml")
def check(
    catalog: Names = None,
    everything: Annotated[bool, typer.Option("--all", help="Also accepted and informational findings.")] = False,
    json: Json = False,
) -> None:
    """Check that figures are consistent; status 1 when a contradiction is unexplained."""
    from drivesizer.catalog.laws.check import check as checked

    found = [one for shelved in open_named(catalog).values() for one in checked(shelved)]
    if json:
        from drivesizer.catalog.exchange.exporting import as_finding

        print_document({"findings": [as_finding(one) for one in found if one.unexplained or everything]})
    else:
        from drivesizer.output.terminal import findings as terminal_findings

        terminal_findings.findings(found, everything=everything)
    raise typer.Exit(1 if any(one.unexplained for one in found) else 0)


app.command(epilog="Example: drivesizer catalog export motors -o motors.csv")(export)
app.command("import", epilog="Example: drivesizer catalog import parts.csv --section motors --map map.yaml -o my.yaml")(
    take_in
)
