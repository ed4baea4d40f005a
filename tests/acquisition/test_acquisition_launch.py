"""Where guardians come from, and what a kill of that process changes."""

import os
import signal
import socket
import subprocess
import time

from dea.acquisition import guardian, launch


def nursery():
    """The process that guardians of this one descend from, once there is one."""
    launch.launch(guardian.nursery).close()
    return launch._nursery[1]


def test_guardians_of_one_process_have_one_origin():
    assert nursery().pid == nursery().pid
    assert os.getpgid(nursery().pid) != os.getpgid(0)


def test_a_killed_origin_is_replaced_when_the_next_guardian_is_asked_for():
    first = nursery()
    first.send_signal(signal.SIGKILL)
    first.wait()
    wire = launch.launch(guardian.nursery)
    second = launch._nursery[1]
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
    monkeypatch.setattr(launch, "_nursery", (os.getpid(), ended, ours))
    with theirs:
        launch.launch(guardian.nursery).close()
        own = launch._nursery[1]
        assert own.pid != ended.pid
        assert own.poll() is None
    own.kill()
    own.wait()
