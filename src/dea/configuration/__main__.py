"""Print the page of the documentation, or a JSON schema: ``python -m dea.configuration``."""

import argparse
import json

from dea.configuration.page import FILES, json_schema, page


def main() -> None:
    """Run the command line."""
    parser = argparse.ArgumentParser(description=__doc__)
    what = parser.add_subparsers(dest="what", required=True)
    what.add_parser("page", help="docs/configuration.md, every key of every file")
    schema = what.add_parser("schema", help="the JSON schema of one file")
    schema.add_argument("file", choices=FILES)
    options = parser.parse_args()
    if options.what == "page":
        print(page(), end="")
    else:
        print(json.dumps(json_schema(options.file), indent=2))


if __name__ == "__main__":
    main()
