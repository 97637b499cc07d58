"""sandglass analyze against a brute-force evaluation of every quantity, straight from its definition, on random frames."""

import json
import math

import h5py
import numpy

import program

PARTICLES, FRAMES, LENGTH, STEP, BLOCKS = 60, 41, 24.0, 0.5, 4
STEPS = (FRAMES - 1) // BLOCKS  # of a block
RADIUS = numpy.where(numpy.arange(PARTICLES) % 3 == 1, 1.43, 1.0)
MASS = RADIUS**2
GROUPS = {"all": RADIUS > 0, "small": RADIUS == 1, "big": RADIUS > 1}
OVERLAP, WAVENUMBERS, MODES = 0.6, [0.7, 2.0], 24


def trajectory(seed=1):
    """Unwrapped positions and velocities, [frame, disk, 2]: a random walk in steps of 0.4 per component."""
    generator = numpy.random.default_rng(seed)
    start = generator.uniform(0, LENGTH, (1, PARTICLES, 2))
    walk = numpy.cumsum(generator.normal(0, 0.4, (FRAMES, PARTICLES, 2)), axis=0)
    return start + walk, generator.normal(0, 1, (FRAMES, PARTICLES, 2))


def write_h5md(path, position, velocity=None, images=True):
    with h5py.File(path, "w") as file:
        file.create_group("h5md").attrs["version"] = [1, 1]
        disks = file.create_group("particles/all")
        disks["box/edges"] = [LENGTH, LENGTH]
        disks["species"] = (RADIUS > 1).astype("u1")
        disks["radius"] = RADIUS
        disks["mass"] = MASS
        image = numpy.floor(position / LENGTH).astype("i4")
        values = {"position": position - image * LENGTH}
        if images:
            values["image"] = image
        if velocity is not None:
            values["velocity"] = velocity
        for name, value in values.items():
            disks[f"{name}/value"] = value
            disks[f"{name}/time"] = STEP * numpy.arange(len(position))
            disks[f"{name}/step"] = numpy.arange(len(position))


def write_xyz(path, position, velocity, images=True):
    image = numpy.floor(position / LENGTH).astype(int)
    with open(path, "w") as file:
        for f in range(len(position)):
            file.write(f"{PARTICLES}\n")
            properties = "species:S:1:pos:R:3:velo:R:3:radius:R:1:mass:R:1" + (":image:I:2" if images else "")
            file.write(f'Lattice="{LENGTH} 0 0 0 {LENGTH} 0 0 0 1" Properties={properties} Time={f * STEP!r}\n')
            for i in range(PARTICLES):
                x, y = position[f, i] - image[f, i] * LENGTH
                words = ["AB"[int(RADIUS[i] > 1)], float(x), float(y), 0, *map(float, velocity[f, i]), 0, RADIUS[i], MASS[i]]
                file.write(" ".join(map(str, words + (list(image[f, i]) if images else []))) + "\n")


def write_lammps(path, position, columns="id type x y ix iy vx vy mass", scale=1.0, shuffle=True):
    """Lengths in units of `scale` R_s; atoms in another order in every frame."""
    generator = numpy.random.default_rng(9)
    position, velocity = position
    with open(path, "w") as file:
        for f in range(len(position)):
            low = -3.25
            file.write(f"ITEM: TIMESTEP\n{100 * f}\nITEM: TIME\n{f * STEP!r}\nITEM: NUMBER OF ATOMS\n{PARTICLES}\n")
            bounds = f"{low!r} {low + LENGTH * scale!r}\n"
            file.write(f"ITEM: BOX BOUNDS pp pp pp\n{bounds}{bounds}-0.5 0.5\nITEM: ATOMS {columns}\n")
            image = numpy.floor(position[f] / LENGTH).astype(int)
            for i in generator.permutation(PARTICLES) if shuffle else range(PARTICLES):
                wrapped = (position[f, i] - image[i] * LENGTH)
                values = {"id": i + 1, "type": 1 + (RADIUS[i] > 1), "mass": MASS[i],
                          "radius": RADIUS[i] * scale, "diameter": 2 * RADIUS[i] * scale}
                for axis, name in enumerate("xy"):
                    values[name] = wrapped[axis] * scale + low
                    values[name + "u"] = position[f, i, axis] * scale + low
                    values[name + "s"] = wrapped[axis] / LENGTH
                    values["i" + name] = image[i, axis]
                    values["v" + name] = velocity[f, i, axis] * scale
                file.write(" ".join(repr(v) if isinstance(v, float) else str(v)
                                    for v in (values[c].item() if hasattr(values[c], "item") else values[c]
                                              for c in columns.split())) + "\n")


