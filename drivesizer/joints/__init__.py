"""Joints of a robot description as loads: trajectory, inverse dynamics, masses of the drives that ride on the links.

May import: files, physics, equations, platform, loads, spec, results, load_cases.
"""
