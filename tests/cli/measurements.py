"""What a run measures, against what is known of a fluid of elastic disks in equilibrium."""

import json
import math

import h5py
import numpy

import program

ELASTIC = ["system.particles=1000", "system.packing_fraction=0.4", "drive.kind=none", "collision.restitution=1",
           "run.equilibrate=100", "run.collisions=2000", "run.intervals=10", "observe.structure_frames=200"]


class Equilibrium(program.Case):
    def test_elastic_disks(self):
        out = self.folder / "elastic"
        settings = [part for setting in ELASTIC for part in ("--set", setting)]
        self.run_ok("run", self.tiny, "-o", out, *settings)
        summary = json.loads((out / "summary.json").read_text())
        with h5py.File(out / "observables.h5") as file:
            self.check_momenta(file["structure/velocity"])
            self.check_contacts(summary)
            self.check_flows(file["timeseries/intervals"], summary)
            self.check_diffusion(summary)
            self.check_methods(file["dynamics"], summary)
            self.assertEqual(file["dynamics/waiting_time"].shape, (10,))
            self.assertEqual(file["dynamics/small/self_intermediate_scattering/interval_value"].shape[:2], (10, 2))

    def check_momenta(self, velocity):
        # Equipartition: T = 1 at every wavenumber, in both components. Errors come from 20 blocks of 10 frames, so a
        # deviation in units of them is Student's t with 19 degrees of freedom: sigma^2 = 19 / 17 each, some 40 values.
        deviations = numpy.concatenate([(velocity[name]["value"][:] - 1) / velocity[name]["error"][:]
                                        for name in ("transverse", "longitudinal")])
        self.assertLess(abs(deviations).max(), 6)
        self.assertLess((deviations**2).mean(), 19 / 17 * (1 + 5 * math.sqrt(2.5 / len(deviations))))

    def check_contacts(self, summary):
        # omega_ij = sqrt(2 pi) n_j s_ij chi_ij sqrt(T/m_i + T/m_j), exact in equilibrium: the counted rates give chi.
        radius, mass = {"small": 1, "big": 1.43}, {"small": 1, "big": 1.43**2}
        density = 500 / summary["box_length"] ** 2
        for pair, chi in summary["contact_value"].items():
            a, b = pair.split("_")
            rate = summary["collision_rate_by_pair"][pair]
            expected = rate / (math.sqrt(2 * math.pi) * density * (radius[a] + radius[b])
                               * math.sqrt(1 / mass[a] + 1 / mass[b]))
            error = summary["errors"]["contact_value_" + pair]
            self.assertLess(error, 0.15 * chi)
            # 5 sigma of t with 19 degrees of freedom; the parabola leaves out less than 1 %, finite N 1/N.
            self.assertLess(abs(chi - expected), 5 * error + 0.012 * expected)
        both = summary["collision_rate_by_pair"]
        self.assertAlmostEqual(both["small_big"], both["big_small"], places=12)  # as many small as big disks

    def check_flows(self, intervals, summary):
        self.assertAlmostEqual(intervals["compressibility_factor"][:].mean(), summary["compressibility_factor"], places=10)
        for name in ("injected", "dissipated"):  # 2^-53 per collision, in either direction
            self.assertLess(abs(intervals[name][:]).max(), 1e-12)

    def check_methods(self, dynamics, summary):
        """D by both methods from the curves of the intervals, with jackknife errors: the numbers of the summary."""
        for group in ("small", "big", "all"):
            msd, running = (dynamics[group][name] for name in ("mean_square_displacement", "running_diffusion"))
            time, squares, d = msd["time"][:], msd["interval_value"][:], summary["diffusion"][group]
            at = d["at_collisions"] / summary["collision_rate"]
            first = numpy.argmax(time >= at / 1.5 * (1 - 1e-9))  # the slope is that over a factor of 1.5 to both sides
            slopes = (squares[:, -1] - squares[:, first]) / (4 * (time[-1] - time[first])) / summary["collision_rate"]
            areas = running["interval_value"][:, -1] / summary["collision_rate"]
            for values, value, error in ((slopes, "from_msd", "error"), (areas, "from_vacf", "vacf_error")):
                # Of a mean the jackknife error is the standard error.
                self.assertAlmostEqual(d[value] / values.mean(), 1, places=9)
                self.assertAlmostEqual(d[error] / (values.std(ddof=1) / math.sqrt(len(values))), 1, places=7)

    def check_diffusion(self, summary):
        for group in ("small", "big", "all"):
            d = summary["diffusion"][group]
            self.assertAlmostEqual(d["at_collisions"], summary["collision_rate"] * summary["time"] / 10, places=6)
            # Slope and integral are the same of an infinite sample. The slope is that of a range of lags, over which D
            # grows by a few per cent (long-time tail).
            self.assertLess(abs(d["from_msd"] - d["from_vacf"]), 5 * math.hypot(d["error"], d["vacf_error"]) + 0.05 * d["from_msd"])
        small = summary["relaxation_time"]["0.5"]
        self.assertGreater(small["small"], 0)
        self.assertLess(small["small"], small["big"])
