"""Loads: one file per kind, with its fields in robot.yaml and the torque at its shaft.

May import: files, physics, equations.
"""
