#!/usr/bin/python3
"""Writes a made-up study: every quantity of every run follows a law that is known, with a little noise.

    synthetic_study.py FOLDER [--full]

It is no simulation and no measurement: it stands in for one where collecting, figures and verdicts are tested. --full
has the paper's whole grid of densities and restitutions, else a part of it. Two replicas a point, and a manifest with
one run more, which is missing.
"""
import argparse
import json
import pathlib

import h5py
import numpy as np

FULL = ([0.5, 0.55, 0.6, 0.65, 0.7, 0.75, 0.8, 0.85, 0.9, 0.95],
        [0.1, 0.2, 0.3, 0.4, 0.5, 0.52, 0.55, 0.58, 0.6, 0.65, 0.7, 0.72, 0.74, 0.75, 0.76, 0.77, 0.78, 0.79, 0.8, 0.81])
PART = ([0.5, 0.7, 0.9], [0.3, 0.5, 0.52, 0.58, 0.72, 0.78, 0.8, 0.81])
EXPONENTS = {0.9: (0.547, 0.006), 0.7: (0.6163, 0.0011)}  # what the paper reports at 0.81
NOISE = 0.002
PARTICLES = 10000


def collision_rate(eta):
    return 3.2 * eta / (1 - eta) ** 2


def diffusion(eta, eps):
    """D(t), falling by orders of magnitude towards a density that is lower for more elastic disks."""
    return 0.35 / eta * (1 - eta / (0.88 - 0.1 * (eps - 0.5))) ** 2


def displacement(eta, eps, t):
    flight, cage = 2 * t**2, 0.35 * (1 - eta) / eta * (1 if eta > 0.65 else 40)
    return 1 / (1 / flight + 1 / (cage + 4 * diffusion(eta, eps) * t))


def velocity(eta, eps, s):
    backscattering = 0.08 * max(0, eps - 0.68) * max(0, eta - 0.65) / 0.02
    return np.exp(-s) + 0.15 * (1 - eta) * s**2 / (1 + s**2) ** 1.5 * (eta < 0.71) - backscattering * s * np.exp(-s / 4) / 4


def pair_correlation(eta, r, contact):
    x = r / contact
    g = 1 + 3 * eta * np.exp(-((x - 1.03) / 0.06) ** 2) - 0.3 * eta * np.exp(-((x - 1.45) / 0.2) ** 2)
    dip = 0.6 if eta > 0.55 else 0
    g += eta * (0.8 * np.exp(-((x - 1.92) / 0.22) ** 2) - dip * np.exp(-((x - 1.9) / 0.06) ** 2))
    return np.where(x < 1, 0, g)


class File:
    def __init__(self, path, generator):
        self.file, self.generator = h5py.File(path, "w"), generator

    def put(self, path, values, unit=""):
        self.file[path] = values
        self.file[path].attrs["unit"] = np.bytes_(unit)

    def measured(self, group, axes, value, noise=NOISE, count=1000, names=("value", "error", "count")):
        """A function with noise of known size, as `value`, `error` and `count`."""
        for name, values in axes.items():
            if f"{group}/{name}" not in self.file:
                self.put(f"{group}/{name}", values)
        error = np.broadcast_to(noise, np.shape(value)) * np.ones(np.shape(value))
        self.put(f"{group}/{names[0]}", value + error * self.generator.standard_normal(np.shape(value)))
        self.put(f"{group}/{names[1]}", error)
        if len(names) > 2:
            self.put(f"{group}/{names[2]}", np.full(np.shape(value), count, dtype=np.uint64))


