"""``drivesizer`` and ``python -m drivesizer``: the command line, with Ctrl-C quiet from the first moment on."""

from __future__ import annotations

import os
import signal

_STOPPED = 130  # exit status after Ctrl-C, as shells have it


def main() -> None:
    """Import the command line and run it; until it is there nothing is open that an interruption could spoil."""
    interruptible = signal.getsignal(signal.SIGINT) is signal.default_int_handler  # unless a shell ignores it
    if interruptible:
        signal.signal(signal.SIGINT, lambda *_: os._exit(_STOPPED))
    from drivesizer.cli import main as run

    if interruptible:
        signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        run()
    except KeyboardInterrupt:  # before a command begins, or a second one while the first is dealt with
        os._exit(_STOPPED)
    finally:
        if interruptible:  # all is written: what Python still puts away is nobody's loss
            signal.signal(signal.SIGINT, lambda *_: os._exit(_STOPPED))


if __name__ == "__main__":
    main()
