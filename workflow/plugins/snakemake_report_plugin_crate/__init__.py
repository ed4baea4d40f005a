"""Reporter of Snakemake that writes an RO-Crate: ``snakemake --reporter crate``."""

from dataclasses import dataclass, field
from pathlib import Path
from typing import Optional

from snakemake_interface_common.exceptions import WorkflowError
from snakemake_interface_report_plugins.reporter import ReporterBase
from snakemake_interface_report_plugins.settings import ReportSettingsBase

from dea.audit.crate import JobTimes, write
from dea.errors import InputError


@dataclass
class ReportSettings(ReportSettingsBase):
    """What the command line may set."""

    folder: Optional[Path] = field(  # noqa: UP045 (read by Snakemake, which knows no unions)
        default=None,
        metadata={"help": "New folder for the crate", "env_var": False, "required": True},
    )


class Reporter(ReporterBase):
    """Hands the times of the jobs, which Snakemake knows, to the crate."""

    def render(self) -> None:
        """Write the crate; one that would contradict itself ends Snakemake with its message."""
        spans = {
            str(path): JobTimes(record.starttime, record.endtime)
            for record in self.jobs
            for path in record.output
        }
        try:
            write(Path(self.settings.folder), spans)
        except InputError as error:
            raise WorkflowError(str(error)) from None
