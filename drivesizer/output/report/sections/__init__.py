"""The sections of a report in their order: the one list that PDF, HTML, XLSX and CSV print.

A new section is a function from the content to blocks, a ``Section`` made of it, and its place below.
May import: ``lines``, ``figures`` and what output may; no kind of report.
"""

from __future__ import annotations

from drivesizer.output.report.sections.appendix import REPEAT, SPEC_FILE
from drivesizer.output.report.sections.assumptions import ASSUMPTIONS, ESTIMATES
from drivesizer.output.report.sections.candidates import CANDIDATES
from drivesizer.output.report.sections.changes import CHANGES
from drivesizer.output.report.sections.checks import CHECKS, DRIVE, PHYSICS
from drivesizer.output.report.sections.cycle import CYCLE, ENERGY, HEAT
from drivesizer.output.report.sections.derivation import DERIVATION
from drivesizer.output.report.sections.loop import LINEAR_LOOPS, LOOP
from drivesizer.output.report.sections.machine import BATTERY, BRAKING, FOLLOWED, MACHINE, PERMITTED, REQUIRED
from drivesizer.output.report.sections.parts import DATA_SHEETS, PARTS
from drivesizer.output.report.sections.pieces import PIECES
from drivesizer.output.report.sections.platform import PLATFORM_NUMBERS
from drivesizer.output.report.sections.reliability import RELIABILITY
from drivesizer.output.report.sections.specification import SPECIFICATION
from drivesizer.output.report.sections.summary import SUMMARY

__all__ = ["SECTIONS"]

SECTIONS = (  # what to buy, whether it holds, how close others come, why; then what it rests on
    SUMMARY,
    REQUIRED,
    PARTS,
    DRIVE,
    CHECKS,
    CHANGES,
    ESTIMATES,
    CYCLE,
    HEAT,
    ENERGY,
    RELIABILITY,
    MACHINE,
    PERMITTED,
    FOLLOWED,
    BATTERY,
    BRAKING,
    LOOP,
    LINEAR_LOOPS,
    CANDIDATES,
    SPECIFICATION,
    DERIVATION,
    PIECES,
    ASSUMPTIONS,
    PHYSICS,
    PLATFORM_NUMBERS,
    REPEAT,
    SPEC_FILE,
    DATA_SHEETS,
)
