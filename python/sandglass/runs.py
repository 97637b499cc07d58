"""Results of a run, or of a collected study, as numpy arrays."""
import json
import pathlib
import tomllib

import h5py


class Results(dict):
    """Nested groups of an HDF5 file: results["dynamics"]["small"], or results["dynamics/small"]."""

    def __getitem__(self, path):
        value = self
        for name in path.strip("/").split("/"):
            value = dict.__getitem__(value, name)
        return value


def _read(group):
    results = Results()
    for name, item in group.items():
        results[name] = _read(item) if isinstance(item, h5py.Group) else item[()]
    return results


class Run:
    """One run: `summary` and `config` as dictionaries, `results` as nested dictionaries of numpy arrays.

    Times are in R_s sqrt(m_s / T_0), lengths in R_s; docs/file-formats.md describes every entry.
    """

    def __init__(self, folder):
        folder = pathlib.Path(folder)
        self.folder = folder
        self.summary = json.loads((folder / "summary.json").read_text())
        self.config = tomllib.loads((folder / "config.toml").read_text())
        with h5py.File(folder / "observables.h5") as file:
            self.results = _read(file)

    def __getitem__(self, path):
        """run["dynamics/small/mean_square_displacement/value"]"""
        return self.results[path]


def load(folder):
    """Reads the run in `folder`. Raises FileNotFoundError when it is not finished."""
    return Run(folder)


def load_study(folder):
    """The content of study.h5, which `sandglass sweep collect` writes: `table` (an array over state points for each
    number) and `points` (the merged results of each)."""
    with h5py.File(pathlib.Path(folder) / "study.h5") as file:
        return _read(file)