def relative(values):
    """Relative to the centre of mass."""
    return values - (values * MASS[:, None]).sum(axis=1, keepdims=True) / MASS.sum()


def lags():
    found, j = [], 0
    while not found or found[-1] < STEPS:
        lag = min(STEPS, math.floor(10 ** (j / 12) + 0.5))
        if not found or lag > found[-1]:
            found.append(lag)
        j += 1
    return found


def shell(wavenumber):
    """The wave vectors (m, n) of a shell as documented: whole sets of equal length, nearest first, 4 to 6 vectors."""
    wanted = wavenumber * LENGTH / (2 * math.pi)
    sets = {}
    for m in range(0, 60):
        for n in range(-60, 60):
            if m > 0 and n != 0 or m == 0 and n > 0 or n == 0 and m > 0:
                sets.setdefault(m * m + n * n, []).append((m, n))
    chosen, nearest = [], None
    for square in sorted(sets, key=lambda s: (abs(math.sqrt(s) - wanted), s)):
        vectors, length = sets[square], math.sqrt(square)
        if len(chosen) + len(vectors) > 6 or nearest and abs(length - nearest) > 0.05 * nearest:
            continue
        nearest = nearest or length
        chosen += vectors
        if len(chosen) >= 4:
            break
    return numpy.array(chosen)


def nearest_image(d):
    return d - LENGTH * numpy.round(d / LENGTH)


def mean_and_error(by_block):
    by_block = numpy.asarray(by_block)
    return by_block.mean(axis=0), by_block.std(axis=0, ddof=1) / math.sqrt(len(by_block))


def jackknife(statistic, *by_block):
    blocks = len(by_block[0])
    left = [statistic(*[numpy.delete(b, i, axis=0).mean(axis=0) for b in by_block], blocks - 1) for i in range(blocks)]
    error = numpy.sqrt((blocks - 1) / blocks * ((numpy.array(left) - numpy.mean(left, axis=0)) ** 2).sum(axis=0))
    return statistic(*[b.mean(axis=0) for b in by_block], blocks), error


class BruteForce(program.Case):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.position, cls.velocity = trajectory()

    def analyse(self, path, *options):
        out = self.folder / ("out-" + path.name)
        self.run_ok("analyze", path, "-o", out, "--blocks", BLOCKS, "--wavenumbers", ",".join(map(str, WAVENUMBERS)), *options)
        return out

    def close(self, found, wanted, scale=1.0):
        """Cosines are right to 1e-13, sums of 60 terms of order `scale` to 1e-14 of it: 1e-10 leaves room."""
        numpy.testing.assert_allclose(found, wanted, rtol=1e-9, atol=1e-10 * scale)

    def test_everything(self):
        path = self.folder / "random.h5"
        write_h5md(path, self.position, self.velocity)
        out = self.analyse(path)
        with h5py.File(out / "observables.h5") as file:
            self.check_dynamics(file["dynamics"])
            self.check_heterogeneity(file["dynamics"])
            self.check_structure(file["structure"])
            temperatures = file["timeseries/intervals/temperature_all"][:]
        velocity = relative(self.velocity)
        kinetic = (MASS[:, None] * velocity**2).sum(axis=2).mean(axis=1) / 2
        # An interval's samples begin at its start; its end belongs to the next one.
        self.close(temperatures, [kinetic[b * STEPS:(b + 1) * STEPS].mean() for b in range(BLOCKS)])
        summary = json.loads((out / "summary.json").read_text())
        self.assertAlmostEqual(summary["packing_fraction"], math.pi * (RADIUS**2).sum() / LENGTH**2, places=12)
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
            counts = [len(self.pairs(lag)) * members.sum() for lag in lags()]
            numpy.testing.assert_array_equal(group["mean_square_displacement/count"][:], counts)
            self.check(group["non_gaussian"], *jackknife(lambda m, f, n: f / (2 * m**2) - 1, msd, fourth))
            self.close(group["non_gaussian/interval_value"][:], fourth / (2 * msd**2) - 1)
            vacf = self.by_block(lambda a, b: (v[a] * v[b])[members].sum(axis=1).mean())
            self.check(group["velocity_autocorrelation"], *mean_and_error(vacf))
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
            if here.any():
                self.close(order["correlation/value"][i], products[here].mean())

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


