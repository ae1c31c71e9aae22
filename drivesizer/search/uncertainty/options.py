"""How a spec, and options before it, want sets to be sampled."""

from __future__ import annotations

from typing import NamedTuple

from drivesizer.errors import InputError
from drivesizer.spec.robot import RobotSpec
from drivesizer.spec.tolerances import FEWEST, MOST

__all__ = ["FINALISTS", "POOL", "Sampling", "asked"]

FINALISTS = 3  # sets that go through the closed loop
POOL = 100  # of the best sets are sampled where a confidence is asked for


class Sampling(NamedTuple):
    """How sets are sampled."""

    samples: int
    seed: int
    confidence: float | None  # None: all are told, none falls
    processes: int = 1
    loop: int = 0  # samples of the best sets in closed loop


def asked(
    spec: RobotSpec, confidence: float | None = None, samples: int | None = None, seed: int | None = None,
    processes: int = 1,
    loop: int | None = None,
) -> Sampling | None:  # fmt: skip
    """How a spec, and options before it, want sets to be sampled; None where neither has tolerances in mind.

    Raises
    ------
    InputError
        When an option is out of its range.
    """
    given = spec.tolerances
    wanted = any(option is not None for option in (confidence, samples, seed, given.confidence))
    if not (wanted or spec.toleranced or "tolerances" in spec.model_fields_set):
        return None
    if confidence is not None and not 0.0 < confidence <= 1.0:
        raise InputError(f"--confidence {confidence:g} is not a probability; expected above 0, at most 1, e.g. 0.95")
    if samples is not None and not FEWEST <= samples <= MOST:
        raise InputError(f"--samples {samples} is out of range; expected {FEWEST} to {MOST}")
    if loop is not None and not 0 <= loop <= 10_000:
        raise InputError(f"--loop-samples {loop} is out of range; expected 0 to 10000")
    if seed is not None and not 0 <= seed < 2**32:
        raise InputError(f"--seed {seed} is out of range; expected 0 to {2**32 - 1}")
    wanted_of_all = given.confidence if confidence is None else confidence
    return Sampling(
        given.samples if samples is None else samples,
        given.seed if seed is None else seed,
        wanted_of_all,
        processes,
        loop if loop is not None else 0 if wanted_of_all is None else given.loop_samples,
    )
