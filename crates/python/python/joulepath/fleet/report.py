"""Which robots differ from their fleet, by what, and since when."""

from __future__ import annotations

import csv
import io
import json
import os
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from scipy import stats

from .._optional import needed
from .departures import FALSE_ALARM_RATE, Departure, Found, find_departures
from .errors import FleetError
from .parameters import Parameter, parameters_of
from .run import DONE, Run, read_runs
from .storage import Storage

PROBABLE = 0.5
"""Probability from which on a mechanism of a diagnosis is told of: it is likelier to act than not."""


@dataclass(frozen=True)
class FleetReport:
    """A report on a fleet: a document, a table and a page."""

    document: dict[str, Any]
    parameters: list[Parameter]

    @property
    def named(self) -> list[str]:
        """Units that differ from their fleet, the clearest first."""
        return [one["unit"] for one in self.document["named"]]

    def to_dict(self) -> dict[str, Any]:
        """The report as a document."""
        return self.document

    def to_pandas(self) -> Any:
        """The units as a `pandas.DataFrame`, a row for each."""
        return needed("pandas").DataFrame(self.document["units"])

    def to_html(self) -> str:
        """The report as one page without scripts or outside resources."""
        from .page import page

        return page(self.document, self.parameters)

    def _repr_html_(self) -> str:
        return self.to_html()

    def __str__(self) -> str:
        return "\n".join([self.document["sentence"], *(f"  {one['sentence']}" for one in self.document["named"])])

    def write(self, folder: str | os.PathLike[str]) -> None:
        """Writes `report.json`, `units.csv`, `parameters.csv` and `report.html` into a folder, which is made."""
        Path(folder).mkdir(parents=True, exist_ok=True)
        texts = {
            "report.json": json.dumps(self.document, indent=2, allow_nan=False),
            "units.csv": _table(self.document["units"]),
            "parameters.csv": _table(self.document["parameters"]),
            "report.html": self.to_html(),
        }
        for name, text in texts.items():
            beside = Path(folder, f".{name}.part")
            beside.write_text(text, encoding="utf-8")
            beside.replace(Path(folder, name))


def report_of(storage: Storage, runs: list[Run] | None = None, false_alarm_rate: float = FALSE_ALARM_RATE) -> FleetReport:
    """Reports on the fleet of runs, or of all runs in the storage."""
    if not 0.0 < false_alarm_rate < 0.5:
        raise FleetError("invalid-request", f"false_alarm_rate {false_alarm_rate}: give a chance between 0 and 0.5")
    runs = [*read_runs(storage, "calibrate"), *read_runs(storage, "diagnose")] if runs is None else runs
    if not runs:
        raise FleetError("invalid-request", f"{storage.place} holds no run: run `fleet calibrate` or `fleet diagnose` first")
    results = [{**result, "kind": run.kind} for run in runs for result in run.results(storage)]
    parameters = parameters_of(results)
    if not parameters:
        raise FleetError("invalid-request", "no recording determined any parameter: there is nothing to compare")
    found = find_departures({one.name: one.fleet for one in parameters}, false_alarm_rate)
    by_name = {one.name: one for one in parameters}
    mechanisms = _mechanisms(results)
    named = [_named(unit, found, by_name, mechanisms.get(unit, [])) for unit in found.named]
    units = sorted({outcome["unit"] for run in runs for outcome in run.outcomes})
    document = {
        "sentence": _sentence(named, len(units)),
        "false_alarm_rate": false_alarm_rate,
        "tests_per_unit": found.tests,
        "named": named,
        "units": [_unit(unit, runs, found, by_name) for unit in units],
        "parameters": [_figures(one, found) for one in parameters],
        "left_out": [outcome for run in runs for outcome in run.outcomes if outcome["state"] != DONE],
        "runs": [{"id": run.id, "kind": run.kind, "recordings": len(run.outcomes)} for run in runs],
    }
    return FleetReport(document, parameters)


def _sentence(named: list[dict[str, Any]], units: int) -> str:
    if not named:
        return f"None of {units} robots differs from the fleet by more than robots and drives differ among themselves."
    names = ", ".join(one["unit"] for one in named)
    return f"{len(named)} of {units} robots differ{'s' if len(named) == 1 else ''} from the fleet: {names}."


def _named(unit: str, found: Found, by_name: dict[str, Parameter], mechanisms: list[dict[str, Any]]) -> dict[str, Any]:
    departures = [_departure(one, by_name[one.parameter], found) for one in _distinct(found.departures[unit])]
    foremost = departures[0]
    steps = [one for one in departures if one["kind"] == "step"]
    since = steps[0]["since"] if steps else None
    acting = [one for one in mechanisms if since is None or one["date"] is None or one["date"] >= since]
    drives = len({one["path"] for one in acting})
    shares: dict[str, float] = {}
    for one in acting:
        if one["mechanism"] is not None:
            shares[one["mechanism"]] = shares.get(one["mechanism"], 0.0) + one["probability"]
    likely: list[dict[str, Any]] = [
        {"mechanism": name, "mean_probability": share / drives, "drives": drives}
        for name, share in sorted(shares.items(), key=lambda one: -one[1])
        if share / drives >= PROBABLE
    ]
    sentence = f"{unit}: {foremost['sentence']}"
    others = {one["parameter"] for one in departures} - {foremost["parameter"]}
    if others:
        sentence += f"; so {'does' if len(others) == 1 else 'do'} {', '.join(sorted(others))}"
    if likely:
        sentence += f". Its diagnoses name {', '.join(one['mechanism'] for one in likely)}"
    return {"unit": unit, "sentence": sentence + ".", "since": since, "departures": departures, "mechanisms": likely}


