"""A record of any file becomes a case: its columns are told apart, its settings inferred."""

from dea.intake.case import Inferred, infer_case
from dea.intake.case_file import write_case
from dea.intake.questions import UnansweredError
from dea.intake.roles import Answers

__all__ = ["Answers", "Inferred", "UnansweredError", "infer_case", "write_case"]
