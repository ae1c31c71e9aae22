"""From a log of a real drive to its figures with bands, and the log beside what a sizing promised.

May import: control, kernel, load_cases, spec, results, catalog, physics, files, units; not output.
"""
