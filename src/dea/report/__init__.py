"""The report: the results as a page that a reader follows, each with how it was made."""

from dea.report.page import write

__all__ = ["write"]
