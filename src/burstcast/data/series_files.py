"""Sources of measured series: files, tables of pandas and arrays of xarray, by their two doors.

Anything else is refused with the row, the column and what to do: nothing is shifted, filled or
guessed. What has to be done before is pandas and xarray (docs/data_recipes.md).
"""

import os
import re
import unicodedata
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

import scipy

from burstcast.base.arrays import AXES
from burstcast.data.measured_data import Content, Run
from burstcast.data.named_arrays import NamedArrays
from burstcast.data.tables import RECIPES, csv_content, frame_content

if TYPE_CHECKING:
    import pandas as pd

T = TypeVar("T")
_ADDRESS = re.compile(r"[a-z][a-z0-9+.-]+://", re.IGNORECASE)
ENGINES = {".nc": "netcdf4", ".zarr": "zarr", ".h5": "h5netcdf"}
"""What xarray opens files of arrays with, by the ends of their names."""


def content_of(source: Any, number: int | None = None) -> Content:
    """What a source has; no value of a file is read.

    ``source``: Path of a file, a DataFrame of pandas, or an array or a data set of xarray.
    ``number``: Place among several sources, for messages; None: there is no other.
    """
    place = "" if number is None else f" {number}"
    if not isinstance(source, str | Path):
        import pandas as pd  # planning reads headers of files alone

        if isinstance(source, pd.DataFrame):
            return frame_content(f"the table{place}", source)
        if hasattr(source, "dims"):
            return NamedArrays(f"the array{place}", source).content()
        raise TypeError(
            f"series come from a file, a DataFrame or what xarray holds, not from "
            f"{type(source).__name__}"
        )
    source = str(source)
    if _ADDRESS.match(source):
        raise ValueError(
            f"{source} is an address, not a file: download it first, or read it with pandas or "
            f"xarray, and give the table or the array"
        )
    suffix = Path(source).suffix.lower()
    if suffix not in (".csv", ".parquet", *ENGINES):
        raise ValueError(
            f"{source}: files of series end in .csv, .parquet, {', '.join(ENGINES)}; convert "
            f"others with pandas or xarray ({RECIPES})"
        )
    if suffix == ".csv":
        content = _named(source, lambda: csv_content(source))
    elif suffix == ".parquet":
        content = _named(source, lambda: frame_content(source, _parquet(source)))
    else:
        content = _named(source, lambda: _array_content(source))
    return replace(
        content, read=lambda names, unit: _named(source, lambda: content.read(names, unit))
    )


def _parquet(path: str) -> "pd.DataFrame":
    import pandas as pd

    return pd.read_parquet(path)


def _check_file(path: str) -> None:
    """Check that a path is a file of bytes that end: no device, pipe or socket."""
    if os.path.exists(path) and not (os.path.isfile(path) or os.path.isdir(path)):
        raise ValueError(
            f"{path} is no file, but a pipe or a device, which has no end that is known: copy its "
            f"content to a file"
        )


def _alike(path: str) -> str:
    """Words on a file whose name looks the same, for messages; empty if there is none."""
    folder, name = os.path.split(path)
    others = os.listdir(folder or ".") if os.path.isdir(folder or ".") else []
    for other in others:
        if (
            unicodedata.normalize("NFKC", other).strip()
            == unicodedata.normalize("NFKC", name).strip()
        ):
            return (
                f"; {other!r} looks the same, but is written with other characters "
                f"({other!a}, not {name!a})"
            )
    return ""


def _named(path: str, read: Callable[[], T]) -> T:
    """Result of a reader, whose errors name the file."""
    _check_file(path)
    try:
        return read()
    except FileNotFoundError:
        raise ValueError(
            f"{path}: there is no such file, seen from {Path.cwd()}{_alike(path)}"
        ) from None
    except UnicodeError as error:
        raise ValueError(f"{path} is not written in UTF-8: save it so ({error})") from error
    except Exception as error:  # whatever the libraries of the formats raise
        text = str(error) or type(error).__name__
        raise ValueError(
            text if text.startswith(path) else f"{path} cannot be read: {text}"
        ) from error


def _array_content(path: str) -> Content:
    with _opened(path) as arrays:
        found = arrays.content()

    def read(wanted: Sequence[str], unit: str | None) -> list[Run]:
        with _opened(path) as arrays:
            return arrays.runs(wanted, unit)

    return replace(found, read=read)


@contextmanager
def _opened(path: str) -> Iterator[NamedArrays]:
    import xarray  # takes half a second, and few campaigns need it

    suffix = Path(path).suffix.lower()
    options: dict[str, Any] = {"engine": ENGINES[suffix]}
    if options["engine"] not in xarray.backends.list_engines():
        raise ValueError(
            f"{path}: reading {suffix} takes the package {ENGINES[suffix]}, which is not "
            f"installed: install it, or convert the file to NetCDF"
        )
    if suffix == ".nc":
        options |= _options_of_netcdf(path)
    elif suffix == ".h5":
        options["phony_dims"] = "sort"  # dimensions without names are no mistake by themselves
    with xarray.open_dataset(path, decode_times=False, decode_coords=False, **options) as data:
        yield NamedArrays(path, data)


def _options_of_netcdf(path: str) -> dict[str, Any]:
    """How xarray reads a file that netCDF4 would make nothing of, or die of."""
    import netCDF4

    with open(path, "rb") as file:
        is_classic = file.read(3) == b"CDF"
    if not is_classic:
        with netCDF4.Dataset(path) as file:
            if file.groups and not file.variables:
                raise ValueError(
                    f"{path} has its variables in groups ({', '.join(file.groups)}): open one with "
                    f"xarray, open_dataset({path!r}, group={next(iter(file.groups))!r}), and write "
                    f"it to a file of its own"
                )
            texts = [name for name, variable in file.variables.items() if variable.dtype is str]
        # text, or numbers of a type that NetCDF lacks, such as float16: no columns of either
        return {"drop_variables": sorted({*texts} - {*AXES})}
    try:  # netCDF4 reads zeros for what a classic file lacks, and may crash at a damaged one
        with scipy.io.netcdf_file(path):
            return {"engine": "scipy"}
    except Exception as error:  # its parser has no errors of its own
        raise ValueError(
            f"{path} is cut off, or is no classic NetCDF file of 32 or 64-bit offsets: copy it "
            f"again, or convert it (nccopy -k netCDF-4)"
        ) from error
