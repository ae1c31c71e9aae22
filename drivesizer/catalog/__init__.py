"""Catalogues of real parts: loading by name or file, compiled on first use.

>>> catalog = load(["maxon"])
>>> motor = catalog.motors.record(catalog.motors.rows["118752"])
>>> motor.family, motor.resistance
('RE 25', 2.32)
"""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

from drivesizer import __version__
from drivesizer.catalog.cache import CacheWarning, digest_of, folder, recall, store
from drivesizer.catalog.parts import DIRECT, EDGES, PARTS, Controller, Encoder, Gearhead, Motor, columns_of
from drivesizer.catalog.tables import Catalog, Note, Pairs, Source, Table, joined
from drivesizer.errors import InputError, quoted
from drivesizer.textfile import decoded, read_bytes

__all__ = [
    "DIRECT", "EDGES", "PARTS", "CacheWarning", "Catalog", "Controller", "Encoder", "Gearhead", "Motor", "Note",
    "Pairs", "Source", "Table", "columns_of", "load", "shipped",
]  # fmt: skip


def shipped() -> dict[str, Path]:
    """The catalogues that come with drivesizer, by name.

    In an installed package they lie inside it, in a checkout beside it.
    """
    package = Path(__file__).resolve().parent.parent
    inside, beside = package / "catalogs", package.parent / "catalogs"
    return {path.stem: path for path in sorted((inside if inside.is_dir() else beside).glob("*.yaml"))}


def load(names: Iterable[str] = ("maxon",), *, beside: Path | None = None) -> Catalog:
    """Catalogues by name or by file, as one.

    Parameters
    ----------
    names
        Names of shipped catalogues, ``all`` for all of them, or paths of catalogue files.
    beside
        Folder from which relative paths count.

    Raises
    ------
    InputError
        When a catalogue is neither shipped nor a file.
    CatalogError
        When a file is not what the schema asks for.
    """
    known = list(shipped())
    named = [each for name in names for each in (known if name == "all" else [name])]
    paths = [_path(name, beside) for name in dict.fromkeys(named)]
    stems = [path.stem for path in paths]
    for stem in stems:
        if stems.count(stem) > 1:
            raise InputError(f"two catalogues are called {quoted(stem)}; rename one of the files")
    return joined([_one(path) for path in paths])


def _path(name: str, beside: Path | None) -> Path:
    known = shipped()
    if name in known:
        return known[name]
    path = (beside or Path()) / name
    if path.suffix in (".yaml", ".yml"):
        return path
    raise InputError(f"no catalogue is called {quoted(name)}; expected {', '.join(known)} or a .yaml file")


def _one(path: Path) -> Catalog:
    raw = read_bytes(path)
    schema = repr([columns_of(section) for section in PARTS]).encode()
    content = digest_of(raw)
    compiled = folder() / f"{path.stem}-{digest_of(__version__.encode(), schema, raw)}.catalog"
    found = recall(compiled)
    if found is None:
        from drivesizer.catalog.reading import parse
        from drivesizer.yaml_source import YamlSource

        found = parse(YamlSource(decoded(raw, path), str(path)), path.stem, content)
        store(compiled, found)
    return found
