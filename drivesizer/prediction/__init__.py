"""A motor with its gearhead, or an actuator, at the bench: what will be measured, with bands.

May import: physics, catalog, results, search; not output.
"""
