"""The page of the documentation that lists the thresholds of a diagnosis."""

from collections.abc import Iterator
from dataclasses import asdict
from typing import Any

from dea.configuration import discrepancy as configured
from dea.configuration.section import Section
from dea.discrepancy.budget import Budget
from dea.discrepancy.rules import Rules

_HEAD = """# Thresholds of a diagnosis

Every value of `discrepancy.rules` and `discrepancy.budget`, which the pages
[discrepancy.md](../discrepancy.md) and [diagnosis.md](diagnosis.md) cite by name. They are the
defaults of `dea.diagnose` and the values of `config/config.yaml`. `make thresholds` writes this
page anew from `src/dea/discrepancy/rules.py` and `src/dea/discrepancy/budget.py`; the
meanings are those of [configuration.md](../configuration.md#rules).

Quantities such as *gap*, *misfit* and *floor* are defined in
[discrepancy.md](../discrepancy.md#terms).
"""


def page() -> str:
    """Return ``docs/method/thresholds.md``."""
    lines = [_HEAD]
    lines += _table("rules", "When an effect is named.", configured.Rules, Rules())
    lines += _table("budget", "How far the search goes.", configured.Budget, Budget())
    return "\n".join(lines).replace("``", "`")


def _table(name: str, says: str, section: type[Section], values: Any) -> Iterator[str]:
    yield f"## {name}\n"
    yield f"{says}\n"
    yield "| name | value | unit | meaning |"
    yield "|---|---|---|---|"
    for key, value in asdict(values).items():
        field = section.model_fields[key]
        extra = field.json_schema_extra
        unit = extra["unit"] if isinstance(extra, dict) else ""
        yield f"| `{name}.{key}` | {value:g} | {unit} | {field.description} |"
    yield ""
