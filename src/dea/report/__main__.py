"""Write ``results/report.html`` from the results that are there: ``make report``."""

import argparse
import sys

from dea import provenance
from dea.errors import InputError
from dea.report.page import write


def main(arguments: list[str] | None = None) -> None:
    """Write the report and say how large it is."""
    argparse.ArgumentParser(prog="python -m dea.report", description=__doc__).parse_args(arguments)
    file = provenance.RESULTS / "report.html"
    try:
        write(file)
    except InputError as error:
        print(f"error: {error}", file=sys.stderr)
        raise SystemExit(2) from None
    print(f"{file}: {file.stat().st_size / 1e6:.1f} MB")


if __name__ == "__main__":
    main()
