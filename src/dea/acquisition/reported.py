"""What a command that drives a device says where it fails, and the status that it exits with."""

import sys
from collections.abc import Iterator
from contextlib import contextmanager

from dea.acquisition.interrupts import Interrupted
from dea.acquisition.zero import ZeroNotVerifiedError
from dea.errors import DeviceError, InputError


@contextmanager
def reported() -> Iterator[None]:
    """Say in one line why the block failed, and exit.

    With 1 for a failed acquisition, 2 for bad input, 3 where the output could not be shown to be at
    zero, 130 on a signal.
    """
    try:
        yield
    except InputError as error:
        print(f"error: {error}", file=sys.stderr)
        raise SystemExit(2) from None
    except ZeroNotVerifiedError as error:
        told = "A guardian goes on trying: see `python -m dea.acquisition status`."
        print(f"DANGER: {error} {told}", file=sys.stderr)
        raise SystemExit(3) from None
    except (DeviceError, OSError) as error:
        print(". ".join([f"failed: {error}", *getattr(error, "__notes__", [])]), file=sys.stderr)
        raise SystemExit(1) from None
    except Interrupted as signal:
        print(f"ended by {signal}; the output is at zero", file=sys.stderr)
        raise SystemExit(130) from None
