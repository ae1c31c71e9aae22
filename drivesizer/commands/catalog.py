"""``drivesizer catalog``: look into catalogues, check them, carry parts in and out."""

from __future__ import annotations

import os
import shlex
from collections.abc import Iterable
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from drivesizer.commands import common
from drivesizer.errors import InputError, nearest, quoted
from drivesizer.files.writing import new, ready, write_files
from drivesizer.output.words import number_of

if TYPE_CHECKING:
    from drivesizer.catalog import Catalog
    from drivesizer.catalog.importing import Imported, Plan
    from drivesizer.catalog.query import PartRow, Selection


# -- Export of parts to CSV or JSON, and import of another program's table as a catalogue file.


Names = Annotated[
    list[str] | None,
    typer.Option("--catalog", metavar="NAME_OR_FILE", help="A catalogue, by name or file; all that ship without it."),
]
Section = Annotated[str | None, typer.Argument(metavar="SECTION", help="motors, gearheads, encoders or controllers.")]


def open_named(names: list[str] | None) -> dict[str, Catalog]:
    """Catalogues that an option names; all shipped ones without it."""
    from drivesizer.catalog.query import open_catalogs

    return open_catalogs(names or ())


def known_section(section: str) -> str:
    """Refuse the name of an unknown section; else return it."""
    from drivesizer.catalog import PARTS

    if section not in PARTS:
        raise InputError(
            f"{quoted(section)} is no section; expected {', '.join(PARTS)}; `drivesizer catalog search` looks for names"
        )
    return section


def write_csv(path: Path, hits: list[PartRow]) -> None:
    """Write the parts of one section to a CSV file; nothing without parts."""
    from drivesizer.catalog.query import as_csv

    sections = list(dict.fromkeys(hit.section for hit in hits))
    if len(sections) > 1:
        raise InputError(f"{path}: a CSV file holds one section, found {', '.join(sections)}; name one")
    if sections:
        write_files({path: as_csv(sections[0], hits)})


def export(
    output: Annotated[Path, common.file_option("--output", "-o", help="parts.csv (one section) or parts.json.")],
    section: Section = None,
    catalog: Names = None,
) -> None:
    """Write all parts to CSV, with a row of units, or to JSON, in SI."""
    from drivesizer.catalog import PARTS
    from drivesizer.catalog.query import all_parts

    shelf = open_named(catalog)
    hits = list(all_parts(shelf, [known_section(section)] if section else PARTS))
    if output.suffix == ".csv":
        write_csv(output, hits)
    elif output.suffix == ".json":
        from drivesizer.catalog.query import as_document
        from drivesizer.output.json.documents import as_text

        write_files({output: f"{as_text(as_document(shelf, hits))}\n".encode()})
    else:
        raise InputError(f"{output}: the suffix {quoted(output.suffix)} is not known; expected .csv or .json")
    typer.echo(f"{output}: {number_of(len(hits), 'part')}")
    raise typer.Exit(0 if hits else 1)


Stated = Annotated[str | None, typer.Option(help="As in the map, and before it.")]


