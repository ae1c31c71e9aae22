"""What the commands share: their options, the spec that they read, what is said while they work."""

from __future__ import annotations

import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Annotated, Any

import typer

from drivesizer.errors import DrivesizerError, InputError

__all__ = [
    "DEFAULT",
    "Chosen",
    "Json",
    "More",
    "NothingFitsError",
    "Profile",
    "Spec",
    "Top",
    "load",
    "progress",
    "tell",
    "working",
]

Spec = Annotated[Path, typer.Argument(metavar="ROBOT.YAML", help="The spec; robot.yaml when not given.")]
Json = Annotated[bool, typer.Option("--json", help="Print one JSON document and nothing else.")]
Top = Annotated[int, typer.Option(min=1, max=1000, help="How many sets to show.")]
Chosen = Annotated[
    str | None, typer.Option("--set", metavar="MOTOR/GEARHEAD", help="Part numbers, e.g. 118752/406764; else the best.")
]
More = Annotated[
    list[str] | None,
    typer.Option("--catalog", metavar="NAME_OR_FILE", help="A catalogue beside the spec's, e.g. my_parts.yaml or all."),
]
DEFAULT = Path("robot.yaml")
Profile = Annotated[
    str | None, typer.Option(help="trapezoid, s-curve, or a CSV file of time and speed; else the spec's.")
]
_PATIENCE = 1.0  # s, after which a person is told what goes on


class NothingFitsError(DrivesizerError):
    """The input is right and no set stands: exit status 1."""


def load(path: Path, more: list[str] | None = None) -> Any:
    """The spec, with further catalogues; their paths count from the current folder."""
    from drivesizer.spec.robot import load_spec

    if path == DEFAULT and not path.exists():
        raise InputError("robot.yaml: there is no such file here; `drivesizer init` writes one to start from")
    spec = load_spec(path)
    if not more:
        return spec
    names = [str(Path(name).absolute()) if name.endswith((".yaml", ".yml")) else name for name in more]
    select = spec.select.model_copy(update={"catalogs": list(dict.fromkeys([*spec.select.catalogs, *names]))})
    return spec.model_copy(update={"select": select})


def tell(messages: tuple[str, ...]) -> None:
    """Print notes to stderr, a line each."""
    for message in messages:
        typer.echo(f"note: {message}", err=True)


@contextmanager
def progress() -> Iterator[Callable[[int, int], None]]:
    """A bar on stderr for a search that lasts longer than a second; nothing for a shorter one."""
    bar: Any = None
    started, looked = time.monotonic(), False

    def told(done: int, total: int) -> None:
        nonlocal bar, looked
        if not looked and time.monotonic() - started > _PATIENCE:
            from rich.console import Console
            from rich.progress import Progress

            looked, console = True, Console(stderr=True)
            if console.is_terminal and not console.is_dumb_terminal:
                bar = Progress(console=console, transient=True)
                bar.add_task("sets examined", total=total)
                bar.start()
        if bar is not None:
            bar.update(bar.task_ids[0], completed=done)

    try:
        yield told
    finally:
        if bar is not None:
            bar.stop()


@contextmanager
def working(on: str) -> Iterator[None]:
    """A line on stderr that says what takes longer than a second; nothing where no person looks."""
    if not sys.stderr.isatty():
        yield
        return
    from rich.console import Console

    console = Console(stderr=True)
    if console.is_dumb_terminal:  # which cannot take a line back
        yield
        return
    line = console.status(f"{on} ...")
    late = threading.Timer(_PATIENCE, line.start)
    late.start()
    try:
        yield
    finally:
        late.cancel()
        late.join()
        line.stop()
