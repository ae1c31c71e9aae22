"""The report as one HTML file: text, tables, mathematics and figures that answer to the pointer and the keys."""

from __future__ import annotations
