"""Frequency responses measured without a model: ``confirmation`` of config/config.yaml."""

from dea.configuration.section import Section, Share, key


class Confirmation(Section):
    """Which measured lines confirm a model (docs/method/confirmation.md)."""

    even_above: Share = key(
        "part of the predicted power of an even line that lines with power in the record make "
        "up, from which the line is judged"
    )