def bond_order(frame):
    """psi_6 of each disk from its cell in the radical tessellation: the square of the box cut by every other disk."""
    result = []
    for i in range(PARTICLES):
        d = nearest_image(frame - frame[i])
        cell = [(complex(x, y) * LENGTH / 2, None) for x, y in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
        for j in numpy.argsort(numpy.hypot(*d.T)):
            if j == i:
                continue
            distance = math.hypot(*d[j])
            normal = complex(*d[j]) / distance
            height = (distance**2 + RADIUS[i] ** 2 - RADIUS[j] ** 2) / (2 * distance)
            above = [(normal.conjugate() * corner).real - height for corner, _ in cell]
            cut = []
            for a, (corner, side) in enumerate(cell):
                b = (a + 1) % len(cell)
                if above[a] <= 0:
                    cut.append((corner, side))
                if (above[a] <= 0) != (above[b] <= 0):
                    crossing = corner + above[a] / (above[a] - above[b]) * (cell[b][0] - corner)
                    cut.append((crossing, j if above[a] <= 0 else side))
            cell = cut
        total, perimeter = 0, 0
        for a, (corner, side) in enumerate(cell):
            if side is None:
                continue
            length = abs(cell[(a + 1) % len(cell)][0] - corner)
            total += length * (complex(*d[side]) / abs(complex(*d[side]))) ** 6
            perimeter += length
        result.append(total / perimeter if perimeter else 0)  # the cell of a disk inside a larger one is empty
    return result


class Formats(BruteForce):
    """The same frames in other formats give the same numbers."""

    def test_everything(self):
        reference = self.folder / "reference.h5"
        write_h5md(reference, self.position, self.velocity)
        expected = self.analyse(reference) / "observables.h5"
        both = (self.position, self.velocity)
        write_xyz(self.folder / "all.xyz", self.position, self.velocity)
        write_xyz(self.folder / "nearest.xyz", self.position, self.velocity, images=False)
        write_h5md(self.folder / "nearest.h5", self.position, self.velocity, images=False)
        write_lammps(self.folder / "images.dump", both)
        write_lammps(self.folder / "unwrapped.dump", both, "vx vy xu yu mass radius id")
        write_lammps(self.folder / "scaled.dump", both, "id xs ys vx vy diameter mass ix iy", scale=2.5)
        for name, options in (("all.xyz", []), ("nearest.xyz", []), ("nearest.h5", []),
                              ("images.dump", ["--radii", "1,1.43"]), ("unwrapped.dump", []), ("scaled.dump", [])):
            out = self.analyse(self.folder / name, *options)
            with h5py.File(expected) as wanted, h5py.File(out / "observables.h5") as found, self.subTest(name):
                # Ids and lengths go through other roundings: 1e-9, and a distance may fall into the next bin of g(r).
                for path in ("dynamics/small/mean_square_displacement/value", "dynamics/big/velocity_autocorrelation/value",
                             "dynamics/all/self_intermediate_scattering/value", "structure/structure_factor/small/map",
                             "structure/velocity/transverse/value", "dynamics/big/mobility/fastest/value",
                             "structure/bond_order/global"):
                    numpy.testing.assert_allclose(found[path][:], wanted[path][:], rtol=1e-8, atol=1e-9, err_msg=path)

    def test_without_velocities(self):
        write_h5md(self.folder / "still.h5", self.position)
        out = self.analyse(self.folder / "still.h5")
        with h5py.File(out / "observables.h5") as file:
            names = []
            file.visit(names.append)
        self.assertEqual([n for n in names if "velocity" in n or "temperature" in n], [])
        summary = json.loads((out / "summary.json").read_text())
        self.assertIsNone(summary["temperature"]["all"])
        self.assertTrue(any("no velocities" in sentence for sentence in summary["decisions"]))

    def test_frames_too_far_apart_are_noticed(self):
        write_h5md(self.folder / "far.h5", 8 * self.position, images=False)
        summary = json.loads((self.analyse(self.folder / "far.h5") / "summary.json").read_text())
        self.assertTrue(any("nearest image" in sentence for sentence in summary["warnings"]))

    def test_a_run_of_our_own(self):
        out = self.folder / "own"
        self.run_ok("analyze", program.tiny_run() / "trajectory.h5", "-o", out)
        own, run = (json.loads((folder / "summary.json").read_text()) for folder in (out, program.tiny_run()))
        # Steps of our own trajectories count collisions.
        self.assertAlmostEqual(own["collisions_per_particle"], run["collisions_per_particle"], delta=1e-9)
        self.assertEqual(own["box_length"], run["box_length"])


class Refused(program.Case):
    def test_bad_input(self):
        path = self.folder / "bad"
        good = '2\nLattice="20 0 0 0 20 0 0 0 1" Properties=pos:R:2:radius:R:1 Time=0\n1 1 1\n5 5 1\n'
        dump = ("ITEM: TIMESTEP\n0\nITEM: NUMBER OF ATOMS\n2\nITEM: BOX BOUNDS pp pp pp\n0 20\n0 20\n0 1\n"
                "ITEM: ATOMS id x y radius\n1 1 1 1\n2 5 5 1\n")
        for text, word in (("", "no complete frame"), ("hello world\n", "number of its particles"),
                           ("99999999999\n", "impossible"), ("1000000\nx\n", "impossible"), (good.replace("5 5 1\n", ""), "ends before"),
                           (good.replace("20 0 0 0 20", "20 0 0 0 21"), "square"),
                           (good.replace('Lattice="20 0 0 0 20 0 0 0 1" ', ""), "lattice"),
                           (good.replace("5 5 1", "5 nan 1"), "finite"), (good.replace("5 5 1", "5 5"), "columns"),
                           (good.replace("5 5 1", "5 1e300 1"), "boxes away"), (good.replace("1 1 1", "1 1 -1"), "radius"),
                           (good + good.replace("Time=0", "Time=1").replace("2\n", "3\n", 1) + "7 7 1\n", "particles"),
                           (good + good.replace("Time=0", "Time=1") + good.replace("Time=0", "Time=5"), "evenly"),
                           (good.replace("20 0 0 0 20", "5 0 0 0 5"), "too small"),
                           (dump.replace("0 20\n0 20", "0 20 3\n0 20 0"), "tilted"), (dump.replace("2 5 5 1\n", ""), "ends"),
                           (dump.replace("2 5 5", "1 5 5"), "same id"), (dump.replace(" radius", " c_1"), "--radii"),
                           (dump.replace("x y", "a b"), "positions"), ("\x89HDF\r\n\x1a\n", "hdf5")):
            path.write_bytes(text.encode("latin-1"))
            with self.subTest(word=word, text=text[:40]):
                self.refused("analyze", path, "-o", self.folder / "out", saying=[word])
        self.refused("analyze", self.folder / "nowhere", saying=["not there"])
        self.refused("analyze", self.folder, saying=["not a file"])
        path.write_text(good)
        self.refused("analyze", path, "-o", program.tiny_run(), saying=["holds a run"])
        self.refused("analyze", path, "-o", self.folder / "out", "--from", 5, saying=["--from"])
        self.refused("analyze", path, "-o", self.folder / "out", "--stride", 0)
