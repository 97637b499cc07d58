"""sandglass analyze on other formats, on frames that lack something, on runs of our own, and on what it must refuse."""

import json

import h5py
import numpy

import program
from stored_frames import Frames, write_h5md, write_lammps, write_xyz


class Formats(Frames):
    """The same frames in other formats give the same numbers."""

    def test_all_formats(self):
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
        page = (out / "report.html").read_text()
        self.assertIn("sandglass analyze", page)
        self.assertIn("measured over a time of", page)
        self.assertNotIn('"unknown"', page)  # what only a run knows is left out


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