def take_in(
    file: Annotated[
        Path, common.file_argument(metavar="FILE", help="CSV, XLSX, a data sheet (PDF, text), JSON, .cfg, MJCF.")
    ],
    section: Annotated[str, typer.Option(help="motors, gearheads, ...; without it the kind that fits best.")] = "",
    map_: Annotated[
        Path | None, common.file_option("--map", help="YAML: their header to our column, source, maker.")
    ] = None,
    output: Annotated[Path | None, common.file_option("--output", "-o", help="The catalogue file to write.")] = None,
    dry_run: Annotated[bool, typer.Option("--dry-run", help="Only show what would be read.")] = False,
    replaced: Annotated[bool, typer.Option("--replace", help="Write over files of an import before.")] = False,
    set_: Annotated[list[str] | None, typer.Option("--set", metavar="COLUMN=FIGURE", help="Of all parts.")] = None,
    with_: Annotated[
        list[str] | None,
        typer.Option("--with", metavar="NAME_OR_FILE", help="A catalogue whose motors, gearheads, encoders they fit."),
    ] = None,
    manufacturer: Stated = None,
    family: Stated = None,
    name: Stated = None,
    document: Stated = None,
    confidence: Annotated[str | None, typer.Option(help="measured, quoted, secondary, derived or recalled.")] = None,
    date: Stated = None,
    url: Stated = None,
) -> None:
    """Make a catalogue file out of a table or a data sheet; without a map its columns are guessed and shown."""
    from drivesizer.catalog.importing import import_table, map_text, plan
    from drivesizer.catalog.laws import check as checked
    from drivesizer.files.sheets import sheets
    from drivesizer.output.document import catalogue

    if output is None and not dry_run:
        raise InputError("--output: no file to write is named; expected -o my_parts.yaml, or --dry-run")
    target = _target(output or Path("parts.yaml"), dry_run=output is None)
    if output is not None and not replaced and os.path.lexists(target):
        raise InputError(
            f"{target}: the file exists and is left alone; name another with -o, or --replace writes over it"
        )
    stated = {"manufacturer": manufacturer, "family": family, "name": name, "document": document,
              "confidence": confidence, "date": date, "url": url}  # fmt: skip
    planned = plan(section, map_, stated, set_ or ())
    partners = open_named(with_) if with_ else {}
    tables = sheets(file)
    imported = import_table(tables, file, planned, target, partners)
    if map_ is None and common.at_a_terminal():
        answered = _completed(imported, planned)
        imported = imported if answered is planned else import_table(tables, file, answered, target, partners)
    written, files = list[str](), dict[Path, bytes]()  # before anything is printed, whose reader may go away
    if map_ is None and not dry_run and any(head.column not in ("", head.theirs) for head in imported.heads):
        map_path = target.with_suffix(".map.yaml")
        files[map_path] = map_text(imported).encode()
        kind = "" if section else f" --section {imported.section}"
        written.append(
            f"{map_path} written: mend it where the guess is wrong, and import again "
            f"with --map {map_path}{kind} --replace"
        )
    if not dry_run:
        files[target] = imported.text.encode()
        assumed = "what fits is assumed at its end: look at it" if "\ncompatibility:" in imported.text else ""
        fits = assumed or "it states no compatibility: name a catalogue by --with, or add it at its end"
        written.append(f"{target} written; {fits}")
    if replaced:
        write_files(files)
    else:
        for path, content in files.items():
            new(path, content)
    common.show_blocks(catalogue.imported(imported, guessed=map_ is None))
    wrong = [finding for finding in checked(imported.catalog) if finding.unexplained]
    if wrong:
        common.show_blocks(catalogue.findings(wrong))
    for line in written:
        typer.echo(line)


def _completed(imported: Imported, planned: Plan) -> Plan:
    """The plan of an import with what the user says of heads that were not understood, and of the motors' kind."""
    from drivesizer.catalog import columns_of

    known, answers, shared = columns_of(imported.section), dict(planned.answers), dict(planned.common)
    for head, first in zip(imported.heads, imported.examples, strict=True):
        if head.theirs and not head.column and not head.lacks and first:
            question = f"column of {quoted(head.theirs)}, first {quoted(first)}; empty: left out"
            if column := common.answer(question, lambda text: _one_of(text, known)):
                answers[head.theirs] = column
    columns, kinds = {*shared, *answers.values(), *(head.column for head in imported.heads)}, ("brushed", "brushless")
    if imported.section in ("motors", "actuators") and "kind" not in columns:
        kind = common.answer(f"kind of the {imported.section}: {' or '.join(kinds)}", lambda text: _one_of(text, kinds))
        shared |= {"kind": kind} if kind else {}
    if answers == planned.answers and shared == planned.common:
        return planned
    return replace(planned, section=imported.section, common=shared, answers=answers)


def _one_of(text: str, known: Iterable[str]) -> None:
    if text not in known:
        raise InputError(f"{quoted(text)} is not known{nearest(text, known)}")


