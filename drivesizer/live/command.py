"""``drivesizer serve``."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from drivesizer.commands.common import DEFAULT, Spec
from drivesizer.errors import InputError, reason_of

__all__ = ["serve"]

_REQUESTS = 64  # at the same time; more are refused at once
_LOCAL = "127.0.0.1"


def serve(
    spec: Spec = DEFAULT,
    port: Annotated[int, typer.Option(min=0, max=65535, help="Port; 0 takes a free one.")] = 0,
    browser: Annotated[bool, typer.Option("--browser/--no-browser", help="Whether to open the page.")] = True,
) -> None:
    """Open a page on this machine where the drive follows the figures as they change."""
    import os
    import secrets
    import socket

    with socket.socket() as listening:
        if os.name == "posix":  # a port that was in use a moment ago is free; elsewhere this would share one in use
            listening.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            listening.bind((_LOCAL, port))
        except OSError as error:
            raise InputError(f"--port: {port} cannot be used ({reason_of(error)}); expected another, or 0") from None
        listening.listen(128)
        port = listening.getsockname()[1]
        token = secrets.token_urlsafe(24)
        address = f"http://{_LOCAL}:{port}/{token}/"
        typer.echo(f"{spec}: {address}\nstop with Ctrl-C")
        _run(spec, token, port, listening, address if browser else "")


def _run(spec: Path, token: str, port: int, listening: object, address: str) -> None:
    import asyncio
    from contextlib import suppress

    import uvicorn

    from drivesizer.commands.starting import starter
    from drivesizer.live.server import application

    app = application(spec.absolute(), token, port, starter("wheeled_vehicle"))
    config = uvicorn.Config(app, log_level="error", access_log=False, server_header=False, date_header=False,
                            limit_concurrency=_REQUESTS, timeout_graceful_shutdown=1, lifespan="on")  # fmt: skip
    server = uvicorn.Server(config)
    if address:
        _opened(address)
    with suppress(KeyboardInterrupt):  # the way in which it ends
        asyncio.run(server.serve(sockets=[listening]))  # type: ignore[list-item]


def _opened(address: str) -> None:
    """Open the page; the browser waits until the server answers, for it listens already."""
    import threading
    import webbrowser

    threading.Thread(target=webbrowser.open, args=(address,), daemon=True).start()