def write_run(folder, eta, eps, seed):
    folder.mkdir(parents=True, exist_ok=True)
    generator = np.random.default_rng([seed, round(1000 * eta), round(1000 * eps)])
    rate, length = collision_rate(eta), 40000.0
    box = np.sqrt(PARTICLES * np.pi * (1 + 1.43**2) / 2 / eta)
    file = File(folder / "observables.h5", generator)
    t = np.geomspace(2e-2 / rate, 40000 / rate * (1 + 0.002 * seed), 75)  # replicas differ a little in their lags
    s = rate * t
    axes = {"time": t, "collisions": s}
    for species, mass, size in (("all", 1.5, 0.9), ("small", 1.0, 1.0), ("big", 2.0449, 0.7)):
        group = f"/dynamics/{species}"
        msd = size * displacement(eta, eps, t)
        file.measured(f"{group}/mean_square_displacement", axes, msd, NOISE * msd)
        file.measured(f"{group}/velocity_autocorrelation", axes, 2 / mass * velocity(eta, eps, s), 5e-5)
        file.put(f"{group}/velocity_autocorrelation/equal_time_value", 2 / mass)
        file.put(f"{group}/velocity_autocorrelation/equal_time_error", 0.001)
        running = np.gradient(msd, t) / 4
        file.measured(f"{group}/running_diffusion", axes, running, NOISE * running)
        k = np.array([0.5, 3.0])
        gaussian = np.exp(-k[:, None] ** 2 * msd / 4)
        slow = max(0, eta - 0.7) * 3
        scattering = gaussian + slow * gaussian * (1 - gaussian)
        kinds = {"wavenumber": k, **axes}
        file.measured(f"{group}/self_intermediate_scattering", kinds, scattering)
        file.measured(f"{group}/gaussian_approximation", kinds, gaussian, 1e-9)
        # A hump in ln t where the cage opens, higher and later the denser; overlap and displacement as the MSD goes.
        hump = (0.1 + 20 * max(0, eta - 0.68)) * np.exp(-np.log(diffusion(eta, eps) * t / 0.02) ** 2)
        file.measured(f"{group}/non_gaussian", axes, hump)
        file.measured(f"{group}/susceptibility", axes, 10 * hump)
        file.measured(f"{group}/overlap", axes, np.exp(-msd))
        file.measured(f"{group}/cage_relative_displacement", axes, msd * (0.6 + 0.5 * np.exp(-t)), NOISE * msd)
        ages = np.array([0.5, 1.5, 2.5])
        file.put(f"{group}/mean_square_displacement/interval_value", msd / (1 + 0.1 * ages[:, None] * (eta > 0.79)))
        r, lags = np.geomspace(1e-3, 30, 90), np.geomspace(0.1, 100, 4)
        square = size * displacement(eta, eps, lags)[:, None]
        gaussian = np.exp(-r**2 / square) / (np.pi * square)
        file.measured(f"{group}/van_hove", {"time": lags, "r": r}, gaussian, NOISE * gaussian,
                      count=np.where(gaussian > 1e-6, 1000, 0))
        late = np.geomspace(1e-3, 2000, 60)  # the selection is by displacement at t = 1000
        far = size * displacement(eta, eps, late)
        for speed, value in (("fastest", far * (1 + 8 * late / (late + 3))), ("slowest", 0.05 * far / (far + 0.05))):
            file.measured(f"{group}/mobility/{speed}", {"time": late, "collisions": rate * late}, value, 0.01 * value)
    file.put("/dynamics/waiting_time", ages * 100 * (1 + 0.002 * seed))
    shells = np.geomspace(2 * np.pi / box, 3, 20)
    for part, excess in (("transverse", 1 - eps), ("longitudinal", 0)):
        file.measured(f"/structure/velocity/{part}", {"wavenumber": shells}, 1 + 2 * excess / (1 + (5 * shells) ** 2), 0.05)
    r = np.arange(0.05, 15, 0.1)
    for pair, contact in (("all", 2.4), ("small_small", 2), ("small_big", 2.43), ("big_big", 2.86)):
        file.measured("/structure/radial_distribution", {"r": r}, pair_correlation(eta, r, contact), 0.005,
                      names=(pair, f"{pair}_error"))
    modes, spacing = 40, 2 * np.pi / box
    m, n = np.meshgrid(np.arange(-modes, modes + 1), np.arange(-modes, modes + 1), indexing="ij")
    wavenumber = spacing * 6 * np.hypot(m, n)
    structure = lambda q: 0.05 + q**2 / 20 * (q < 2) + 3 * eta * np.exp(-((q - 2.6) / 0.35) ** 2) + 0.9 * (q > 3)
    for species in ("all", "small"):
        group = f"/structure/structure_factor/{species}"
        file.put(f"{group}/map", structure(wavenumber) * generator.gamma(20, 1 / 20, wavenumber.shape))
        file.put(f"{group}/spacing", 6 * spacing)
        rings = np.linspace(0.2, 5, 60)
        file.measured(f"{group}/ring", {"wavenumber": rings}, structure(rings), 0.01)
        file.put(f"{group}/ring/anisotropy", np.full(60, 0.01))
    file.put("/structure/bond_order/global", 0.02 + 0.05 * eta + 0.001 * generator.standard_normal())
    file.put("/structure/bond_order/global_error", 0.001)
    distance = np.linspace(2, box / 2, 80)
    file.measured("/structure/bond_order/correlation", {"r": distance}, 0.4 * eta * np.exp(-distance / 4), 0.003)
    time = np.concatenate([[0], np.geomspace(1e-3, 100, 100)])
    excess = 0.05 * (1 - np.exp(-time))
    file.put("/timeseries/time", time)
    file.put("/timeseries/collisions", rate * time)
    for species, shift in (("all", 0), ("small", 1), ("big", -1)):
        noise = 0.005 * generator.standard_normal(time.size)
        file.put(f"/timeseries/temperature_{species}", 1 + shift * excess + noise)
    file.file.close()

    exponent, error = EXPONENTS.get(eps, (0.6, 0.01)) if eta == 0.81 else (min(1.0, 1.6 - 1.25 * eta), 0.01)
    unit_time = t[np.argmax(displacement(eta, eps, t) > 1)]
    summary = {
        "version": "0.1.0", "seed": seed, "particles": PARTICLES, "packing_fraction": eta, "restitution": eps,
        "box_length": box, "time": length / rate, "collisions": int(length * PARTICLES / 2),
        "collisions_per_particle": length, "temperature": {"all": 1.0, "small": 1.05, "big": 0.95},
        "collision_rate": rate * (1 + 1e-3 * generator.standard_normal()),
        "compressibility_factor": 1 / (1 - eta) ** 2, "stationary": eta < 0.805,
        "energy": {"injected": 100 * (1 - eps) * rate, "dissipated": 100 * (1 - eps) * rate * (1 + 1e-6), "balance": 1e-15},
        "collision_rate_by_pair": {"small_small": 0.45 * rate, "small_big": 0.5 * rate, "big_small": 0.5 * rate,
                                   "big_big": 0.55 * rate},
        "velocity_correlation_length": 5.0 if eps < 0.8 else None,
        "diffusion": {"small": {"from_msd": 0.01, "error": 0.001, "at_collisions": 1000, "from_vacf": 0.02,
                                "vacf_error": 0.001}} if eta == 0.3 else {},
        "msd_exponent": {"small": {"value": exponent + 0.3 * error * generator.standard_normal(), "error": error,
                                   "from": 1, "to": 10}},
        "msd_unit_time": {"small": unit_time, "big": None},
        "errors": {"temperature_all": 0.002, "temperature_small": 0.002, "temperature_big": 0.002,
                   "collision_rate": 1e-3 * rate, "compressibility_factor": 0.01, "msd_unit_time_small": 0.01 * unit_time},
        "state_hash": f"{seed:016x}", "wall_seconds": 1.0,
    }
    (folder / "summary.json").write_text(json.dumps(summary))
    (folder / "config.toml").write_text(f"[system]\nparticles = {PARTICLES}\npacking_fraction = {eta}\n"
                                        f"[collision]\nrestitution = {eps}\n[run]\nseed = {seed}\ncollisions = {length}\n"
                                        "[observe]\nselection_time = 1000\n")
    (folder / "report.html").write_text("<!DOCTYPE html><title>a run</title>")


def write_study(folder, full=False):
    restitutions, densities = FULL if full else PART
    rows = ["index\tpath\tseed\tsystem.packing_fraction\tcollision.restitution"]
    points = [(eta, eps, seed) for eps in restitutions for eta in densities for seed in (1, 2)]
    for index, (eta, eps, seed) in enumerate(points, 1):
        path = f"runs/eta={eta:.2f}_eps={eps:.2f}_seed={seed}"
        rows.append(f"{index}\t{path}\t{seed}\t{eta}\t{eps}")
        write_run(folder / path, eta, eps, seed)
    rows.append(f"{len(points) + 1}\truns/eta=0.82_eps=0.90_seed=1\t1\t0.82\t0.9")
    (folder / "manifest.tsv").write_text("\n".join(rows) + "\n")


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--full", action="store_true")
    options = parser.parse_args()
    write_study(options.folder, options.full)
