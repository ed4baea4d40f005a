"""The file a running acquisition appends to, readable after a crash or damage at any byte.

Entries follow a fixed heading, each as mark, length, CRC-32 and payload. Where an entry is damaged,
the mark shows where the next one begins, so that every intact entry is recovered.
"""

import fcntl
import itertools
import json
import os
import struct
import threading
import zlib
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, nullcontext, suppress
from pathlib import Path
from typing import Any, NamedTuple, Self

import numpy as np

from dea.acquisition.samples import DrivenSamples
from dea.errors import InputError

LONGEST_SYNC = 60.0  # s
HEADING = b"dea acquisition 3\n"
MARK = b"\xa5DEA"
_ENTRY = struct.Struct("<4sII")
# Every integer of a register up to 32 bits is exact as a float64.
_FLOATS = ("applied", "displacement", "write_time", "read_time")
_ROW = np.dtype([(name, "<f8" if name in _FLOATS else "<i8") for name in DrivenSamples._fields])
_NOTE, _SAMPLES = b"N", b"S"


class PartialFile:
    """Append-only log of an acquisition.

    Entries reach the disk (fdatasync) in the order given, in a thread of their own. Entries that
    arrive during one sync share the next, so that a fast device does not wait for the disk.
    """

    def __init__(self, path: Path, note: Mapping[str, Any]) -> None:
        path.parent.mkdir(parents=True, exist_ok=True)
        self.path = path
        self._file = path.open("xb", buffering=0)
        fcntl.flock(self._file, fcntl.LOCK_EX | fcntl.LOCK_NB)  # until it is closed
        self._waiting = bytearray(HEADING)
        self._changed = threading.Condition()
        self._closing = False
        self._heading, self._blocks = note, 0
        self._failure: OSError | None = None
        self._given = self._kept = 0  # samples
        # A daemon: a disk that hangs must not keep the program from ending.
        self._thread = threading.Thread(target=self._sync, name=f"sync {path.name}", daemon=True)
        self._thread.start()
        self.note(note)

    def note(self, content: Mapping[str, Any]) -> None:
        """Append a note as JSON."""
        self._append(_NOTE + json.dumps(content, sort_keys=True).encode())

    def samples(self, samples: DrivenSamples) -> None:
        """Append samples.

        What the file is of follows again after 1, 2, 4, 8, … of these: without it, samples of a
        file whose beginning is damaged could not be placed.
        """
        rows = np.empty(samples.device_index.size, _ROW)
        for name, column in zip(DrivenSamples._fields, samples, strict=True):
            rows[name] = column
        self._append(_SAMPLES + rows.tobytes(), rows.size)
        self._blocks += 1
        if self._blocks.bit_count() == 1:
            self.note(self._heading)

    def kept(self) -> int:
        """Return the number of samples that are on the disk."""
        return self._kept

    def __enter__(self) -> Self:
        return self

    def __exit__(self, kind: type[BaseException] | None, *_: object) -> None:
        # What has ended the drive says more than a disk that fails, too: a voltage may be left on.
        with suppress(OSError) if kind else nullcontext():
            self.close()

    def close(self) -> None:
        """Wait until everything is on the disk; raises OSError if that failed, or lasts."""
        with self._changed:
            self._closing = True
            self._changed.notify()
        self._thread.join(LONGEST_SYNC)
        if self._thread.is_alive():
            raise OSError(f"{self.path}: the disk has not taken it for {LONGEST_SYNC:g} s")
        self._file.close()
        self._check()

    def _append(self, payload: bytes, samples: int = 0) -> None:
        self._check()
        with self._changed:
            self._given += samples
            self._waiting += _ENTRY.pack(MARK, len(payload), zlib.crc32(payload)) + payload
            self._changed.notify()

    def _check(self) -> None:
        if self._failure is not None:
            raise OSError(f"{self.path} cannot be written: {self._failure}") from self._failure

    def _sync(self) -> None:
        while True:
            with self._changed:
                self._changed.wait_for(lambda: self._waiting or self._closing)
                data, self._waiting = bytes(self._waiting), bytearray()
                last, given = self._closing, self._given
            try:
                while data:
                    data = data[self._file.write(data) :]
                os.fdatasync(self._file.fileno())
                self._kept = given
            except OSError as error:
                self._failure = error
                return
            if last:
                return


