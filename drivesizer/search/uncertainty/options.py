"""Options of sampling: those of a spec, and of the command line before it."""

from __future__ import annotations

from typing import NamedTuple

from drivesizer.errors import InputError
from drivesizer.spec.robot import RobotSpec
from drivesizer.spec.tolerances import FEWEST, MOST

FINALISTS = 3  # drives that are simulated in closed loop
POOL = 100  # best drives that are sampled where a confidence is required


class Sampling(NamedTuple):
    """Options of sampling."""

    samples: int
    seed: int
    confidence: float | None  # required; None: all are reported, none is rejected
    processes: int = 1
    loop: int = 0  # samples of the best drives in closed loop


def sampling_of(
    spec: RobotSpec, confidence: float | None = None, samples: int | None = None, seed: int | None = None,
    processes: int = 1,
    loop: int | None = None,
) -> Sampling | None:  # fmt: skip
    """Options of sampling of a spec, and options before it; None where neither mentions tolerances."""
    _refuse(confidence, samples, seed, loop)
    tolerances = spec.tolerances
    by_option = loop or any(option is not None for option in (confidence, samples, seed, tolerances.confidence))
    if not (by_option or spec.toleranced or "tolerances" in spec.model_fields_set):
        return None
    required = tolerances.confidence if confidence is None else confidence
    return Sampling(
        tolerances.samples if samples is None else samples,
        tolerances.seed if seed is None else seed,
        required,
        processes,
        loop if loop is not None else 0 if required is None else tolerances.loop_samples,
    )


def _refuse(confidence: float | None, samples: int | None, seed: int | None, loop: int | None) -> None:
    """Refuse an option that is out of its range."""
    if confidence is not None and not 0.0 < confidence <= 1.0:
        raise InputError(f"--confidence: {confidence:g} is not a probability; expected above 0, at most 1, e.g. 0.95")
    if samples is not None and not FEWEST <= samples <= MOST:
        raise InputError(f"--samples: {samples} is out of range; expected {FEWEST} to {MOST}, e.g. 2000")
    if loop is not None and not 0 <= loop <= 10_000:
        raise InputError(f"--loop-samples: {loop} is out of range; expected 0 to 10000, e.g. 64")
    if seed is not None and not 0 <= seed < 2**32:
        raise InputError(f"--seed: {seed} is out of range; expected 0 to {2**32 - 1}, e.g. 1")
