"""``drivesizer serve``."""

from __future__ import annotations

import json
import os
import secrets
import signal
import socket
import threading
import webbrowser
from functools import partial
from pathlib import Path
from typing import Annotated

import typer

from drivesizer.commands.common import DEFAULT, STOPPED, Spec, whole_option
from drivesizer.errors import InputError, reason_of
from drivesizer.files.cache import digest_of, folder

_LOCAL = "127.0.0.1"


def serve(
    spec: Spec = DEFAULT,
    port: Annotated[int, whole_option("--port", 8000, 0, 65535, meaning="Port; 0 takes a free one.")] = 0,
    browser: Annotated[bool, typer.Option("--browser/--no-browser", help="Whether to open the page.")] = True,
) -> None:
    """Open a page on this machine where the drive follows the figures as they change."""
    # Until it serves Ctrl-C ends this process at once, and what it has started: a library being loaded may swallow it
    if signal.getsignal(signal.SIGINT) is signal.default_int_handler:
        signal.signal(signal.SIGINT, lambda *_: os._exit(STOPPED))
    if os.path.isdir(spec):  # noqa: PTH112 - of a name that is too long pathlib raises
        raise InputError(f"{spec}: is a folder; expected a spec, for example {spec / DEFAULT}")
    # With its protocol named: only then are answers sent without waiting for acknowledgements, 40 ms each.
    with socket.socket(socket.AF_INET, socket.SOCK_STREAM, socket.IPPROTO_TCP) as listening:
        if os.name == "posix":  # a port that was in use a moment ago is free; elsewhere this would share one in use
            listening.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        state_file = folder() / f"serve-{digest_of(os.fsencode(spec.absolute()))}.json"
        before, token = _address_before(state_file)
        target_port = port or before
        try:
            listening.bind((_LOCAL, target_port))
        except OSError as error:
            if port:
                reason = reason_of(error)
                raise InputError(f"--port: {port} cannot be used ({reason}); expected another, or 0") from None
            listening.bind((_LOCAL, 0))  # as another page of this spec is served
        listening.listen(128)
        port = listening.getsockname()[1]
        if port != before:
            token = secrets.token_urlsafe(24)
        if port == target_port or not before:
            _keep(state_file, json.dumps({"port": port, "token": token}))
        address, way = f"http://{_LOCAL}:{port}/{token}/", state_file.with_name(f"{state_file.stem}-{port}.html")
        typer.echo(f"{spec}: {address}\nstop with Ctrl-C")
        from drivesizer.commands.setup import starter
        from drivesizer.live.server import serve as served

        try:  # the browser waits until the server answers, for it listens already
            opened = partial(_open, way, address) if browser else lambda: None
            terminated = served(spec.absolute(), token, listening, starter("wheeled_vehicle"), opened)
        finally:
            way.unlink(missing_ok=True)
    if terminated:
        signal.raise_signal(signal.SIGTERM)  # the status is that of the system


def _address_before(path: Path) -> tuple[int, str]:
    """Port and token by which the page of a spec was served before, so that its tab goes on; 0 where unknown."""
    try:
        state = json.loads(path.read_text(encoding="utf-8"))
        own = path.stat().st_mode & 0o077 == 0  # as this user alone can read it
        return (int(state["port"]), str(state["token"])) if own else (0, "")
    except (OSError, ValueError, TypeError, KeyError):
        return 0, ""


def _keep(path: Path, text: str) -> bool:
    """Keep a text where this user alone can read it; whether that was possible."""
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        path.unlink(missing_ok=True)
        with os.fdopen(os.open(path, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o600), "w") as file:
            file.write(text)
    except OSError:
        return False
    return True


def _open(path: Path, address: str) -> None:
    """Open the page by a file that this user alone can read: others see with which words a browser is started."""
    if _keep(path, f'<meta http-equiv="refresh" content="0;url={address}">\n'):
        threading.Thread(target=webbrowser.open, args=(path.as_uri(),), daemon=True).start()
