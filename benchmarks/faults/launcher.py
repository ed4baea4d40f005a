"""Starts the command in processes of their own: ``python -m benchmarks.faults.launcher``.

Reads requests from standard input, one JSON object a line, and writes a line when a process has
begun and when it has ended. A process begins as ``python -m dea.acquisition``, or, where a thousand
starts would be most of a campaign's time, as a fork of this one, which has imported the library.
"""

import json
import os
import runpy
import select
import sys
from typing import Any


def main() -> None:
    """Serve requests until standard input closes."""
    import xarray  # noqa: F401

    running: dict[int, int] = {}
    buffer = b""
    open_input = True
    while open_input or running:
        ready, _, _ = select.select([0] if open_input else [], [], [], 0.01)
        if ready:
            chunk = os.read(0, 65536)
            open_input = bool(chunk)
            *lines, buffer = (buffer + chunk).split(b"\n")
            for line in lines:
                request = json.loads(line)
                process = os.fork()
                if process == 0:
                    _become(request)
                running[process] = request["id"]
                _say(id=request["id"], pid=process)
        while running:
            process, status = os.waitpid(-1, os.WNOHANG)
            if process == 0:
                break
            _say(id=running.pop(process), status=os.waitstatus_to_exitcode(status))


def _say(**message: int) -> None:
    os.write(1, json.dumps(message).encode() + b"\n")


def _become(request: dict[str, Any]) -> None:
    """Turn this process into the command; never returns."""
    os.setpgid(0, 0)  # in the session of its parent, or SIGTSTP would not stop it
    os.environ.update(request["environment"])
    os.dup2(os.open(os.devnull, os.O_RDONLY), 0)
    printed = _full_pipe() if request["stuck_terminal"] else _file(request["printed"])
    os.dup2(printed, 1)
    os.dup2(printed, 2)
    arguments = ["-m", "dea.acquisition", *request["arguments"]]
    if request["as_command"]:
        os.execv(sys.executable, [sys.executable, *arguments])
    from benchmarks.faults.host_faults import apply

    apply()
    sys.argv = ["dea.acquisition", *request["arguments"]]
    status = 1
    try:
        runpy.run_module("dea.acquisition", run_name="__main__", alter_sys=True)
        status = 0
    except SystemExit as end:
        status = _status(end.code)
    except BaseException:
        sys.excepthook(*sys.exc_info())
    finally:
        _flush()
        os._exit(status)


def _status(code: object) -> int:
    if isinstance(code, str):
        print(code, file=sys.stderr)
    return code if isinstance(code, int) else int(code is not None)


def _flush() -> None:
    for stream in (sys.stdout, sys.stderr):
        try:
            stream.flush()
        except OSError:
            continue


def _file(path: str) -> int:
    return os.open(path, os.O_WRONLY | os.O_CREAT | os.O_APPEND)


def _full_pipe() -> int:
    """Return the end of a full pipe: who writes to it waits for ever."""
    reading, writing = os.pipe()
    os.set_inheritable(reading, True)
    os.set_blocking(writing, False)
    try:
        while True:
            os.write(writing, bytes(4096))
    except BlockingIOError:
        os.set_blocking(writing, True)
    return writing


if __name__ == "__main__":
    main()