def _target(output: Path, dry_run: bool = False) -> Path:
    """A catalogue file that can be written, or is only a name."""

    if output.suffix not in (".yaml", ".yml"):
        raise InputError(f"{output}: the suffix {quoted(output.suffix)} is not known; expected .yaml")
    if not dry_run:
        ready(output)
    return output


def add(
    output: Annotated[Path, common.file_option("--output", "-o", help="Your catalogue file: made, or extended.")],
    section: Annotated[str, typer.Option(help="motors, gearheads, actuators ...")] = "motors",
    set_: Annotated[
        list[str] | None,
        typer.Option("--set", metavar="FIELD=FIGURE", help="name=775, 'voltage=12 V', document=..., date=2026-11."),
    ] = None,
) -> None:
    """Add a part by the figures of a shop's page to a catalogue of your own; at a terminal they are requested."""
    from drivesizer.catalog import catalog_of_text
    from drivesizer.catalog.importing import meant_by, on_shop_pages
    from drivesizer.catalog.laws import check as checked
    from drivesizer.catalog.typed import NAME, SHARED, typed_part, with_part
    from drivesizer.files.yaml_source import written
    from drivesizer.output.document import catalogue

    known_section(section)
    _target(output)
    figures = dict[str, Any]()
    for entry in set_ or ():
        name, sign, text = entry.partition("=")
        if not sign or not text.strip():
            raise InputError(f"--set: {quoted(entry)}; expected a field and its figure, e.g. 'voltage=12 V'")
        figures[name.strip()] = text.strip()

    def read(**more: Any) -> str:
        return typed_part(written({"document": "a shop's page", **figures, **more}, "--set"), (), section)

    def read_with(name: str, text: str) -> str:
        return read(**{NAME: "x"} | {name: text})

    fields = {meant_by(section, name) for name in figures}
    for name in (NAME, "maker", *on_shop_pages(section), *SHARED) if common.at_a_terminal() else ():
        if name not in fields and (figure := common.answer(_question(section, name), partial(read_with, name))):
            figures[name] = figure
    if NAME not in figures:
        raise InputError("--set: the part has no name; expected e.g. --set name=775")
    part, empty = read(), f"catalog: 1\nmanufacturer: {figures.get('maker', 'own')}\n"
    content = with_part(output.read_text(encoding="utf-8") if output.exists() else empty, str(output), part)
    write_files({output: content.encode()})
    catalog = catalog_of_text(Path("added.yaml"), part.encode())
    common.show_blocks(catalogue.added(catalog, section, output))
    if wrong := [finding for finding in checked(catalog) if finding.unexplained]:
        common.show_blocks(catalogue.findings(wrong))


def _question(section: str, name: str) -> str:
    from drivesizer.catalog import columns_of
    from drivesizer.units import KINDS

    column = columns_of(section).get(name)
    hints = {"name": "775", "kind": "brushed or brushless", "confidence": "quoted, secondary", "date": "2026-11"}
    hint = hints.get(name) or (KINDS[column.kind].example if column and column.kind in KINDS else "")
    return name.replace("_", " ") + (f", e.g. {hint}" if hint else "")


# -- ``drivesizer catalog``: look into catalogues, check them, carry parts in and out.
#
# Exit status as everywhere: 0, 1 nothing found (or a finding), 2 the input is wrong. Whatever takes time to import
# is imported by the command that needs it.


app = typer.Typer(
    no_args_is_help=True,
    rich_markup_mode=None,
    pretty_exceptions_enable=False,
    help="Look into the catalogues, check them, carry parts in and out.",
)

