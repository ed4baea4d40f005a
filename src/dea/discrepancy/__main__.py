"""Print the page of the documentation on the thresholds: ``python -m dea.discrepancy``."""

import argparse
from collections.abc import Sequence

from dea.discrepancy.thresholds_page import page


def main(arguments: Sequence[str] | None = None) -> None:
    """Print ``docs/method/thresholds.md``."""
    argparse.ArgumentParser(prog="python -m dea.discrepancy", description=__doc__).parse_args(
        arguments
    )
    print(page(), end="")


if __name__ == "__main__":
    main()
