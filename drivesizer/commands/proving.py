"""The recommended drives of a sizing in closed loop, each in its hardest load case, or why they cannot be."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from drivesizer.commands.common import print_notes, simulating
from drivesizer.errors import InputError, NoLoopError

__all__ = ["proven", "proven_axes"]


def proven(result: Any, profile: str | None = None, axis: str = "") -> tuple[Any, Any]:
    """A sizing and its best drive in closed loop; a note and a warning of the sizing where it cannot be simulated.

    Parameters
    ----------
    result
        The sizing.
    profile
        As of ``drivesizer validate``.
    axis
        Name of the axis in its machine, for the note.

    Returns
    -------
    tuple
        The sizing, and the Validation; None where no drive passes or a figure is unknown that the simulation needs.
    """
    from drivesizer.simulate import hardest_case, validate, with_remedies

    if not result.sets:
        return result, None
    best = result.sets[0]
    try:
        proof = validate(result.spec, best, profile=profile, load_case=hardest_case(result.spec, best))
        return result, with_remedies(proof, result.spec, result.sets, profile=profile)
    except NoLoopError as error:
        reason = f"not simulated in {'open' if best.steps else 'closed'} loop: {error}"
        print_notes((f"{axis}: {reason}" if axis else str(error),))
        return replace(result, warnings=(*result.warnings, reason)), None


def proven_axes(sizing: Any, profile: str | None = None) -> tuple[Any, dict[str, Any]]:
    """A machine and the best drive of every axis in closed loop, with the drives that ride on it in its load.

    Parameters
    ----------
    sizing
        The machine.
    profile
        As of :func:`proven`, for every axis.

    Returns
    -------
    tuple
        The MachineSizing, and the Validation of each axis that has one, by the axis' name.

    Raises
    ------
    InputError
        As ``validate``, with the name of the axis.
    """
    axes, proofs = [], {}
    for one in sizing.axes:
        with simulating(f"simulating {one.name} in closed loop"):
            try:
                result, proof = proven(one.result, profile, one.name)
            except InputError as error:
                raise InputError(f"{one.name}: {error}") from None
        axes.append(replace(one, result=result))
        if proof is not None:
            proofs[one.name] = proof
    return replace(sizing, axes=tuple(axes)), proofs
