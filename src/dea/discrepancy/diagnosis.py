"""What a diagnosis returns: its findings and their summary."""

from dataclasses import dataclass
from functools import cached_property

from dea.discrepancy.findings import Findings
from dea.discrepancy.report.summary import verdict_of
from dea.discrepancy.report.verdict import Verdict


@dataclass(frozen=True, repr=False)
class Diagnosis(Findings):
    """Everything a diagnosis finds, as :class:`Findings`; ``verdict`` is its summary."""

    @cached_property
    def verdict(self) -> Verdict:
        """The summary in numbers and words."""
        return verdict_of(self)

    def __repr__(self) -> str:
        """Return status, effects and sentence: its arrays would fill many pages."""
        names = ", ".join(self.verdict.names)
        return f"<Diagnosis {self.verdict.status}: {names or 'no effect'}. {self.verdict.sentence}>"
