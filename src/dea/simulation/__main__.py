"""Print the page of the documentation on the laws: ``python -m dea.simulation``."""

import argparse
from collections.abc import Sequence

from dea.simulation.page import page


def main(arguments: Sequence[str] | None = None) -> None:
    """Print ``docs/laws.md``."""
    argparse.ArgumentParser(prog="python -m dea.simulation", description=__doc__).parse_args(
        arguments
    )
    print(page(), end="")


if __name__ == "__main__":
    main()
