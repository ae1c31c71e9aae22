"""Reliability of a drive: figures with tolerances, and the probability that every check passes."""

from __future__ import annotations
