"""Figures that no data sheet gives, estimated from peers: log-linear laws with bands.

May import: catalog's columns and tables.

``laws`` declares which figure follows from which others within which class of parts; ``fit`` fits them over the shipped
catalogues and measures each on families that were left out; ``fitted.json`` keeps what was found
(``python -m drivesizer.catalog.estimates`` prints it anew); ``estimate`` applies it.
"""

from __future__ import annotations

from drivesizer.catalog.estimates.estimate import Estimate, as_records, estimates_of

__all__ = ["Estimate", "as_records", "estimates_of"]
