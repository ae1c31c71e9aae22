"""A motor with its gearhead, or an actuator, at the bench: what will be measured, with bands.

May import: physics, catalog, spec, load_cases, results, search; not output.
"""
