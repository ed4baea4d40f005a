"""Write ``results/report.html`` from the results that are there: ``make report``."""

import sys

from dea import provenance
from dea.errors import InputError
from dea.report.page import write


def main() -> None:
    """Write the report and say how large it is."""
    file = provenance.RESULTS / "report.html"
    try:
        write(file)
    except InputError as error:
        print(f"error: {error}", file=sys.stderr)
        raise SystemExit(2) from None
    print(f"{file}: {file.stat().st_size / 1e6:.1f} MB")


if __name__ == "__main__":
    main()
