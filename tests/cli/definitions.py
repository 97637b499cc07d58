"""What sandglass analyze computes, straight from its definitions and without regard to time."""

import math

import numpy

from stored_frames import LENGTH, MASS, PARTICLES, RADIUS, STEPS


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
