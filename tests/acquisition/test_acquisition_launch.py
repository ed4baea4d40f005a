"""Where guardians come from, and what a kill of that process changes."""

import os
import signal
import socket
import subprocess
import time

from dea.acquisition import guardian, launch


def fork_server():
    """The process that guardians of this one descend from, once there is one."""
    launch.launch(guardian.fork_server).close()
    return launch._fork_server[1]


def test_guardians_of_one_process_have_one_origin():
    assert fork_server().pid == fork_server().pid
    assert os.getpgid(fork_server().pid) != os.getpgid(0)


def test_a_killed_origin_is_replaced_when_the_next_guardian_is_asked_for():
    first = fork_server()
    first.send_signal(signal.SIGKILL)
    first.wait()
    wire = launch.launch(guardian.fork_server)
    second = launch._fork_server[1]
    assert second.pid != first.pid
    assert second.poll() is None
    # The guardian is there and waits for its job: it has not closed its end.
    time.sleep(0.5)
    assert wire.take() == []
    assert not wire.closed
    wire.close()


def test_a_killed_origin_is_replaced_though_a_fork_of_it_still_holds_its_end(monkeypatch):
    ended = subprocess.Popen(["true"])
    ended.wait()
    ours, theirs = socket.socketpair()
    monkeypatch.setattr(launch, "_fork_server", (os.getpid(), ended, ours))
    with theirs:
        launch.launch(guardian.fork_server).close()
        own = launch._fork_server[1]
        assert own.pid != ended.pid
        assert own.poll() is None
    own.kill()
    own.wait()
