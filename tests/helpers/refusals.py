"""What is said of a wrong input: one line."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from drivesizer.errors import InputError

__all__ = ["refusal"]


def refusal(
    call: Callable[[], object],
    kind: type[Exception] | tuple[type[Exception], ...] = InputError,
    match: str | None = None,
) -> str:
    """The message with which a call ends, which has no second line."""
    with pytest.raises(kind, match=match) as error:
        call()
    line = str(error.value)
    assert line and "\n" not in line
    return line
