"""sandglass analyze against a brute-force evaluation of every quantity, straight from its definition, on random frames."""

import json
import math

import h5py
import numpy

from definitions import bond_order, jackknife, lags, mean_and_error, nearest_image, relative, shell
from stored_frames import BLOCKS, GROUPS, LENGTH, MASS, PARTICLES, RADIUS, STEP, STEPS, WAVENUMBERS, Frames, write_h5md

OVERLAP = 0.6


class BruteForce(Frames):
    def test_everything(self):
        path = self.folder / "random.h5"
        write_h5md(path, self.position, self.velocity)
        out = self.analyse(path)
        with h5py.File(out / "observables.h5") as file:
            self.check_dynamics(file["dynamics"])
            self.check_heterogeneity(file["dynamics"])
            self.check_structure(file["structure"])
            self.check_gaussian(file["dynamics"])
            temperatures = file["timeseries/intervals/temperature_all"][:]
            series = {name: file["timeseries"][name][:]
                      for name in ("time", "temperature_all", "temperature_small", "temperature_big")}
        velocity = relative(self.velocity)
        kinetic = (MASS[:, None] * velocity**2).sum(axis=2).mean(axis=1) / 2
        frames = numpy.rint(series["time"] / STEP).astype(int)
        self.assertEqual(list(frames[:4]), [0, 1, 2, 3])
        self.close(series["time"], STEP * frames)
        for name, members in GROUPS.items():
            energy = MASS[members, None] * velocity[:, members]**2 / 2
            self.close(series[f"temperature_{name}"], energy.sum(axis=2).mean(axis=1)[frames])
        # An interval's samples begin at its start; its end belongs to the next one.
        self.close(temperatures, [kinetic[b * STEPS:(b + 1) * STEPS].mean() for b in range(BLOCKS)])
        summary = json.loads((out / "summary.json").read_text())
        self.assertAlmostEqual(summary["packing_fraction"], math.pi * (RADIUS**2).sum() / LENGTH**2, places=12)
        self.check_times(summary)
        for key in ("seed", "kicks", "momentum", "collisions", "state_hash", "stationary"):
            self.assertNotIn(key, summary)

    def pairs(self, lag):
        """(block, origin, end) for every pair of frames of a block."""
        return [(b, b * STEPS + o, b * STEPS + o + lag) for b in range(BLOCKS) for o in range(STEPS - lag + 1)
                if o < STEPS]

    def by_block(self, quantity):
        """Mean of quantity(origin, end) over the pairs of each block: [block, lag]."""
        result = []
        for lag in lags():
            values = [[] for _ in range(BLOCKS)]
            for b, origin, end in self.pairs(lag):
                values[b].append(quantity(origin, end))
            result.append([numpy.mean(v, axis=0) for v in values])
        return numpy.array(result).swapaxes(0, 1)

    def check_dynamics(self, dynamics):
        r, v = relative(self.position), relative(self.velocity)
        for name, members in GROUPS.items():
            group = dynamics[name]
            square = lambda a, b: ((r[b] - r[a])[members] ** 2).sum(axis=1)
            msd = self.by_block(lambda a, b: square(a, b).mean())
            fourth = self.by_block(lambda a, b: (square(a, b) ** 2).mean())
            self.close(group["mean_square_displacement/time"][:], STEP * numpy.array(lags()))
            self.assertTrue(numpy.isnan(group["mean_square_displacement/collisions"][:]).all())
            self.check(group["mean_square_displacement"], *mean_and_error(msd))
            self.close(group["mean_square_displacement/interval_value"][:], msd)
            self.check_slopes(group["diffusion_coefficient"], msd)
            counts = [len(self.pairs(lag)) * members.sum() for lag in lags()]
            numpy.testing.assert_array_equal(group["mean_square_displacement/count"][:], counts)
            self.check(group["non_gaussian"], *jackknife(lambda m, f, n: f / (2 * m**2) - 1, msd, fourth))
            self.close(group["non_gaussian/interval_value"][:], fourth / (2 * msd**2) - 1)
            vacf = self.by_block(lambda a, b: (v[a] * v[b])[members].sum(axis=1).mean())
            self.check(group["velocity_autocorrelation"], *mean_and_error(vacf))
            self.close(group["velocity_autocorrelation/interval_value"][:], vacf)
            running = self.by_block(lambda a, b: (v[a] * (r[b] - r[a]))[members].sum(axis=1).mean() / 2)
            self.check(group["running_diffusion"], *mean_and_error(running))
            self.close(group["running_diffusion/interval_value"][:], running)
            equal = [(v[b * STEPS:(b + 1) * STEPS, members] ** 2).sum(axis=2).mean() for b in range(BLOCKS)]
            self.close(group["velocity_autocorrelation/equal_time_value"][0], numpy.mean(equal))
            for i, wavenumber in enumerate(WAVENUMBERS):
                k = 2 * math.pi / LENGTH * shell(wavenumber)
                self.close(group["self_intermediate_scattering/wavenumber"][i], numpy.hypot(*k.T).mean())
                s = self.by_block(lambda a, b: numpy.cos((r[b] - r[a])[members] @ k.T).mean())
                value, error = mean_and_error(s)
                self.close(group["self_intermediate_scattering/value"][i], value)
                self.close(group["self_intermediate_scattering/error"][i], error)
                self.close(group["self_intermediate_scattering/interval_value"][:, i], s)
        self.close(dynamics["waiting_time"][:], STEP * STEPS * (numpy.arange(BLOCKS) + 0.5))

    def check_slopes(self, group, msd):
        """D(t) = (1/4) d MSD / dt between the outermost lags within a factor of 1.5."""
        time = STEP * numpy.array(lags())
        for i, t in enumerate(time):
            near, = numpy.nonzero((time >= t / 1.5 * (1 - 1e-9)) & (time <= t * 1.5 * (1 + 1e-9)))
            value, error = math.nan, math.nan
            if len(near) > 1:  # of a mean the jackknife error is the standard error
                value, error = mean_and_error((msd[:, near[-1]] - msd[:, near[0]]) / (4 * (time[near[-1]] - time[near[0]])))
            self.close([group["value"][i], group["error"][i]], [value, error])

    def check_gaussian(self, dynamics):
        """exp(-k^2 <dr^2> / 4), averaged over the wave vectors of k; its error is that of the MSD, carried on."""
        for name in GROUPS:
            msd = dynamics[name]["mean_square_displacement"]
            for i, wavenumber in enumerate(WAVENUMBERS):
                squares = (2 * math.pi / LENGTH) ** 2 * (shell(wavenumber) ** 2).sum(axis=1)
                terms = numpy.exp(-squares * msd["value"][:][:, None] / 4)
                self.close(dynamics[name]["gaussian_approximation/value"][i], terms.mean(axis=1))
                self.close(dynamics[name]["gaussian_approximation/error"][i],
                           (terms * squares / 4).mean(axis=1) * msd["error"][:])

    def check_times(self, summary):
        """Numbers read off the curves, with jackknife errors: exponent of the MSD, t(MSD = 1), tau(k)."""
        r, time = relative(self.position), STEP * numpy.array(lags())
        fitted = (time >= 1) & (time <= 10)
        exponent = lambda msd, _: numpy.polyfit(numpy.log(time[fitted]), numpy.log(msd[fitted]), 1)[0]

        def passage(y, level):
            """Where y first passes the level from below, linear in ln t."""
            above = numpy.argmax(y >= level)
            self.assertGreater(above, 0)
            part = (level - y[above - 1]) / (y[above] - y[above - 1])
            return math.exp(math.log(time[above - 1]) + part * math.log(time[above] / time[above - 1]))

        k = 2 * math.pi / LENGTH * shell(WAVENUMBERS[1])
        for name in ("small", "big"):
            members, numbers = GROUPS[name], summary["relaxation_time"][f"{WAVENUMBERS[1]:g}"]
            msd = self.by_block(lambda a, b: ((r[b] - r[a])[members] ** 2).sum(axis=1).mean())
            s = self.by_block(lambda a, b: numpy.cos((r[b] - r[a])[members] @ k.T).mean())
            found = summary["msd_exponent"][name]
            self.close([found["value"], found["error"]], jackknife(exponent, msd))
            self.close([summary["msd_unit_time"][name], summary["errors"]["msd_unit_time_" + name]],
                       jackknife(lambda m, _: passage(numpy.log(m), 0), msd))
            self.close([numbers[name], numbers["error" if name == "small" else "big_error"]],
                       jackknife(lambda m, _: passage(-m, -0.5), s))
        self.assertIsNone(summary["relaxation_time"][f"{WAVENUMBERS[0]:g}"]["small"])  # S stays above 1/2

    def check(self, group, value, error, scale=1.0):
        self.close(group["value"][:], value, scale)
        self.close(group["error"][:], error, scale)

    def check_heterogeneity(self, dynamics):
        r = relative(self.position)
        moments = numpy.array([STEPS - lag + 1 for lag in lags()])
        for name, members in GROUPS.items():
            group, disks = dynamics[name], members.sum()
            overlap = lambda a, b: (((r[b] - r[a])[members] ** 2).sum(axis=1) <= OVERLAP**2).mean()
            q, q2 = self.by_block(overlap), self.by_block(lambda a, b: overlap(a, b) ** 2)
            self.check(group["overlap"], *mean_and_error(q))
            chi = lambda q, q2, blocks: disks * blocks * moments / (blocks * moments - 1) * (q2 - q**2)
            self.check(group["susceptibility"], *jackknife(chi, q, q2), scale=disks)
            self.assertEqual(group["overlap/value"].attrs["cutoff"], OVERLAP)

            # From the start of each block alone: cages, and the fastest and slowest tenth at the block's end.
            relative_squares, fastest, slowest = [], [], []
            for b in range(BLOCKS):
                start = r[b * STEPS]
                moved = r[b * STEPS + numpy.array(lags())] - start
                d = nearest_image(start[:, None] - start[None])
                near = numpy.hypot(*d.T).T < 1.5 * (RADIUS[:, None] + RADIUS)
                near &= ~numpy.eye(PARTICLES, dtype=bool)
                cage = numpy.array([m - numpy.array([m[n].mean(axis=0) if n.any() else [0, 0] for n in near])
                                    for m in moved])
                relative_squares.append((cage[:, members] ** 2).sum(axis=2).mean(axis=1))
                squares = (moved[:, members] ** 2).sum(axis=2)
                order, tenth = numpy.argsort(squares[-1]), max(1, disks // 10)
                fastest.append(squares[:, order[-tenth:]].mean(axis=1))
                slowest.append(squares[:, order[:tenth]].mean(axis=1))
            self.check(group["cage_relative_displacement"], *mean_and_error(relative_squares))
            self.check(group["mobility/fastest"], *mean_and_error(fastest))
            self.check(group["mobility/slowest"], *mean_and_error(slowest))
            self.assertEqual(group["mobility/fastest/value"].attrs["selection_time"], STEP * STEPS)

            hove = group["van_hove"]
            edges = hove["edges"][:]
            for i, time in enumerate(hove["time"][:]):
                lag = round(time / STEP)
                densities = []
                for b in range(BLOCKS):
                    distances = numpy.concatenate([numpy.hypot(*(r[e] - r[o])[members].T)
                                                   for block, o, e in self.pairs(lag) if block == b])
                    counts, _ = numpy.histogram(distances, bins=edges)
                    densities.append(counts / len(distances) / (math.pi * numpy.diff(edges**2)))
                value, error = mean_and_error(densities)
                self.close(hove["value"][i], value)
                self.close(hove["error"][i], error)

    def check_structure(self, structure):
        # 41 frames: blocks of equally many that leave the fewest over, between 5 and 20 of them: 20 of 2 frames.
        frames = [self.position[i] for i in range(40)]
        distribution = structure["radial_distribution"]
        r = distribution["r"][:]
        width = LENGTH / 800
        edges = numpy.arange(len(r) + 1) * width
        self.close(r, (edges[1:] + edges[:-1]) / 2)
        distances, kinds = [], []
        upper = numpy.triu_indices(PARTICLES, 1)
        kind = ((RADIUS > 1)[:, None].astype(int) + (RADIUS > 1))[upper]
        for frame in frames:
            d = nearest_image(frame[:, None] - frame[None])
            distances.append(numpy.hypot(d[..., 0], d[..., 1])[upper])
        area = math.pi * numpy.diff(edges**2)
        for name, wanted in (("all", kind >= 0), ("small_small", kind == 0), ("small_big", kind == 1), ("big_big", kind == 2)):
            g = [sum(numpy.histogram(d[wanted], bins=edges)[0] for d in distances[2 * b:2 * b + 2])
                 / (2 * wanted.sum() * area / LENGTH**2) for b in range(20)]
            value, error = mean_and_error(g)
            self.close(distribution[name][:], value)
            self.close(distribution[name + "_error"][:], error)
        self.check_factor(structure["structure_factor"], frames)
        self.check_order(structure["bond_order"], frames, numpy.array(distances))
        self.check_momenta(structure["velocity"])

    def check_factor(self, factor, frames):
        for name in ("all", "small"):
            members, group = GROUPS[name], factor[name]
            spacing = group["spacing"][0]
            self.assertAlmostEqual(spacing, 2 * math.pi / LENGTH, places=12)
            half = group["map"].shape[0] // 2
            self.assertEqual(half, math.floor(2 * math.pi / spacing + 1e-9))
            m, n = numpy.mgrid[-half:half + 1, -half:half + 1]
            maps = []
            for frame in frames:
                phase = numpy.exp(-1j * spacing * frame[members, 0][:, None] * numpy.arange(-half, half + 1))
                other = numpy.exp(-1j * spacing * frame[members, 1][:, None] * numpy.arange(-half, half + 1))
                maps.append(abs(phase.T @ other) ** 2 / members.sum())
            self.close(group["map"][:], numpy.mean(maps, axis=0), PARTICLES)
            k = spacing * numpy.hypot(m, n)
            inside = (k > 0) & (k <= half * spacing * (1 + 1e-12)) & ((m > 0) | ((m == 0) & (n > 0)))
            width = max(0.05, spacing)
            ring = numpy.floor(k / width).astype(int)
            present = sorted(set(ring[inside]))
            values = numpy.array([[s[inside & (ring == i)].mean() for i in present] for s in maps])
            value, error = mean_and_error(values.reshape(20, 2, -1).mean(axis=1))
            self.close(group["ring/value"][:], value, PARTICLES)
            self.close(group["ring/error"][:], error, PARTICLES)
            self.close(group["ring/wavenumber"][:], [k[inside & (ring == i)].mean() for i in present])
            mean = numpy.mean(maps, axis=0)
            sixfold = [abs((mean * numpy.exp(6j * numpy.arctan2(n, m)))[inside & (ring == i)].sum())
                       / mean[inside & (ring == i)].sum() for i in present]
            self.close(group["ring/anisotropy"][:], sixfold)

    def check_order(self, order, frames, distances):
        psi = numpy.array([bond_order(frame) for frame in frames])
        glob = abs(psi.mean(axis=1)).reshape(20, 2).mean(axis=1)
        self.close([order["global"][0], order["global_error"][0]], mean_and_error(glob))
        local = abs(psi).mean(axis=1).reshape(20, 2).mean(axis=1)
        self.close([order["local"][0], order["local_error"][0]], mean_and_error(local))
        upper = numpy.triu_indices(PARTICLES, 1)
        products = (psi[:, :, None].conj() * psi[:, None, :]).real[:, upper[0], upper[1]]
        r = order["correlation/r"][:]
        bins = numpy.floor(distances / 0.25).astype(int)
        for i in range(len(r)):
            here = bins == i
            numpy.testing.assert_equal(order["correlation/count"][i], here.sum())
            if not here.any():
                continue
            self.close(order["correlation/value"][i], products[here].mean())
            pairs, sums = ([x.reshape(20, -1).sum(axis=1) for x in (here.astype(float), products * here)])
            if (pairs < here.sum()).all():  # leaving out any block leaves pairs
                self.close(order["correlation/error"][i], jackknife(lambda n, total, _: total / n, pairs, sums)[1])

    def check_momenta(self, velocity):
        r, v = self.position, relative(self.velocity)
        for i, wavenumber in enumerate(velocity["transverse/wavenumber"][:]):
            if i % 4:
                continue
            modes = None
            for candidate in (2 * math.pi / LENGTH * 1.25**j for j in range(60)):
                modes = shell(candidate)
                if abs(numpy.hypot(*modes.T).mean() * 2 * math.pi / LENGTH - wavenumber) < 1e-9:
                    break
            along, across = [], []
            for f in range(40):
                for m in modes:
                    e = m / numpy.hypot(*m)
                    j = (MASS[:, None] * v[f] * numpy.exp(-2j * math.pi / LENGTH * (r[f] @ m))[:, None]).sum(axis=0)
                    along.append(abs(j @ e) ** 2 / MASS.sum())
                    across.append(abs(j[1] * e[0] - j[0] * e[1]) ** 2 / MASS.sum())
            for name, values in (("longitudinal", along), ("transverse", across)):
                value, error = mean_and_error(numpy.reshape(values, (20, -1)).mean(axis=1))
                self.close(velocity[name]["value"][i], value)
                self.close(velocity[name]["error"][i], error)
