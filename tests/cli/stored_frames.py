"""Frames of a random walk, written in every format that sandglass analyze reads."""

import math

import h5py
import numpy

import program

PARTICLES, FRAMES, LENGTH, STEP, BLOCKS = 60, 41, 24.0, 0.5, 4
STEPS = (FRAMES - 1) // BLOCKS  # of a block
RADIUS = numpy.where(numpy.arange(PARTICLES) % 3 == 1, 1.43, 1.0)
MASS = RADIUS**2
GROUPS = {"all": RADIUS > 0, "small": RADIUS == 1, "big": RADIUS > 1}
WAVENUMBERS = [0.7, 2.0]


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


class Frames(program.Case):
    """Cases on one random trajectory."""

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
