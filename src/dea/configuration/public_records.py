"""Public measured records: config/public_records.yaml."""

from typing import Annotated

from pydantic import Field, RootModel

from dea.configuration.section import Section, key


class UntimedTable(Section):
    """A public table of numbers without times, of which a CSV with times is made."""

    interval: Annotated[float, Field(gt=0)] = key("time between rows", unit="s")
    columns: dict[str, Annotated[int, Field(ge=1)]] = key("column of the table by its new name")


class PublicRecord(Section):
    """Where a record is, and what it holds."""

    url: str = key("public address")
    sha256: Annotated[str, Field(pattern="^[0-9a-f]{64}$")] = key("SHA-256 of the record, in hex")
    licence: str | None = key("terms of use", default=None)
    sampled: UntimedTable | None = key("how the public table becomes the record", default=None)


class PublicRecords(RootModel[dict[str, PublicRecord]]):
    """Measured records by their paths below data/."""
