"""One test over many rows, all of which are tried: what one costs by itself is more than its assertion."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import pytest

__all__ = ["hold"]


def hold(check: Callable[..., None], rows: Mapping[str, tuple[Any, ...]]) -> None:
    """Call a check with each row, and fail with all rows that it fails on, by their names."""
    assert rows
    failed = []
    for name, row in rows.items():
        try:
            check(*row)
        except (Exception, pytest.fail.Exception) as error:
            failed.append(f"{name}: {type(error).__name__} {error}")
    assert not failed, f"{len(failed)} of {len(rows)}:\n" + "\n".join(failed)
