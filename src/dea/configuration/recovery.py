"""Published models identified from their own simulated records: ``recovery``."""

from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from dea.configuration.section import (
    Count,
    Different,
    NotNegative,
    Positive,
    Section,
    key,
    refuse,
)


class Recovery(Section):
    """The published models as plants, identified from their own simulated records."""

    models: str = key("file of the published models")
    length: Positive = key("length of each simulated record", unit="s")
    sampling_rate: Positive = key("rate of the models and of each simulated record", unit="Hz")
    band: Positive = key("band of the Gaussian excitation", unit="Hz")
    noise: NotNegative = key("standard deviation of the output noise over that of the output")
    y_lags: Count = key("largest output lag of the candidates", unit="samples")
    u_lags: Count = key("largest input lag of the candidates", unit="samples")
    degree: Count = key("polynomial order of the candidates")
    threshold: Positive = key("SERR a term must be worth, about the energy of the noise")
    excitation: Annotated[list[Literal["coloured", "white"]], Field(min_length=1), Different] = key(
        "coloured: band-limited as the study's; white: up to half the sampling rate"
    )

    @model_validator(mode="after")
    def _band(self) -> Self:
        if self.band >= 0.5 * self.sampling_rate:
            raise refuse(
                "band",
                f"{self.band:g} Hz is not below half of {self.sampling_rate:g} Hz",
                "Lower the band, or raise the sampling rate.",
            )
        return self
