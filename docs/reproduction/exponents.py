"""Exponents of the mean square displacement of the small disks, against everything they might depend on.

    PYTHONPATH=python python3 docs/reproduction/exponents.py campaigns/variations > exponents.csv

One line a state point: ln MSD against ln t by least squares with equal weights over each range of t, of the MSD itself and
of the cage-relative one; then over 1 < t < 10 in the first and the last third of the measured stretch (ageing), and over
the range that would be 1 < t < 10 if the temperature were 0.73, as the formula for one species gives it. Errors: jackknife
over the intervals of each run, or, where it is larger, the scatter of independent starts.

    PYTHONPATH=python python3 docs/reproduction/exponents.py --by-interval campaigns/young > young.csv

One line a state point and interval, then every two intervals, then all, with the mean temperature: how the exponents
change with waiting time. Errors: the scatter of independent starts.
"""
import csv
import sys
from pathlib import Path

import numpy as np

import sandglass

RANGES = [(0.1, 1), (1, 10), (3, 30), (10, 100)]
MISTAKEN_TEMPERATURE = 0.73
COLUMNS = ["N", "eps", "partner", "reach", "frequency", "jammed_fraction", "starts", "waited", "rate"]


def exponent(time, square, low, high):
    """Slope of ln `square` against ln `time`; NaN where the lags do not fill the range."""
    inside = (time >= low * 0.999) & (time <= high * 1.001) & (square > 0)
    if inside.sum() < 3 or time[-1] < high * 0.999:
        return np.nan
    return np.polyfit(np.log(time[inside]), np.log(square[inside]), 1)[0]


def jackknife(time, intervals, low, high):
    """Exponent of the mean over `intervals`[interval, lag], and its standard error."""
    n = len(intervals)
    whole = exponent(time, intervals.mean(axis=0), low, high)
    without = [exponent(time, np.delete(intervals, i, axis=0).mean(axis=0), low, high) for i in range(n)] if n > 1 else []
    return whole, np.sqrt((n - 1) / n * np.sum((without - np.mean(without)) ** 2)) if n > 1 else np.nan


def merged(values):
    """Mean of (value, error) over independent starts, and the larger of its two errors."""
    value, error = np.array(values).T
    n = len(value)
    within = np.sqrt(np.sum(error**2)) / n
    between = value.std(ddof=1) / np.sqrt(n) if n > 1 else 0
    return value.mean(), max(within, between)


def exponents(run):
    """{name: (value, error)} of one run."""
    small = run["dynamics/small/mean_square_displacement"]
    time, intervals = small["time"], small["interval_value"]
    found = {f"{a:g}-{b:g}": jackknife(time, intervals, a, b) for a, b in RANGES}
    cage = run["dynamics/small/cage_relative_displacement"]
    for a, b in RANGES[1:2]:
        found[f"cage {a:g}-{b:g}"] = jackknife(cage["time"], cage["interval_value"], a, b)
    third = max(1, len(intervals) // 3)
    found["first third"] = jackknife(time, intervals[:third], 1, 10)
    found["last third"] = jackknife(time, intervals[-third:], 1, 10)
    slower = MISTAKEN_TEMPERATURE ** 0.5  # times scale as 1 / sqrt(T): what takes t there takes t sqrt(0.73) here
    found["T = 0.73"] = jackknife(time, intervals, slower, 10 * slower)
    return found


def runs_by_point(folder):
    """{what distinguishes a state point: its runs}"""
    points = {}
    for path in sorted(Path(folder).glob("runs/*/summary.json")):
        run = sandglass.load(path.parent)
        config = run.config
        if config["system"]["packing_fraction"] != 0.81:
            continue
        drive = config["drive"]
        key = (config["system"]["particles"], config["collision"]["restitution"], drive["partner"],
               drive["reach"] if drive["partner"] == "within" else "", drive["frequency"],
               config["prepare"]["jammed_fraction"], config["run"]["equilibrate"])
        points.setdefault(key, []).append(run)
    return sorted(points.items(), key=str)


def waited(run):
    """Time units between the start and the measured stretch."""
    return run.summary["time"] / run.config["run"]["collisions"] * run.config["run"]["equilibrate"]


def over_all(folder):
    """Rows of a table: the exponents of each state point."""
    rows = []
    for key, runs in runs_by_point(folder):
        found = [exponents(run) for run in runs]
        row = [*key[:-1], len(runs), f"{np.mean([waited(run) for run in runs]):.0f}",
               f"{np.mean([run.summary['collision_rate'] for run in runs]):.1f}"]
        for name in found[0]:
            row += [f"{number:.4f}" for number in merged([one[name] for one in found])]
        rows.append(row)
    return [COLUMNS + [column for name in found[0] for column in (name, "error")], *rows]


def stretch(run, first, last):
    """Temperature and exponents of the intervals `first` to `last` - 1 of one run."""
    msd, cage = (run[f"dynamics/small/{name}"] for name in ("mean_square_displacement", "cage_relative_displacement"))
    of = lambda curve, low, high: exponent(curve["time"], curve["interval_value"][first:last].mean(axis=0), low, high)
    slower = MISTAKEN_TEMPERATURE ** 0.5
    return [run["timeseries/intervals/temperature_all"][first:last].mean(), of(msd, 1, 10), of(cage, 1, 10),
            of(msd, slower, 10 * slower)]


def by_interval(folder):
    """Rows of a table: the exponents of each interval of each state point, of every two, and of all."""
    names = ["temperature", "1-10", "cage 1-10", "T = 0.73"]
    rows = [["N", "eps", "starts", "from", "to"] + [column for name in names for column in (name, "error")]]
    for key, runs in runs_by_point(folder):
        count = runs[0].config["run"]["intervals"]
        for length in (1, 2, count):
            for first in range(0, count, length):
                ends = [np.mean([waited(run) + run.summary["time"] * i / count for run in runs])
                        for i in (first, first + length)]
                row = [*key[:2], len(runs), *(f"{end:.1f}" for end in ends)]
                for values in np.transpose([stretch(run, first, first + length) for run in runs]):
                    error = values.std(ddof=1) / np.sqrt(len(values)) if len(values) > 1 else np.nan
                    row += [f"{values.mean():.4f}", f"{error:.4f}"]
                rows.append(row)
    return rows


if __name__ == "__main__":
    folder = sys.argv[-1]
    csv.writer(sys.stdout).writerows(by_interval(folder) if "--by-interval" in sys.argv else over_all(folder))
