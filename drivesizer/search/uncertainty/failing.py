"""Samples in which a drive fails: all that is needed of drives before it is known which of them are shown.

The checks are those of ``probabilities``, which has their margins, quantiles and shares too.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from drivesizer.catalog import Catalog
from drivesizer.results.check_kinds import BATTERY_SAMPLED
from drivesizer.search.uncertainty.prepare import Prepared
from drivesizer.search.uncertainty.probabilities import Subject, blocks_of, by_processes
from drivesizer.search.uncertainty.sampled_checks import Block, checks_of

__all__ = ["failing"]

Failed = NDArray[np.bool_]


def failing(given: Prepared, catalog: Catalog, subjects: Sequence[Subject], processes: int = 1) -> list[Failed]:
    """Whether some check fails, of each drive in each sample.

    Parameters
    ----------
    given
        The samples.
    catalog
        The parts.
    subjects
        The drives.
    processes
        Number of processes that share the drives.

    Returns
    -------
    list of array
        One a drive, of shape (samples,).
    """
    if processes > 1 and len(subjects) > 1:
        return by_processes(failing, given, catalog, subjects, processes)
    parts = [[_fails(catalog, one, block) for one in subjects] for block in blocks_of(given, catalog, subjects)]
    return [np.concatenate(each) for each in zip(*parts, strict=True)]


def _fails(catalog: Catalog, one: Subject, block: Block) -> Failed:
    """Whether some check of a drive fails in each sample of a block; what no sample changes as it is nominally."""
    found, decide = checks_of(catalog, one.rows, block), [check for check in one.nominal if not check.advice]
    failed = np.full(block.size, any(check.status == "fail" for check in decide if check.name not in found))
    for name in {*(check.name for check in decide), *BATTERY_SAMPLED} & found.keys():
        failed |= found[name].failed
    return failed
