"""Rows of variants, as each process of a study computes them. The same number always gives the same rows."""

from __future__ import annotations

import warnings
from collections.abc import Hashable, Sequence
from functools import lru_cache
from itertools import groupby
from pathlib import Path
from typing import Any, NamedTuple

from drivesizer.catalog import Catalog, load
from drivesizer.catalog.view.mounted import STEPPER, view_for
from drivesizer.errors import DrivesizerError, InputError
from drivesizer.files.yaml_source import Path_, YamlSource
from drivesizer.search.ranking import objective_of, title_of
from drivesizer.spec.any_spec import is_machine
from drivesizer.spec.machine import read_machine
from drivesizer.spec.robot import RobotSpec, read_spec
from drivesizer.study.columns import Row, best, failed, variant_rows
from drivesizer.study.fields import changed
from drivesizer.study.plan import Job, Variant
from drivesizer.version import __version__

__all__ = ["Part", "document_of", "parts_for", "rows_of", "spec_of"]


class Part(NamedTuple):
    """The rows of some variants, and the inputs of the process that computed them."""

    rows: list[Row]
    made_of: dict[str, str]  # program and catalogues, by version and digest


@lru_cache(maxsize=8)
def _source(name: str, text: str) -> YamlSource:
    return YamlSource(text, name)


@lru_cache(maxsize=8)
def _as_written(name: str, text: str) -> RobotSpec | None:
    """The spec as its file has it; None where it is invalid without the study's values."""
    try:
        return read_spec(_source(name, text))
    except InputError:
        return None


@lru_cache(maxsize=8)
def _catalog(
    names: tuple[str, ...], beside: str, kind: str | None, estimates: bool, phase_current: float | None
) -> Catalog:
    """Catalogues for the search, loaded once in a process."""
    return view_for(load(names, beside=Path(beside)), kind, estimates, phase_current)


def document_of(job: Job, variant: Variant) -> YamlSource:
    """The file of a variant: the spec's with other values in some fields."""
    source = _source(*job.specs[variant.spec])
    data = source.data
    for axis, value in zip(job.axes, variant.values, strict=True):
        data = changed(data, axis.path, value)
    found, names = source.with_data(data), job.catalogs[variant.catalogs]
    for path in _choices(found) if names else ():
        found.data = changed(found.data, (*path, "select", "catalogs"), list(names or ()))
    return found


def _choices(source: YamlSource) -> list[Path_]:
    """Places of the catalogues: of a machine also those of axes that have their own."""
    axes = (source.data.get("axes") or {}) if is_machine(source) else {}
    own = [name for name, given in axes.items() if "catalogs" in ((given or {}).get("select") or ())]
    return [(), *(("axes", name) for name in own)]


def spec_of(job: Job, variant: Variant) -> RobotSpec:
    """The spec of a variant of a single axis."""
    source = document_of(job, variant)
    if is_machine(source):
        return read_machine(source).axes[0].spec
    return read_spec(source, _as_written(*job.specs[variant.spec]))


def parts_for(spec: RobotSpec) -> Catalog:
    """The catalogues that a spec names."""
    kind = STEPPER if spec.steps else None
    return _catalog(
        tuple(spec.select.catalogs),
        str(Path(spec.file).parent),
        kind,
        spec.select.estimates == "on",
        spec.control.phase_current,
    )


def rows_of(job: Job, variants: Sequence[Variant], heads: Sequence[Row]) -> Part:
    """The rows of some variants."""
    made: dict[str, str] = {"drivesizer": __version__}
    rows: list[Row] = []
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # figures that overflow are unknown in the table
        both = zip(variants, heads, strict=True)
        for _, of_point in groupby(both, lambda one: (one[0].number - 1) // len(job.objectives)):
            alike: dict[Hashable, Any] = {}  # by all objectives of a point
            for variant, head in of_point:
                rows += _rows(job, variant, head, made, alike)
    return Part(rows, made)


def _rows(job: Job, variant: Variant, head: Row, made: dict[str, str], alike: dict[Hashable, Any]) -> list[Row]:
    text = job.objectives[variant.objective]
    objective = objective_of(text) if text else None
    title = title_of(objective) if objective else ""

    def parts(spec: RobotSpec) -> Catalog:
        catalog = parts_for(spec)
        made.update({f"catalogue {name}": digest for name, digest in catalog.digests.items()})
        return catalog

    try:
        if job.machine:
            from drivesizer.study.machine_rows import machine_rows  # a spec of one axis needs nothing of machines

            return machine_rows(job, document_of(job, variant), objective, head, parts)
        if "spec" not in alike:
            alike["spec"] = spec_of(job, variant)
        spec = alike["spec"]
        return variant_rows(head, best(spec, parts(spec), objective=objective, top=job.top, made=alike))
    except DrivesizerError as error:
        return failed(job, head, title, " ".join(str(error).split()))
    except (ArithmeticError, AssertionError, LookupError, TypeError, ValueError) as error:
        # A fault of the program, not of the variant: its row says so, and the following variants are still computed.
        text = f"a fault of drivesizer, please report it: {type(error).__name__}: {error}"[:400]
        return failed(job, head, title, text)