Json = Annotated[bool, typer.Option("--json", help="Print one JSON document and nothing else, figures in SI.")]
Csv = Annotated[Path | None, common.file_option("--csv", metavar="FILE", help="Also write the parts to this CSV file.")]
Limit = Annotated[
    int, common.whole_option("--limit", 100, 1, meaning="How many parts the table shows; JSON and CSV hold all.")
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
    report: common.Report = None,
) -> None:
    """List the parts that meet conditions, or all families."""
    from drivesizer.catalog.query import as_document, name_of
    from drivesizer.output.document import catalogue

    common.accept_reports(report)
    shelf = open_named(catalog)
    options = {"family": family, "voltage": voltage, "diameter": diameter, "power": power, "kind": kind}
    conditions = [*filter(None, options.values()), *(where or ()), sort]
    if section is None and not any(conditions) and not (json or csv):
        common.present(catalogue.overview(shelf), report)
        return
    selections = _selected(shelf, section, options, where or [], sort=sort, excluded=excluded)
    hits = [hit for selection in selections.values() for hit in selection.hits]
    if csv:
        write_csv(csv, hits)
    if json:
        undecided = sum(selection.undecided for selection in selections.values())
        common.print_json({"found": len(hits), "undecided": undecided} | as_document(shelf, hits))
        raise typer.Exit(0 if hits else 1)
    named = [*(name_of(text) for text in where or []), sort.removeprefix("-")]  # columns that conditions name
    sections = {name: selection for name, selection in selections.items() if selection.hits or section or not hits}
    common.present(catalogue.listing(sections, limit, named), report)
    raise typer.Exit(0 if hits else 1)


def _selected(
    shelf: dict[str, Catalog], section: str | None, options: dict[str, str | None], where: list[str], **how: Any
) -> dict[str, Selection]:
    """Parts that meet the conditions, by section: the named one, or all that have the figures."""
    from drivesizer.catalog import PARTS
    from drivesizer.catalog.query import conditions, has, select

    names = [known_section(section)] if section else [s for s in PARTS if has(s, where, how["sort"])] or list(PARTS)
    required = {name: conditions(name, options, where) for name in names}
    selections = {
        name: select(shelf, name, condition, **how) for name, condition in required.items() if condition is not None
    }
    if not selections:
        flags = ", ".join(f"--{name}" for name, text in options.items() if text is not None)
        raise InputError(f"{flags}: {section or 'no section'} has no such figure; --where takes any column")
    return selections


@app.command(epilog="Example: drivesizer catalog show 118752 --source")
def show(
    part: Annotated[str, typer.Argument(help="A part number.")],
    catalog: Names = None,
    source: Annotated[bool, typer.Option("--source", help="Source and confidence of each figure.")] = False,
    json: Json = False,
    report: common.Report = None,
) -> None:
    """Show one part as a data sheet, with matching parts; one of several voltages as a column for each."""
    from drivesizer.catalog.query import as_document, find, partners, side_by_side

    common.accept_reports(report)
    shelf = open_named(catalog)
    hits = find(shelf, part)
    if json:
        from drivesizer.catalog.estimates import as_records

        document = as_document(shelf, hits, sources=True)
        for record, hit in zip(document["parts"], hits, strict=True):
            record["goes_with"] = partners(hit)
            record["estimates"] = as_records(hit.table, hit.row)
        common.print_json(document)
        return
    from drivesizer.output.document import catalogue

    same: dict[Any, list[Any]] = {}  # rows of what is bought under one number, at several voltages
    for hit in hits:
        number = hit["order_number"] if hit.section in ("motors", "actuators") else ""
        same.setdefault((hit.catalogue, hit.section, number or hit.part), []).append(hit)
    if report and len(same) > 1:
        raise InputError(f"{quoted(part)} is several parts; expected a report of one, of --catalog {hits[0].catalogue}")
    for rows in same.values():
        if len(rows) == 1:
            common.present(catalogue.page(rows[0], sources=source), report)
            continue
        common.present(catalogue.comparison(rows, side_by_side(rows)), report)
        print(f"\nwith curves and what goes with it: drivesizer catalog show {shlex.quote(rows[0].part)}")