def _distinct(departures: list[Departure]) -> list[Departure]:
    """Departures without those that tell again, less clearly, of the change of a parameter: a step looks like a drift, and a drift like a step."""
    kept: dict[tuple[str, bool], Departure] = {}
    for one in departures:
        kept.setdefault((one.parameter, one.kind == "level"), one)
    return list(kept.values())


def _departure(one: Departure, parameter: Parameter, found: Found) -> dict[str, Any]:
    half = 1.96 * one.sigma
    low, high = parameter.change(one.size - half), parameter.change(one.size + half)
    fit = found.fits.get(one.parameter)
    dates = parameter.dates[one.unit]
    since = dates[one.since] if one.since is not None else None
    amount = _amount(parameter.change(one.size), parameter)
    words = {
        "level": f"{one.parameter} lies {amount} from the fleet's mean",
        "step": f"{one.parameter} changed by {amount} from the drive of {since} on",
        "drift": f"{one.parameter} drifts by {amount} a week",
    }
    return {
        "parameter": one.parameter,
        "kind": one.kind,
        "change": parameter.change(one.size),
        "interval_95": [low, high],
        "unit": "1" if parameter.relative else parameter.unit,
        "fleet_mean": parameter.in_units(fit.between.mean) if fit and fit.between else None,
        "p_value": min(one.p_value, 1.0),
        "since": since,
        "since_range": [dates[i] for i in one.since_range] if one.since_range else None,
        "sentence": words[one.kind],
    }


def _amount(change: float, parameter: Parameter) -> str:
    return f"{100.0 * change:+.1f} %" if parameter.relative else f"{change:+.3g} {parameter.unit}"


def _unit(unit: str, runs: list[Run], found: Found, by_name: dict[str, Parameter]) -> dict[str, Any]:
    own = [one for run in runs for one in run.outcomes if one["unit"] == unit]
    done = {one["path"] for one in own if one["state"] == DONE}
    dates = sorted(one["date"] for one in own if one["date"])
    clearest = next(iter(found.departures.get(unit, [])), None)
    return {
        "unit": unit,
        "named": unit in found.named,
        "drives": len(done),
        "left_out": len({one["path"] for one in own} - done),
        "first": dates[0] if dates else None,
        "last": dates[-1] if dates else None,
        "p_value": min(clearest.p_value, 1.0) if clearest else None,
        "clearest": _departure(clearest, by_name[clearest.parameter], found)["sentence"] if clearest else None,
    }


def _figures(parameter: Parameter, found: Found) -> dict[str, Any]:
    """A parameter over the units that are not named."""
    fit = found.fits.get(parameter.name)
    used = [one for one in parameter.fleet if one.unit not in found.named]
    figures = {"parameter": parameter.name, "unit": parameter.unit, "relative": parameter.relative, "units": len(used)}
    figures["drives"] = sum(len(one.value) for one in used)
    if fit is None or fit.between is None:
        return {**figures, "mean": None, "mean_interval_95": None, "spread": None, "drive_spread": None, "drift_per_week": None}
    low, high = fit.between.mean_interval_95()
    drifts = np.isfinite(fit.within.slope_sigma)
    half = float(stats.t.ppf(0.975, max(fit.within.dof, 1))) * fit.within.slope_sigma
    return {
        **figures,
        "mean": parameter.in_units(fit.between.mean),
        "mean_interval_95": [parameter.in_units(low), parameter.in_units(high)],
        "spread": fit.between.tau,
        "drive_spread": fit.within.omega,
        "drift_per_week": fit.within.slope_per_week if drifts else None,
        "drift_interval_95": [fit.within.slope_per_week - half, fit.within.slope_per_week + half] if drifts else None,
    }


def _mechanisms(results: list[dict[str, Any]]) -> dict[str, list[dict[str, Any]]]:
    """For each unit, the mechanisms of its diagnoses; an entry without one for a drive that needs none."""
    found: dict[str, list[dict[str, Any]]] = {}
    for one in results:
        if one["kind"] == "diagnose":
            drive = {"path": one["path"], "date": one["date"]}
            findings = [{"mechanism": each["mechanism"], "probability": each.get("probability") or 0.0} for each in one["result"]["findings"]]
            found.setdefault(one["unit"], []).extend({**drive, **each} for each in findings or [{"mechanism": None, "probability": 0.0}])
    return found


def _table(rows: list[dict[str, Any]]) -> str:
    text = io.StringIO()
    if rows:
        writer = csv.DictWriter(text, list(rows[0]), lineterminator="\n", extrasaction="ignore")
        writer.writeheader()
        writer.writerows(rows)
    return text.getvalue()
