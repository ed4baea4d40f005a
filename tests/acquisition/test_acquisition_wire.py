"""Messages between recorder and guardian: whole, late, and to a reader that has stopped."""

import fcntl
import resource
import socket
import time
from threading import Thread

import pytest

from dea.acquisition.guardian import _deliver
from dea.acquisition.wire import Wire

# More than a socket holds.
LONG = bytes(range(256)) * 20_000


@pytest.fixture
def ends():
    """Both ends of a wire."""
    first, second = map(Wire, socket.socketpair())
    yield first, second
    first.close()
    second.close()


def taken(wire, seconds=5.0):
    """Everything that comes until the other end closes."""
    found, end = [], time.monotonic() + seconds
    while not wire.closed and time.monotonic() < end:
        wire.wait(0.05)
        found += wire.take()
    return found


def test_a_long_message_waits_for_its_reader_and_arrives_whole(ends):
    writer, reader = ends
    writer.post("first", 1)
    writer.post("long", LONG)
    assert writer.unsent
    last = Thread(target=_deliver, args=(writer, 5.0))
    last.start()
    assert taken(reader) == [("first", 1), ("long", LONG)]
    last.join()
    assert writer.closed


def test_a_reader_that_has_stopped_is_waited_for_no_longer_than_agreed(ends):
    writer, _ = ends
    writer.post("long", LONG)
    begun = time.monotonic()
    _deliver(writer, 0.3)
    assert 0.3 <= time.monotonic() - begun < 2.0
    assert writer.closed


def test_a_closed_end_is_noticed_and_nothing_is_sent_to_it(ends):
    writer, reader = ends
    reader.close()
    assert writer.take() == []
    assert writer.closed
    writer.post("late")
    assert not writer.unsent


def test_a_program_may_have_more_than_a_thousand_files_open(ends):
    first, reader = ends
    soft, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
    resource.setrlimit(resource.RLIMIT_NOFILE, (min(2048, hard), hard))
    try:
        writer = Wire(socket.socket(fileno=fcntl.fcntl(first._end, fcntl.F_DUPFD, 1100)))
        writer.wait(0.0)
        writer.post("first", 1)
        writer.close()
    finally:
        resource.setrlimit(resource.RLIMIT_NOFILE, (soft, hard))
    reader.wait(5.0)
    assert reader.take() == [("first", 1)]
