"""Export of parts to CSV or JSON, and import of another program's table as a catalogue file."""

from __future__ import annotations

import os
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from drivesizer.commands.options import file_argument, file_option
from drivesizer.errors import InputError, quoted
from drivesizer.output.counted import number_of
from drivesizer.version import __version__

if TYPE_CHECKING:
    from drivesizer.catalog import Catalog
    from drivesizer.catalog.query import Hit

__all__ = ["Names", "Section", "export", "known_section", "open_named", "print_document", "take_in", "write_csv"]

Names = Annotated[
    list[str] | None,
    typer.Option("--catalog", metavar="NAME_OR_FILE", help="A catalogue, by name or file; all that ship without it."),
]
Section = Annotated[str | None, typer.Argument(metavar="SECTION", help="motors, gearheads, encoders or controllers.")]


def open_named(names: list[str] | None) -> dict[str, Catalog]:
    """Catalogues that an option names; all shipped ones without it."""
    from drivesizer.catalog.query import open_catalogs

    return open_catalogs(names or ())


def print_document(document: dict[str, Any]) -> None:
    """Print one JSON document with its head."""
    typer.echo(_text(document))


def _text(document: dict[str, Any]) -> str:
    """A JSON document with its head: schema and program version."""
    from drivesizer.output.json.documents import SCHEMA_VERSION, as_text

    return as_text({"schema_version": SCHEMA_VERSION, "drivesizer": __version__} | document)


def known_section(section: str) -> str:
    """Refuse the name of an unknown section; else return it."""
    from drivesizer.catalog import PARTS

    if section not in PARTS:
        raise InputError(f"{quoted(section)} is no section; expected {', '.join(PARTS)}")
    return section


def write_csv(path: Path, hits: list[Hit]) -> None:
    """Write the parts of one section to a CSV file; nothing without parts.

    Parameters
    ----------
    path
        Of the CSV file.
    hits
        The parts.
    """
    from drivesizer.catalog.exchange.exporting import as_csv
    from drivesizer.files.writing import write_files

    sections = list(dict.fromkeys(hit.section for hit in hits))
    if len(sections) > 1:
        raise InputError(f"{path}: a CSV file holds one section, found {', '.join(sections)}; name one")
    if sections:
        write_files({path: as_csv(sections[0], hits)})


def export(
    output: Annotated[Path, file_option("--output", "-o", help="parts.csv (one section) or parts.json.")],
    section: Section = None,
    catalog: Names = None,
) -> None:
    """Write all parts to CSV, with a row of units, or to JSON, in SI."""
    from drivesizer.catalog import PARTS
    from drivesizer.catalog.query import every

    shelf = open_named(catalog)
    hits = list(every(shelf, [known_section(section)] if section else PARTS))
    if output.suffix == ".csv":
        write_csv(output, hits)
    elif output.suffix == ".json":
        from drivesizer.catalog.exchange.exporting import as_document
        from drivesizer.files.writing import write_files

        write_files({output: f"{_text(as_document(shelf, hits))}\n".encode()})
    else:
        raise InputError(f"{output}: the suffix {quoted(output.suffix)} is not known; expected .csv or .json")
    typer.echo(f"{output}: {number_of(len(hits), 'part')}")
    raise typer.Exit(0 if hits else 1)


Stated = Annotated[str | None, typer.Option(help="As in the map, and before it.")]


def take_in(
    file: Annotated[Path, file_argument(metavar="FILE.CSV", help="A header, a row of units, then the parts.")],
    section: Annotated[str, typer.Option(help="motors, gearheads, encoders or controllers.")],
    map_: Annotated[Path | None, file_option("--map", help="YAML: their header to our column, source, maker.")] = None,
    output: Annotated[Path | None, file_option("--output", "-o", help="The catalogue file to write.")] = None,
    dry_run: Annotated[bool, typer.Option("--dry-run", help="Only show what would be read.")] = False,
    manufacturer: Stated = None,
    family: Stated = None,
    name: Stated = None,
    document: Stated = None,
    confidence: Annotated[str | None, typer.Option(help="quoted, secondary, derived or recalled.")] = None,
    date: Stated = None,
    url: Stated = None,
) -> None:
    """Make a catalogue file out of another program's table; without a map its columns are guessed and shown."""
    from drivesizer.catalog.exchange.import_map import plan
    from drivesizer.catalog.exchange.importing import heads_of, import_table
    from drivesizer.files.text import read_text
    from drivesizer.files.writing import new
    from drivesizer.output.terminal import findings as terminal_findings

    target = _target(output, dry_run)
    stated = {"manufacturer": manufacturer, "family": family, "name": name, "document": document,
              "confidence": confidence, "date": date, "url": url}  # fmt: skip
    text, planned, guess = read_text(file), plan(section, map_, stated), {}
    if map_ is None:
        from drivesizer.catalog.exchange.guessing import guessed, map_text

        header, units = heads_of(text, file)
        guess = guessed(header, units, section)
        planned = replace(planned, columns=guess)
    imported = import_table(text, file, planned, target)
    written = []  # before anything is printed, whose reader may go away
    if guess and not dry_run:
        beside = target.with_suffix(".map.yaml")
        named = {theirs: theirs for theirs in header if theirs in imported.columns.values()}
        new(beside, map_text(named | guess, header, stated).encode())
        written.append(f"{beside} written: mend it where the guess is wrong, and import again with --map {beside}")
    if not dry_run:
        new(target, imported.text.encode())
        written.append(f"{target} written; it states no compatibility yet: add it at its end")
    terminal_findings.imported(imported, guessed=bool(guess))
    for line in written:
        typer.echo(line)


def _target(output: Path | None, dry_run: bool) -> Path:
    from drivesizer.files.writing import ready

    if output is None and not dry_run:
        raise InputError("--output: no file to write is named; expected -o my_parts.yaml, or --dry-run")
    target = output or Path("parts.yaml")
    if target.suffix not in (".yaml", ".yml"):
        raise InputError(f"{target}: the suffix {quoted(target.suffix)} is not known; expected .yaml")
    if output is not None and os.path.lexists(target):
        raise InputError(f"{target}: the file exists and is left alone; name another with -o")
    if output is not None:
        ready(target)
    return target
