"""The command line: parse, call, print.

Exit status: 0 a drive was found or passes, also where that is unknown for lack of a figure, 1 none does, 2 the input
is wrong or an output cannot be written (one line says where and what), 70 drivesizer itself is at fault, 130 it
was interrupted. Results go to stdout, warnings and errors to stderr; failures are reported in `commands.ends`.
"""

from __future__ import annotations

import gc
import importlib
import os
import sys
import warnings
from collections.abc import Collection
from functools import cache
from typing import TYPE_CHECKING, Annotated

import typer

from drivesizer.commands.ends import ended, parsed, with_values
from drivesizer.errors import InputError, printable
from drivesizer.version import __version__

if TYPE_CHECKING:
    app: typer.Typer  # of ``__getattr__``

# in the order of use: where a command is, short help and an example
_COMMANDS = {
    "init": ("commands.setup", "Write a commented robot.yaml to start from.",
             "init --kind wheeled_vehicle -o robot.yaml"),
    "size": ("commands.sizing", "Find the drive, the next best, and why the others fail.",
             "size examples/sps_robot.yaml --top 3 --objective price"),
    "explain": ("commands.sizing", "Why a combination of motor and gearhead passes or fails.",
                "explain examples/sps_robot.yaml --motor 118743 --gearhead 406764"),
    "validate": ("commands.validate", "Simulate a drive over its profile in closed loop.",
                 "validate examples/sps_robot.yaml --profile trapezoid"),
    "commission": ("commands.commission", "The gains as the controller takes them, in its own units.",
                   "commission examples/sps_robot.yaml --set control.bandwidth=10Hz -o drive.dcf"),
    "drive": ("commands.validate", "Drive a platform along a trajectory, wheel by wheel.",
              "drive examples/sps_platform.yaml examples/sps_way.csv"),
    "report": ("commands.sizing", "Write the report: PDF, HTML, XLSX, CSV or JSON.",
               "report examples/sps_robot.yaml -o report.pdf"),
    "quote": ("commands.sizing", "What to order: numbers, prices, sellers, and what is missing.",
              "quote examples/sps_robot.yaml -o quote.csv"),
    "predict": ("commands.predict", "Predict what is measured of a set at the bench, with bands.",
                "predict 118752 --gearhead 406764 --voltage '24 V' --load '0.5 N*m'"),
    "identify": ("commands.identify", "A drive's figures out of its log, with bands.",
                 "identify log.csv --motor 118752 -o fit.svg"),
    "compare": ("commands.identify", "A machine's log beside its sizing, check by check.",
                "compare log.csv --spec robot.yaml"),
    "export": ("commands.export", "Write the drive for MuJoCo, URDF, Gazebo, ROS or as an FMU.",
               "export examples/sps_robot.yaml --format mjcf -o drive.xml"),
    "serve": ("live.command", "A page in the browser where the drive follows the figures.", "serve robot.yaml"),
    "design": ("commands.design", "Find the best machine with its drive: free figures, limits, a front.",
               "design examples/sps_robot.yaml --free 'motion.speed=[1.5 m/s, 1.6 m/s]'"),
    "study": ("commands.study", "Size every variant of a spec: tables and maps.", "study examples/study.yaml"),
    "equations": ("commands.setup", "The paper's equations, as printed and as computed.", "equations 10"),
    "schema": ("commands.setup", "JSON Schema of robot.yaml, a catalogue or the JSON report.",
               "schema > robot.schema.json"),
    "doctor": ("commands.setup", "Check this installation.", "doctor"),
}  # fmt: skip
_GROUPS = {"catalog": ("commands.catalog", "Search, check, import and export catalogues.")}


def _version(wanted: bool) -> None:
    if wanted:
        typer.echo(f"drivesizer {__version__}")
        raise typer.Exit


def _root(
    version: Annotated[
        bool, typer.Option("--version", callback=_version, is_eager=True, help="Print the version and stop.")
    ] = False,
) -> None:
    """Size electric drives from real catalogues: one robot.yaml in, the drive with every check out."""


def _unloaded() -> None:
    """A command of which only the name and the short help are wanted."""


def _with_commands(names: Collection[str], *, loaded: bool = True) -> typer.Typer:
    """The command line with some of its commands, whose modules are loaded unless only their names are wanted."""
    made = typer.Typer(
        name="drivesizer",
        no_args_is_help=True,
        rich_markup_mode=None,
        pretty_exceptions_enable=False,
        context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 100},
    )
    made.callback()(_root)
    for name, (module, short, example) in _COMMANDS.items():
        if name in names:
            command = getattr(importlib.import_module(f"drivesizer.{module}"), name) if loaded else _unloaded
            made.command(name, short_help=short, epilog=f"Example: drivesizer {example}")(command)
    for name, (module, short) in _GROUPS.items():
        if name in names:
            group = importlib.import_module(f"drivesizer.{module}").app if loaded else typer.Typer(callback=_unloaded)
            made.add_typer(group, name=name, short_help=short)
    return made


@cache
def _whole() -> typer.Typer:
    return _with_commands(_COMMANDS | _GROUPS)


def __getattr__(name: str) -> typer.Typer:
    """``app``, all of the command line, loaded where a program imports it."""
    if name == "app":
        return _whole()
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


def _command_line_of(arguments: list[str]) -> typer.Typer:
    """The command line with the one command that is run: loading the others would take as long as to parse."""
    completes = "_DRIVESIZER_COMPLETE" in os.environ  # a shell wants to know what may stand where the cursor is
    if completes:
        arguments = (os.environ.get("_TYPER_COMPLETE_ARGS") or os.environ.get("COMP_WORDS", "")).split()[1:]
    named = {*arguments[:1]}
    if named & (_COMMANDS.keys() | _GROUPS.keys()):
        return _with_commands(named)
    if completes or named & {"-h", "--help", "--version"}:
        return _with_commands(_COMMANDS | _GROUPS, loaded=False)
    return _whole()


def main() -> None:
    """Run the command line; every failure ends in one line and a status."""
    os.environ.setdefault("PYDANTIC_DISABLE_PLUGINS", "__all__")  # else every package is searched for some
    warnings.showwarning = lambda message, *_, **__: print(f"note: {printable(str(message))}", file=sys.stderr)
    warnings.filterwarnings("ignore", category=RuntimeWarning)  # a figure beyond all numbers is reported as unknown
    status = ended(_run)
    gc.freeze()  # else Python looks through all objects twice more as it ends: a seventh of a `drivesizer size`
    sys.exit(status)


def _run() -> int | None:
    if sys.flags.optimize > 1:
        raise InputError("Python runs without docstrings (-OO, PYTHONOPTIMIZE=2), of which drivesizer reads its "
                         "equations; expected at most -O, PYTHONOPTIMIZE=1")  # fmt: skip
    words = with_values(sys.argv[1:])
    return parsed(lambda: _command_line_of(words)(args=words, standalone_mode=False), _whole, words)
