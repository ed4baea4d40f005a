"""What the programs of the benchmarks share: how they refuse, and what numbers they take."""

import argparse
import math
import subprocess
import sys
from collections.abc import Callable
from typing import NoReturn

from dea.errors import InputError


class PeerError(Exception):
    """A program that ours is compared with failed; the message is one line."""


def positive(text: str) -> int:
    """Return the number that an option is given, from 1 on."""
    number = int(text)
    if number < 1:
        raise argparse.ArgumentTypeError(f"{number} is not positive")
    return number


def seed_number(text: str) -> int:
    """Return the seed that an option is given, from 0 on."""
    number = int(text)
    if number < 0:
        raise argparse.ArgumentTypeError(f"{number} is negative")
    return number


def positive_time(text: str) -> float:
    """Return the time that an option is given, which is positive."""
    number = float(text)
    if not 0.0 < number < math.inf:
        raise argparse.ArgumentTypeError(f"{text} is no time above 0")
    return number


def add_store(parser: argparse.ArgumentParser) -> None:
    """Add the option without which the documents keep what they quote."""
    parser.add_argument("--store", action="store_true", help="keep it in docs/measured")


def run(main: Callable[[], int | None]) -> NoReturn:
    """Run a program and exit: with its status, or with 2 and one line where it cannot run."""
    try:
        status = main()
    except (InputError, PeerError, subprocess.CalledProcessError) as error:
        print(f"error: {error}", file=sys.stderr)
        status = 2
    sys.exit(status)


def peer(name: str, command: list[str]) -> str:
    """Return what a peer's program prints.

    Raises
    ------
    PeerError
        If it fails; the message ends with the last line that it wrote.
    """
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode:
        said = done.stderr.strip().splitlines() or [f"it ended with status {done.returncode}"]
        raise PeerError(f"{name} failed: {said[-1]}")
    return done.stdout
