"""Public measured records: config/public_records.yaml."""

from typing import Annotated

from pydantic import Field, RootModel

from dea.configuration.section import Section, key


class PublicRecord(Section):
    """Where a record is, and what it holds."""

    url: str = key("public address")
    sha256: Annotated[str, Field(pattern="^[0-9a-f]{64}$")] = key("SHA-256 of the content, in hex")
    licence: str | None = key("terms of use", default=None)


class PublicRecords(RootModel[dict[str, PublicRecord]]):
    """Measured records by their paths below data/."""
