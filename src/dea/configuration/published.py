"""What others have published: config/published_models.yaml and config/published_errors.yaml."""

from typing import Annotated, Any, Literal, Self

from pydantic import BeforeValidator, model_validator

from dea.configuration.section import NotNegative, Number, Section, key, refuse


def _texts(terms: Any) -> Any:
    """Return the terms as texts; YAML reads the constant term 1 as a number."""
    return {str(term): value for term, value in terms.items()} if isinstance(terms, dict) else terms


Terms = Annotated[dict[str, Number], BeforeValidator(_texts)]


class PublishedModels(Section):
    """Polynomial NARX models of normalised input and output, as plants with known answers."""

    models: dict[str, Terms] = key("coefficients by name of the model and term, such as y(t-1)")


class PublishedError(Section):
    """An error of a free run."""

    rmse: NotNegative = key("root mean square error")
    units: str = key("units of the error, which are those of the record")


class PublishedExtension(Section):
    """Errors with simple physics, without and with the effect it lacks; or ``effect: none``."""

    before: NotNegative | None = key("root mean square error without the effect", default=None)
    after: NotNegative | None = key("root mean square error with the effect", default=None)
    units: str | None = key("units of the errors, which are those of the record", default=None)
    effect: Literal["none"] | None = key(
        "none where no effect is known that such a record could prove", default=None
    )

    @model_validator(mode="after")
    def _errors_or_none(self) -> Self:
        given = [value is not None for value in (self.before, self.after, self.units)]
        if any(given) == (self.effect is not None) or any(given) != all(given):
            raise refuse(
                "", "neither errors nor none", "Give before, after and units, or effect: none."
            )
        return self


class PublishedErrors(Section):
    """Errors on public test records, by case and test record."""

    errors: dict[str, dict[str, PublishedError]] = key("of polynomial NARX models")
    extensions: dict[str, dict[str, PublishedExtension]] = key("of simple physics")
