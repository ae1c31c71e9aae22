"""The schema of the form, kept between starts: to make it takes longer than all else of the first page."""

from __future__ import annotations

import json
from contextlib import suppress
from pathlib import Path

from drivesizer.files.cache import cached_bytes, digest_of, folder, keep
from drivesizer.version import __version__

__all__ = ["form_schema"]


def form_schema() -> str:
    """JSON with the schemas of spec and machine, along or about which axis a kind of load moves, and how one begins."""
    path = folder() / f"schema-{_sources()}.json"
    found = cached_bytes(path)
    if found is None:
        found = _made().encode()
        with suppress(OSError):
            keep(path, found)
    return found.decode()


def _sources() -> str:
    """Digest of the program as it is: its version, and the dates of its files, for those who change them."""
    package = Path(__file__).resolve().parents[1]
    dates = sorted(f"{path.name} {path.stat().st_mtime_ns}" for path in package.rglob("*.py"))
    return digest_of(__version__.encode(), *(date.encode() for date in dates))


def _made() -> str:
    from drivesizer.commands.starting import KINDS, starter
    from drivesizer.files.yaml_source import YamlSource
    from drivesizer.loads.kinds import AXES
    from drivesizer.spec.robot import RobotSpec
    from drivesizer.spec.several_axes.machine_schema import machine_schema

    axes = {**AXES, "recorded": None}  # which brings its own motion
    starts = {kind: YamlSource(starter(kind), kind).data for kind in AXES if kind in KINDS}
    begin = {kind: {name: data.get(name) for name in ("load", "motion")} for kind, data in starts.items()}
    found = {"spec": RobotSpec.model_json_schema(), "machine": machine_schema(), "axes": axes, "starts": begin}
    return json.dumps(found, ensure_ascii=False)
