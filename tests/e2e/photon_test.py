"""simulate --engine photon: a table with its noise, stopped and taken up again."""

import signal
import time

import h5py
import numpy

import program

PHOTON = ("simulate", "sample.json", "--engine", "photon")


class Photon(program.ProgramTest):
    def setUp(self):
        super().setUp()
        self.write_json("sample.json", program.sample(10, 9, 3, depth={"voxels_per_pixel": 2, "margin_px": 2}))

    def table(self, name):
        with h5py.File(self.folder / name) as file:
            return dict(file.attrs), file["reflectance"][:], file["offsets"][:]

    def test_table(self):
        text = self.succeed(*PHOTON, "--photons", "800", "-o", "table.h5", "--json", "report.json")
        self.assertIn("table.h5: simulated table, 10 x 9 pixels of 0.5 mm, 15 offsets, 3 channels\n", text)
        self.assertEqual(self.names(), ["report.json", "sample.json", "table.h5"])
        attributes, values, offsets = self.table("table.h5")
        self.assertEqual(attributes["boundary"], "included")
        self.assertEqual(attributes["sampling"], "area")
        self.assertEqual(len(attributes["noise_gain"]), 3)
        self.assertTrue((values[:, 0] > 0).all())
        report = self.read_json("report.json")
        self.assertEqual(report["photons"], 800 * 90 * 3)
        self.assertEqual(report["rounds"], 16)
        for channel in report["channels"]:
            power = sum(channel[key]["value"] for key in ("specular", "reflected", "transmitted", "absorbed"))
            self.assertAlmostEqual(power - channel["roulette"], 1, delta=1e-6)
            self.assertLess(channel["balance"], 1e-6)
        # What is tallied is part of what leaves.
        d = offsets.tolist().index([0, 0])
        self.assertLess(values[0, d].mean() * 0.25, report["channels"][0]["reflected"]["value"])
        # The rest of the pipeline takes it.
        self.succeed("fit", "table.h5", "-o", "map.h5", "--segments", "4", "--weight", "noise", "--quiet")
        self.succeed("compare", "table.h5", "map.h5", "--quiet")
        self.succeed("info", "table.h5")

    def test_same_bits_for_any_number_of_threads(self):
        self.succeed(*PHOTON, "--photons", "200", "-o", "one.h5", "--threads", "1", "--quiet")
        self.succeed(*PHOTON, "--photons", "200", "-o", "two.h5", "--threads", "3", "--quiet")
        self.assertEqual(self.read_bytes("one.h5"), self.read_bytes("two.h5"))

    def stop(self, how, *arguments):
        """Stops a run once it has stored something."""
        process = self.start(*arguments)
        while process.poll() is None and "t.h5.partial" not in self.names():
            time.sleep(0.01)
        self.assertIsNone(process.poll(), "the work was over before it could be stopped")
        process.send_signal(how)
        process.communicate(timeout=60)
        self.assertIn("t.h5.partial", self.names())
        self.assertNotIn("t.h5", self.names())
        return process.returncode

    def test_stopped_runs_are_taken_up(self):
        run = (*PHOTON, "--photons", "12000", "-o", "t.h5", "--checkpoint", "0", "--threads", "1")
        self.assertEqual(self.stop(signal.SIGKILL, *run), -signal.SIGKILL)
        for name in self.names():  # what the kill may have left of a file in the making
            if name not in ("sample.json", "t.h5.partial"):
                (self.folder / name).unlink()
        before = (self.folder / "t.h5.partial").stat().st_mtime_ns
        process = self.start(*run)
        while process.poll() is None and (self.folder / "t.h5.partial").stat().st_mtime_ns == before:
            time.sleep(0.01)
        process.send_signal(signal.SIGINT)
        _, errors = process.communicate(timeout=60)
        self.assertEqual((process.returncode, errors), (1, "parian: error: cancelled\n"))
        self.succeed(*run, "--quiet")
        self.assertEqual(self.names(), ["sample.json", "t.h5"])
        self.succeed(*PHOTON, "--photons", "12000", "-o", "whole.h5", "--quiet")
        self.assertEqual(self.read_bytes("t.h5"), self.read_bytes("whole.h5"))

    def test_what_another_run_has_left_is_not_taken_up(self):
        self.stop(signal.SIGINT, *PHOTON, "--photons", "12000", "-o", "t.h5", "--checkpoint", "0", "--threads", "1")
        status, _, errors = self.run_program(*PHOTON, "--photons", "160", "-o", "t.h5")
        self.assertEqual(status, 0)
        self.assertEqual(errors, "parian: warning: t.h5.partial: attribute 'fingerprint': expected that of this "
                                 "sample and these parameters, found that of another; the simulation starts anew\n")
        self.succeed(*PHOTON, "--photons", "160", "-o", "whole.h5", "--quiet")
        self.assertEqual(self.read_bytes("t.h5"), self.read_bytes("whole.h5"))

    def test_until(self):
        self.succeed(*PHOTON, "--until", "0.2", "-o", "t.h5", "--json", "report.json", "--quiet")
        self.assertLess(self.read_json("report.json")["median_relative_error"], 0.2)

    def test_similarity_keeps_what_is_far_and_the_total(self):
        materials = [{"name": "all", "sigma_a": 0.05, "sigma_s_prime": 3, "g": 0.8}]
        self.write_json("sample.json", program.sample(10, 10, 7, channels=1, materials=materials,
                                                      layout={"kind": "uniform"}))
        near, far, totals = [], [], []
        for name, more in (("g.h5", ()), ("reduced.h5", ("--similarity",))):
            self.succeed(*PHOTON, "--photons", "4000", "-o", name, "--quiet", "--json", "report.json", *more)
            _, values, offsets = self.table(name)
            mean = numpy.nanmean(values[0], axis=(1, 2))
            radius = numpy.hypot(offsets[:, 0], offsets[:, 1])
            near.append(mean[radius == 0].sum())
            far.append(mean[radius >= 6].sum())
            totals.append(self.read_json("report.json")["channels"][0]["reflected"]["value"])
        self.assertAlmostEqual(totals[0], totals[1], delta=0.01)
        self.assertAlmostEqual(far[0] / far[1], 1, delta=0.06)
        self.assertLess(near[0], 0.8 * near[1])  # where light leaves before it has forgotten its direction

    def test_errors(self):
        self.fail_with(2, "--photons: expected --engine photon with it, found --engine analytic",
                       "simulate", "sample.json", "-o", "t.h5", "--photons", "5")
        self.fail_with(2, "--until: expected a value in [0, 1], found 2", *PHOTON, "-o", "t.h5", "--until", "2")
        self.write_json("sample.json", program.sample(depth={"solid": 1}))
        self.fail_with(1, "sample.json: /depth/solid: expected true or false, found the number 1",
                       *PHOTON, "-o", "t.h5")


if __name__ == "__main__":
    program.main()
