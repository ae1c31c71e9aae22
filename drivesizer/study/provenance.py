"""Inputs of a study's results by name with their digests: runs with the same inputs are the same study."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from drivesizer.catalog import load
from drivesizer.errors import InputError
from drivesizer.files.cache import digest_of
from drivesizer.files.text import read_bytes
from drivesizer.files.yaml_source import YamlSource
from drivesizer.spec.select import Select
from drivesizer.study.columns import columns_of
from drivesizer.study.plan import Plan
from drivesizer.study.variant import rows_of
from drivesizer.version import __version__

__all__ = ["made_of", "refuse_if_all_invalid"]

_READ = (".csv", ".txt", ".json", ".urdf", ".xml", ".mjcf")  # ends of names of files that specs name
_TRIED = 200  # variants, to find a valid one


def made_of(plan: Plan) -> dict[str, str]:
    """Digests of the study, its specs, the files that these name, and the catalogues; the program's version.

    Comments and blanks in a YAML file are ignored.
    """
    shares = b"" if plan.shares is None else plan.shares.tobytes()
    found = {"drivesizer": __version__, Path(plan.source.name).name: digest_of(_canonical(plan.source.data), shares)}
    for name, (path, text) in zip(plan.names, plan.job.specs, strict=True):
        data = YamlSource(text, path).data
        found[name] = digest_of(_canonical(data))
        folder = Path(path).parent
        found |= {given: digest_of(read_bytes(folder / given)) for given in sorted(_files(data, folder))}
        for names in plan.job.catalogs:
            digests = load(names or _named(data), beside=folder).digests
            found |= {f"catalogue {catalog}": value for catalog, value in digests.items()}
    varied = {given for axis in plan.job.axes for given in _files(list(axis.values), Path(plan.job.specs[0][0]).parent)}
    return found | {given: digest_of(read_bytes(Path(plan.job.specs[0][0]).parent / given)) for given in sorted(varied)}


def _canonical(data: Any) -> bytes:
    return json.dumps(data, ensure_ascii=False, separators=(",", ":")).encode()


def _named(data: Any) -> list[str]:
    """Catalogues that a spec or the axes of a machine name; default ones where it has none or a field is malformed."""
    axes = data.get("axes")
    found = [_named_in(data), *(_named_in(axis) for axis in (axes.values() if isinstance(axes, dict) else ()))]
    names = [name for some in found for name in some]
    return list(dict.fromkeys(names if found[0] else [*Select().catalogs, *names]))


def _named_in(data: Any) -> list[str]:
    """Catalogues of a section ``select``."""
    select = data.get("select") if isinstance(data, dict) else None
    given = select.get("catalogs") if isinstance(select, dict) else None
    names = [given] if isinstance(given, str) else given
    return [str(name) for name in names] if isinstance(names, list) else []


def _files(data: Any, folder: Path) -> Iterator[str]:
    """Texts in a spec that name a file, such as a recording or a robot's description."""
    if isinstance(data, dict | list):
        for value in data.values() if isinstance(data, dict) else data:
            yield from _files(value, folder)
    elif isinstance(data, str) and data.lower().endswith(_READ) and (folder / data).is_file():
        yield data


def refuse_if_all_invalid(plan: Plan) -> str:
    """Size variants until one is valid."""
    heads = [column.head for column in columns_of(plan)]
    status, error = heads.index("status"), heads.index("error")
    few = range(1, plan.total + 1, -(-plan.total // _TRIED))
    first = ""
    for number in few:
        variant = plan.variant(number)
        (row, *_) = rows_of(plan.job, [variant], [plan.head(variant)]).rows
        if row[status] != "error":
            return ""
        first = first or row[error]
    if len(few) == plan.total:
        raise InputError(f"{plan.source.name}: all of its variants are invalid ({plan.total}); the first: {first}")
    return f"each of {len(few)} variants tried is invalid, the first: {first}"
