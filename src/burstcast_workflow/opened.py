"""The results of a campaign, opened to look at: forecasters, tables, figures, series, config.

Users call it as ``burstcast_workflow.open_campaign``.
"""

import json
from collections.abc import Callable, Iterable, Iterator, Mapping
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, Generic, TypeVar

import numpy as np

from burstcast.base.arrays import FloatArray
from burstcast.base.compiled.backends import usable_backend
from burstcast.base.discovery import suggestion
from burstcast.base.files.netcdf import read_rows
from burstcast.base.series_lengths import array_or_list
from burstcast.forecasters.base import Forecaster
from burstcast_workflow.campaign.campaign import Campaign
from burstcast_workflow.campaign.job_settings import settings_of_job
from burstcast_workflow.campaign.members import CaseForecaster
from burstcast_workflow.harness.settings import JobSettings
from burstcast_workflow.jobs.forecasters import Forecasting
from burstcast_workflow.jobs.series import Observed, kept_series
from burstcast_workflow.tracking.run import CLAIM

if TYPE_CHECKING:
    import pandas as pd

Found = TypeVar("Found")
Settings = TypeVar("Settings", bound=JobSettings)
_MOST_NAMES = 6


class Shelf(Mapping[str, Found], Generic[Found]):
    """Lazy mapping of existing results by name: each is read on access.

    ``what`` is their noun in messages: "tables".
    """

    def __init__(self, what: str, names: Iterable[str], read: Callable[[str], Found]) -> None:
        self._what, self._names, self._read = what, list(names), read

    def __getitem__(self, name: str) -> Found:
        if name not in self._names:
            raise KeyError(f"there is no {name!r} among the {self}{suggestion(name, self._names)}")
        return self._read(name)

    def __iter__(self) -> Iterator[str]:
        return iter(self._names)

    def __len__(self) -> int:
        return len(self._names)

    def __repr__(self) -> str:
        some = ", ".join(self._names[:_MOST_NAMES])
        more = len(self._names) - _MOST_NAMES
        names = f": {some}" if some else ""
        return f"{len(self._names)} {self._what}{names}" + (f", {more} more" if more > 0 else "")

    def _ipython_key_completions_(self) -> list[str]:
        return self._names


class OpenedCampaign:
    """Results of a campaign, finished or not; nothing is changed."""

    def __init__(self, results: str | Path) -> None:
        self.results = Path(results)
        try:
            claim = json.loads((self.results / CLAIM).read_bytes())
            self.config: dict[str, Any] = claim["config"]
        except (OSError, ValueError, KeyError, TypeError) as error:
            raise ValueError(
                f"{results} holds no campaign ({type(error).__name__}): give the directory that "
                f"the config calls `results`"
            ) from error
        self._campaign = Campaign(self.config)

    def __repr__(self) -> str:
        return (
            f"campaign in {self.results} of {', '.join(self._campaign.case_names)}\n"
            f"  .forecasters  {self.forecasters} (of {len(self._campaign.forecasters)})\n"
            f"  .networks     {self.networks} (of {len(self._campaign.networks)})\n"
            f"  .tables       {self.tables}\n"
            f"  .figures      {self.figures}\n"
            f"  .series(case), .config"
        )

    @cached_property
    def forecasters(self) -> Shelf[Forecaster]:
        """Existing forecasters by case and identifier: ``["Re400/esn-N500-RV-seed0"]``."""
        return self._shelf("forecasters", self._campaign.forecasters)

    @cached_property
    def networks(self) -> Shelf[Forecaster]:
        """Existing echo state networks by case and identifier."""
        return self._shelf("networks", self._campaign.networks)

    @cached_property
    def tables(self) -> "Shelf[pd.DataFrame]":
        """Existing tables by name."""

        def read(name: str) -> "pd.DataFrame":
            # pandas takes longer to load than all the rest
            from burstcast.base.files.tables import read_table

            return read_table(self.results / "tables" / f"{name}.csv")

        return Shelf("tables", self._stems("tables", "csv"), read)

    @cached_property
    def figures(self) -> Shelf[Path]:
        """Paths of existing figures by name, as PNG; a PDF lies beside each."""
        directory = self.results / "figures"
        return Shelf(
            "figures", self._stems("figures", "png"), lambda name: directory / f"{name}.png"
        )

    def series(
        self, case: str, start: int = 0, stop: int | None = None, *, observed: bool = True
    ) -> FloatArray | list[FloatArray]:
        """Series of a case; its first ``training.series`` series are the training series.

        ``start``, ``stop``: Range of series; without ``stop``, all series from ``start`` on.
        ``observed``: Whether series have observation noise, as forecasters see them, or are the
        truth. Shape ``(series, time, component)``, or a list of series ``(time, component)`` of
        unequal lengths.
        """
        self._check_case(case)
        path = self.results / case / "ensemble.nc"
        if not path.exists():
            raise ValueError(f"the series of {case} are not made yet ({path})")
        states = read_rows(path, "state", start, kept_series(str(path)) if stop is None else stop)
        if not observed:
            return array_or_list(np.asarray(states))
        return array_or_list(self.settings(case, Observed).rows(str(path), start, states))

    def training_series(self, case: str) -> int:
        """Number of training series of a case."""
        self._check_case(case)
        return int(self._campaign.cases[case].training.series)

    def settings(self, case: str, kind: type[Settings]) -> Settings:
        """Settings of a case, as a class of settings of jobs reads them."""
        return self._settings({"case": case}, kind)

    def _settings(self, identity: Mapping[str, Any], kind: type[Settings]) -> Settings:
        files = {name: self.results / identity["case"] / f"{name}.json" for name in kind.files()}
        for file in files.values():
            if not file.exists():
                raise ValueError(f"{file} is not made yet: run the campaign")
        declared = settings_of_job(self._campaign, kind.paths(), identity)
        return kind(declared, identity, files={name: str(file) for name, file in files.items()})

    def _check_case(self, case: str) -> None:
        names = self._campaign.case_names
        if case not in names:
            raise ValueError(
                f"there is no case {case!r}{suggestion(case, names)}; the cases are "
                f"{', '.join(names)}"
            )

    def _stems(self, directory: str, suffix: str) -> list[str]:
        return sorted(path.stem for path in (self.results / directory).glob(f"*.{suffix}"))

    def _shelf(self, what: str, forecasters: Iterable[CaseForecaster]) -> Shelf[Forecaster]:
        there = {
            f"{member.case}/{member.name.identifier}": member
            for member in forecasters
            if (self.results / member.directory / "forecaster.nc").exists()
        }
        return Shelf(what, there, lambda name: self._forecaster(there[name]))

    def _forecaster(self, member: CaseForecaster) -> Forecaster:
        settings = self._settings(member.identity, Forecasting)
        if "backend" in settings.options:
            settings.options["backend"] = usable_backend(settings.options["backend"])
        path = str(self.results / member.directory / "forecaster.nc")
        return settings.read_forecaster(path)


def open_campaign(results: str | Path) -> OpenedCampaign:
    """Open the results of a campaign: ``open_campaign("results/quick")`` (`OpenedCampaign`)."""
    return OpenedCampaign(results)
