"""How figures are drawn: ``figures`` of config/config.yaml."""

from dea.configuration.section import Interval, Section, Whole, key


class Figures(Section):
    """How figures are drawn (results/README.md)."""

    resolution: Whole = key("of the PNG files", unit="dots per inch", ge=30)
    zoom: Interval = key("stretch of the record that Fig. 1 D and F enlarge", unit="s")
