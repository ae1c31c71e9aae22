"""``python -m drivesizer.catalog.estimates > fitted.json``: every law, fitted over all catalogues that ship."""

from __future__ import annotations

from drivesizer.catalog import load, shipped
from drivesizer.catalog.estimates.estimate import fits, written

if __name__ == "__main__":
    print(written(fits(load(list(shipped())))), end="")
