"""The study's datasets: written atomically with provenance, read with their contract checked."""

from dea.atomic_file import atomic
from dea.checksum import sha256
from dea.store.contracts import CONTRACTS, MINUTE, Contract, Variable
from dea.store.described import Described, complex_parts, variable
from dea.store.files import read, write
from dea.store.foreign import import_record
from dea.store.foreign_files import (
    ForeignTable,
    SeveralSheetsError,
    called_time,
    read_foreign,
    time_column,
    units_in_name,
)
from dea.store.record import (
    Record,
    Text,
    each_text,
    input_names,
    real_numbers,
    require_squares,
)
from dea.store.record_checks import check_record
from dea.store.record_file import read_record
from dea.store.records import flag_counts, signals
from dea.store.resampling import (
    are_gaps,
    check_order,
    rounding,
    samples_per_interval,
    usual_interval,
)
from dea.store.role import Role
from dea.store.sources import Sources

__all__ = [
    "CONTRACTS",
    "MINUTE",
    "Contract",
    "Described",
    "ForeignTable",
    "Record",
    "Role",
    "SeveralSheetsError",
    "Sources",
    "Text",
    "Variable",
    "are_gaps",
    "atomic",
    "called_time",
    "check_order",
    "check_record",
    "complex_parts",
    "each_text",
    "flag_counts",
    "import_record",
    "input_names",
    "read",
    "read_foreign",
    "read_record",
    "real_numbers",
    "require_squares",
    "rounding",
    "samples_per_interval",
    "sha256",
    "signals",
    "time_column",
    "units_in_name",
    "usual_interval",
    "variable",
    "write",
]
