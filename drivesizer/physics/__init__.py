"""Formulas on plain figures and arrays: load cycles, current, heat, belts, batteries; no spec, no catalogue.

May import: errors, ranges, units, files.
"""
