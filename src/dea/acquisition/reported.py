"""What a command that drives a device says where it fails, and the status that it exits with."""

import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress

from dea.acquisition.interrupts import Interrupted
from dea.acquisition.zero import ZeroNotVerifiedError
from dea.errors import DeviceError, InputError, noted


@contextmanager
def reported(ended: str = "ended by SIGINT") -> Iterator[None]:
    """Say in one line why the block failed, and exit.

    With 1 for a failed acquisition, 2 for bad input, 3 where the output could not be shown to be at
    zero, 130 on a signal: ``ended`` is what one says that met no drive.
    """
    try:
        yield
    except InputError as error:
        say(f"error: {noted(error)}")
        raise SystemExit(2) from None
    except ZeroNotVerifiedError as error:
        say(f"DANGER: {noted(error)}")
        raise SystemExit(3) from None
    except (DeviceError, OSError) as error:
        say(f"failed: {noted(error)}")
        raise SystemExit(1) from None
    except Interrupted as signal:
        say(noted(signal, f"ended by {signal}; the output is at zero"))
        raise SystemExit(130) from None
    except KeyboardInterrupt:  # where no output is this command's to take to zero
        say(ended)
        raise SystemExit(130) from None


def say(text: str) -> None:
    """Print a line to standard error; whether anybody reads it decides nothing."""
    with suppress(OSError):
        print(text, file=sys.stderr, flush=True)
