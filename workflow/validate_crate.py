"""Validate an RO-Crate without a network: ``python validate_crate.py FOLDER``.

Runs in an environment of its own (``workflow/validator.txt``), since roc-validator wants older
packages. The context of RO-Crate 1.1 is that which an old release of ``rocrate`` ships.
"""

import sys
from importlib.resources import files
from typing import Any

import requests
from rocrate_validator import services
from rocrate_validator.models import Severity, ValidationSettings
from rocrate_validator.utils.http import HttpRequester

CONTEXT = "https://w3id.org/ro/crate/1.1/context"
PROFILE = "provenance-run-crate"


def shipped(requester: HttpRequester, url: str, **options: Any) -> requests.Response:
    """Answer the only request that validation needs, from a package."""
    if url != CONTEXT:
        raise ConnectionError(f"validation is to do without a network, and asks for {url}")
    answer = requests.Response()
    answer.status_code, answer.url = 200, url
    answer.headers["Content-Type"] = "application/ld+json"
    answer._content = (files("rocrate") / "data" / "ro-crate.jsonld").read_bytes()
    return answer


def main() -> None:
    """Print every issue of the severity REQUIRED; exit with 1 where there is one."""
    HttpRequester.get = shipped
    settings = ValidationSettings(
        rocrate_uri=sys.argv[1],
        profile_identifier=PROFILE,
        requirement_severity=Severity.REQUIRED,
    )
    issues = services.validate(settings).get_issues()
    for issue in issues:
        print(f"{issue.severity.name}: {issue.check.identifier}: {issue.message}")
    print(f"{sys.argv[1]}: {len(issues)} REQUIRED issues of {PROFILE}")
    raise SystemExit(bool(issues))


if __name__ == "__main__":
    main()
