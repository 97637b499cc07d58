"""Reads what the program sandglass writes, and draws its figures.

    import sandglass
    run = sandglass.load("runs/glass")
    msd = run["dynamics/small/mean_square_displacement"]
    plt.errorbar(msd["time"], msd["value"], msd["error"])

Needs numpy, h5py and, for sandglass.drawing, matplotlib.
"""
from .runs import Run, load, load_study

__all__ = ["Run", "load", "load_study"]
