"""A record of any file becomes a case: its columns are told apart, its settings inferred."""

from dea.intake.case import Inferred, infer_case
from dea.intake.case_file import (
    case_name,
    earlier_case,
    known_name,
    read_case,
    write_case,
)
from dea.intake.questions import UnansweredError, command
from dea.intake.roles import Answers

__all__ = [
    "Answers",
    "Inferred",
    "UnansweredError",
    "case_name",
    "command",
    "earlier_case",
    "infer_case",
    "known_name",
    "read_case",
    "write_case",
]
