"""The files that a figure or a table is made from, found by what they hold and of whom."""

from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from typing import Any, TypeVar

import xarray as xr

from dea.configuration.files import read_yaml
from dea.errors import InputError
from dea.store.files import read
from dea.store.record_file import read_record
from dea.strict_json import from_json

_Read = TypeVar("_Read")


class Sources:
    """Files of results: the stem of each says what it holds, its folder of which system.

    Each file is read once, when it is first asked for.

    Parameters
    ----------
    files
        Such as ``results/dea1/record.nc``.
    """

    def __init__(self, files: Iterable[Path]) -> None:
        self._files = tuple(files)
        self._read: dict[Path, Any] = {}

    @property
    def system(self) -> str:
        """The name of the only system.

        Raises
        ------
        InputError
            If the files are of several systems.
        """
        names = list(dict.fromkeys(file.parent.name for file in self._files))
        if len(names) != 1:
            raise InputError(
                f"one system is wanted, these are {', '.join(names) or 'none'}",
                remedy="Give the files of one folder of results",
            )
        return names[0]

    def dataset(self, stem: str) -> xr.Dataset:
        """Return the only dataset ``stem``.

        Raises
        ------
        InputError
            If there is none or several, or as :func:`~dea.store.read` does.
        """
        return self._only(stem, self.datasets(stem))

    def datasets(self, stem: str) -> dict[str, xr.Dataset]:
        """Return the datasets ``stem`` by the systems' names, in the order of the files."""
        return self._each(stem, read_record if stem == "record" else read)

    def document(self, stem: str) -> Mapping[str, Any]:
        """Return the content of the only JSON or YAML file ``stem``.

        Raises
        ------
        InputError
            If there is none or several.
        """
        return self._only(stem, self.documents(stem))

    def documents(self, stem: str) -> dict[str, Mapping[str, Any]]:
        """Return the contents of the JSON or YAML files ``stem`` by the systems' names."""
        return self._each(stem, _document)

    def _each(self, stem: str, reader: Callable[[Path], _Read]) -> dict[str, _Read]:
        files = [file for file in self._files if file.stem == stem]
        for file in files:
            if file not in self._read:
                self._read[file] = reader(file)
        return {file.parent.name: self._read[file] for file in files}

    def _only(self, stem: str, found: Mapping[str, _Read]) -> _Read:
        if len(found) != 1:
            raise InputError(
                f"one file {stem!r} is wanted, {len(found)} are given",
                remedy="Give it for one system",
            )
        return next(iter(found.values()))


def _document(file: Path) -> Mapping[str, Any]:
    content: Mapping[str, Any] = (
        from_json(file.read_text(encoding="utf-8"))
        if file.suffix == ".json"
        else read_yaml(file, what="the file", example="config/published_errors.yaml")
    )
    return content