@app.command(epilog="Example: drivesizer catalog compare 118752 118743")
def compare(
    parts: Annotated[list[str], typer.Argument(metavar="PART PART ...", help="Two or more part numbers.")],
    catalog: Names = None,
    differing: Annotated[bool, typer.Option("--differing", help="Only rows that differ, or may.")] = False,
    json: Json = False,
    report: common.Report = None,
) -> None:
    """Set parts side by side, the rows that differ marked."""
    from drivesizer.catalog.query import as_document, find, side_by_side

    common.accept_reports(report)
    shelf = open_named(catalog)
    hits = [hit for part in dict.fromkeys(parts) for hit in find(shelf, part)]
    if len(hits) < 2:
        raise InputError(f"{quoted(' '.join(parts))} is one part; expected two or more to compare")
    rows = [row for row in side_by_side(hits) if row.differs is not False or not differing]
    if json:
        common.print_json(as_document(shelf, hits) | {"differs": {row.column.name: row.differs for row in rows}})
        return
    from drivesizer.output.document import catalogue

    common.present(catalogue.comparison(hits, rows), report)


@app.command(epilog="Example: drivesizer catalog search 'RE 25'")
def search(
    text: Annotated[str, typer.Argument(help="A piece of a part number, family or kind.")],
    catalog: Names = None,
    limit: Limit = 40,
    json: Json = False,
) -> None:
    """Find parts and families by a piece of their number, name or kind."""
    from drivesizer.catalog.query import all_parts, families, look

    shelf = open_named(catalog)
    groups, parts = look(shelf, text)
    has_hits = bool(parts or any(groups.values()))
    if json:
        names = {section: {name: len(hits) for name, hits in group.items()} for section, group in groups.items()}
        common.print_json({"families": names, "parts": [{"section": h.section, "part": h.part} for h in parts]})
    elif has_hits:
        from drivesizer.output.document import catalogue

        common.show_blocks(catalogue.searched(groups, parts, limit))
    else:
        known = {name for group in families(shelf).values() for name in group} | {hit.part for hit in all_parts(shelf)}
        typer.echo(f"drivesizer: {quoted(text)} is in no number, family or kind{nearest(text, known)}", err=True)
    raise typer.Exit(0 if has_hits else 1)


@app.command(epilog="Example: drivesizer catalog stats --catalog maxon")
def stats(catalog: Names = None, json: Json = False, report: common.Report = None) -> None:
    """Show the completeness of the catalogues and the confidence of their figures."""
    common.accept_reports(report)
    shelf = open_named(catalog)
    if json:
        from drivesizer.catalog import PARTS
        from drivesizer.catalog.query import coverage, pairs_of

        sections = {name: {s: coverage(c, s)._asdict() for s in PARTS} for name, c in shelf.items()}
        common.print_json({"catalogs": {n: {"pairs": pairs_of(c), **sections[n]} for n, c in shelf.items()}})
        return
    from drivesizer.output.document import catalogue

    common.present(catalogue.statistics(shelf), report)


@app.command(epilog="Example: drivesizer catalog check --catalog my_parts.yaml")
def check(
    catalog: Names = None,
    everything: Annotated[bool, typer.Option("--all", help="Also accepted and informational findings.")] = False,
    json: Json = False,
) -> None:
    """Check that figures are consistent; status 1 when a contradiction is unexplained."""
    from drivesizer.catalog.laws import check as checked

    findings = [finding for shelved in open_named(catalog).values() for finding in checked(shelved)]
    if json:
        from drivesizer.catalog.query import as_finding

        common.print_json(
            {"findings": [as_finding(finding) for finding in findings if finding.unexplained or everything]}
        )
    else:
        from drivesizer.output.document import catalogue

        common.show_blocks(catalogue.findings(findings, everything=everything))
    raise typer.Exit(1 if any(finding.unexplained for finding in findings) else 0)


app.command(epilog="Example: drivesizer catalog export motors -o motors.csv")(export)
app.command(epilog="Example: drivesizer catalog add -o my.yaml --set name=775 --set 'voltage=12 V'")(add)
app.command("import", epilog="Example: drivesizer catalog import parts.csv -o my.yaml")(take_in)
