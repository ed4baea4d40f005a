"""Read a record of the study, or of another program whose columns are named."""

from pathlib import Path
from typing import Any

import xarray as xr

from dea.errors import InputError
from dea.store.files import read
from dea.store.foreign import import_record
from dea.store.foreign_files import FORMATS
from dea.store.record_checks import check_record

_EXAMPLE = (
    "read_record(path, sampling_interval=0.02, input={'column': 'volts', 'units': 'V'}, "
    "output={'column': 'position', 'units': 'mm'})"
)


def read_record(path: str | Path, **columns: Any) -> xr.Dataset:
    """Read a record of the study, or one made elsewhere whose columns are named, and check it.

    Parameters
    ----------
    path
        A record of the study (NetCDF), or a file of another program (text, NetCDF, MATLAB,
        spreadsheet, Parquet).
    columns
        For a file of other columns, what a case file says of it: ``input`` and ``output``, each
        ``{"column": …, "units": …}`` with optionally a ``name``, or a list of such ``inputs``;
        ``time`` likewise, or ``sampling_interval`` in seconds, which a column of times that the
        file has may not contradict; optionally ``rows`` = [first, last + 1] and ``resample`` in
        seconds.

    Returns
    -------
    xarray.Dataset
        Over ``time`` in s: ``voltage`` and ``displacement`` of a record of the study, ``input``
        (of several ``input_1``, ``input_2``, …) and ``output`` of another, with their units and
        names as attributes; ``quality`` where samples are flagged.

    Raises
    ------
    InputError
        If the file cannot be read, a column is missing or not named, the file's own times are of
        another interval, or the record is not whole (:func:`check_record`).
    """
    file = Path(path)
    if columns:
        # pydantic takes long to import, and most who import this room name no columns.
        from dea.configuration.problems import validated
        from dea.configuration.record import RecordColumns

        validated(RecordColumns, columns, file)
        return import_record({"file": str(file), **columns}, compare_times=True)
    if file.suffix.lower() in FORMATS and file.suffix.lower() != ".nc":
        raise InputError(
            "nothing says which of its columns are input and output",
            file=file,
            remedy=f"Name them: {_EXAMPLE}",
        )
    dataset = read(file)
    check_record(dataset, file)
    return dataset
