"""What was found from one record, as a page of HTML and as a few lines of text."""

from dea.case_page.findings import Findings
from dea.case_page.html import page
from dea.case_page.summary import summary

__all__ = ["Findings", "page", "summary"]
