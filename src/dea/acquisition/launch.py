"""Starting guardians: processes out of reach of the recorder's terminal.

A fork server, one for each recorder, has the guardian's code loaded and forks a guardian when
asked, within milliseconds. It has one thread and does nothing else. A guardian has a session of its
own, so that no signal of the terminal (Ctrl-C, Ctrl-Z, Ctrl-\\, hang-up) reaches it.
"""

import os
import signal
import socket
import subprocess
import sys
import threading
from collections.abc import Callable
from contextlib import suppress

from dea.acquisition.wire import Wire

_PROGRAM = "import sys; from {} import {} as serve; serve(int(sys.argv[1]))"
_lock = threading.Lock()
# Of this process: its number, the fork server and the way to it.
_fork_server: tuple[int, subprocess.Popen[bytes], socket.socket] | None = None


def launch(serve: Callable[[int], None], *, anew: bool = False) -> Wire:
    """Start a guardian and return the way to it; ``anew`` from a fork server that is new, too.

    ``serve`` is the function of a module that serves the socket with the number it is given.
    """
    _open_standard_error()
    ours, theirs = socket.socketpair()
    with _lock, theirs:
        try:
            _ask(_control(serve, anew=anew), theirs)
        except OSError:  # the fork server was killed just now
            _ask(_control(serve, anew=True), theirs)
    return Wire(ours)


def serve_forks(control: socket.socket, guard: Callable[[Wire], None]) -> None:
    """Fork a process that runs ``guard`` for each way to a recorder that ``control`` hands over."""
    # The kernel removes children that have ended, since nobody waits for them here.
    signal.signal(signal.SIGCHLD, signal.SIG_IGN)
    while True:
        _, handles, _, _ = socket.recv_fds(control, 1, 2)
        if not handles:
            return
        end, errors = handles
        if os.fork() == 0:
            control.close()
            os.setsid()
            os.dup2(errors, 2)
            os.close(errors)
            try:
                guard(Wire(socket.socket(fileno=end)))
            finally:
                os._exit(0)
        for handle in handles:
            os.close(handle)


def _open_standard_error() -> None:
    """Open it to nowhere where it was closed: a file of the record would take its number.

    An alarm, which is written to that number, would then go into the file.
    """
    try:
        os.fstat(2)
    except OSError:
        nowhere = os.open(os.devnull, os.O_WRONLY)
        if nowhere != 2:
            os.dup2(nowhere, 2)
            os.close(nowhere)
        os.set_inheritable(2, True)  # the fork server's own, too


def _ask(control: socket.socket, end: socket.socket) -> None:
    socket.send_fds(control, [b"g"], [end.fileno(), 2])


def _control(serve: Callable[[int], None], *, anew: bool = False) -> socket.socket:
    global _fork_server
    if _fork_server is None or anew or _fork_server[0] != os.getpid() or _ended(_fork_server[1]):
        ours, theirs = socket.socketpair()
        program = _PROGRAM.format(serve.__module__, serve.__qualname__)
        with theirs:
            process = subprocess.Popen(
                [sys.executable, "-c", program, str(theirs.fileno())],
                pass_fds=[theirs.fileno()], start_new_session=True,
                stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL,
            )  # fmt: skip
        if _fork_server is not None:
            if _fork_server[0] == os.getpid():
                _fork_server[1].kill()
            with suppress(OSError):
                _fork_server[2].close()
        _fork_server = os.getpid(), process, ours
    return _fork_server[2]


def _ended(fork_server: subprocess.Popen[bytes]) -> bool:
    """Return whether it was killed: a fork of it may still hold its end, and would ask nobody."""
    return fork_server.poll() is not None