def refuse_in_use(path: Path) -> None:
    """Refuse a partial file to which another run still writes.

    Raises
    ------
    InputError
        Where it is so.
    """
    if not path.exists():
        return
    with path.open("rb") as file:
        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            raise InputError(
                "another run is writing it",
                file=path,
                remedy="Give this run another --output, or wait until that one has ended.",
            ) from None


def set_aside(path: Path) -> None:
    """Rename the partial file of an earlier run, if there is one, to a numbered name.

    Raises
    ------
    InputError
        As :func:`refuse_in_use`.
    """
    refuse_in_use(path)
    if path.exists():
        numbers = itertools.count(1)
        free = (path.with_name(f"{path.stem}.{n}{path.suffix}") for n in numbers)
        path.rename(next(name for name in free if not name.exists()))


def where_kept(partial: Path) -> str:
    """Say where every sample is, for an error that costs the record."""
    return f"Every sample is in {partial}: recover it."


@contextmanager
def samples_kept(partial: Path) -> Iterator[None]:
    """Add :func:`where_kept` to an error of the disk that ends the block, if they are there."""
    try:
        yield
    except OSError as error:
        if partial.exists():
            error.add_note(where_kept(partial))
        raise


class Recovered(NamedTuple):
    """What a partial file holds; a note that is there several times counts once.

    ``damaged`` counts the stretches of bytes that belong to no intact entry, the end of a file that
    was cut short among them.
    """

    notes: list[dict[str, Any]]
    samples: DrivenSamples
    damaged: int


def recover(path: Path) -> Recovered:
    """Read every intact entry of a partial file.

    Raises
    ------
    InputError
        Where the file is not a partial file of an acquisition.
    """
    try:
        data = path.read_bytes()
    except OSError as error:
        raise InputError(
            f"cannot be read: {error}",
            file=path,
            remedy="Correct the path, or get the right to read it.",
        ) from error
    payloads, damaged = _intact(data)
    if not (data.startswith(HEADING) or payloads):
        raise InputError(
            "not a partial file of an acquisition",
            file=path,
            remedy="Name the file that ends in .partial beside the record.",
        )
    noted = dict.fromkeys(payload[1:] for payload in payloads if payload[:1] == _NOTE)
    notes = [json.loads(each) for each in noted]
    blocks = [np.frombuffer(payload[1:], _ROW) for payload in payloads if payload[:1] == _SAMPLES]
    rows = np.concatenate(blocks) if blocks else np.empty(0, _ROW)
    samples = DrivenSamples(*(rows[name].copy() for name in DrivenSamples._fields))
    return Recovered(notes, samples, damaged)


def _intact(data: bytes) -> tuple[list[bytes], int]:
    """Return the payloads of the intact entries, and the number of damaged stretches."""
    payloads, damaged = [], int(not data.startswith(HEADING))
    place = len(HEADING)
    while place < len(data):
        payload = _entry(data, place)
        if payload is not None:
            payloads.append(payload)
            place += _ENTRY.size + len(payload)
            continue
        damaged += 1
        # The mark may occur in a payload too; the entry it seems to begin has no right CRC then.
        place = data.find(MARK, place + 1)
        while place >= 0 and _entry(data, place) is None:
            place = data.find(MARK, place + 1)
        if place < 0:
            break
    return payloads, damaged


def _entry(data: bytes, place: int) -> bytes | None:
    """Return the payload of the entry at ``place``, or None if it is cut short or damaged."""
    if place + _ENTRY.size > len(data):
        return None
    mark, length, crc = _ENTRY.unpack_from(data, place)
    start = place + _ENTRY.size
    payload = data[start : start + length]
    # Zeros after a mark would read as an empty entry.
    intact = mark == MARK and 0 < length == len(payload) and zlib.crc32(payload) == crc
    return payload if intact else None
