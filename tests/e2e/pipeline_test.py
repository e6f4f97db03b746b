"""simulate -> fit -> compare -> reconstruct -> relight -> info, on a small chessboard."""

import math

import h5py
import numpy

import program

COMPARE_KEYS = {
    "relative_error": {"min", "mean", "max"}, "relative_error_l1": {"min", "mean", "max"},
    "albedo_error": {"mean", "max"}, "psnr_db": {"uniform", "disc", "line"},
    "ssim": {"uniform", "disc", "line"}, "log_rms": None, "held_out": None,
    "missing_in_model": None, "pixels_skipped": None, "asymmetry": None, "bytes_table": None,
    "bytes_material": None,
}


class Pipeline(program.ProgramTest):
    def simulate_and_fit(self, *flags):
        self.succeed("simulate", "sample.json", "-o", "table.h5", "--quiet")
        self.succeed("fit", "table.h5", "-o", "map.h5", "--quiet", *flags)

    def test_table_follows_the_format(self):
        text = self.succeed("simulate", "sample.json", "-o", "table.h5")
        self.assertIn("simulated", text)
        with h5py.File(self.folder / "table.h5") as file:
            self.assertEqual(file.attrs["format"], "parian-bssrdf-table")
            self.assertEqual(file.attrs["version"], 1)
            self.assertEqual(file.attrs["pixel_pitch_mm"], 0.5)
            offsets, values = file["offsets"][:], file["reflectance"]
            self.assertEqual(values.shape, (3, len(offsets), 20, 24))
            self.assertEqual(values.chunks, (1, 1, 20, 24))
            self.assertIn([0, 0], offsets.tolist())
            for d, (dx, dy) in enumerate(offsets):
                inside = values[:, d, :20 - dy, max(0, -dx):24 - max(0, dx)]
                self.assertTrue(numpy.all(inside > 0))
                self.assertEqual(numpy.isfinite(values[:, d]).sum(), inside.size)

    def test_deflated_table_holds_the_same_values(self):
        self.succeed("simulate", "sample.json", "-o", "plain.h5")
        self.succeed("simulate", "sample.json", "-o", "packed.h5", "--deflate", 6)
        self.assertLess(len(self.read_bytes("packed.h5")), len(self.read_bytes("plain.h5")))
        with h5py.File(self.folder / "plain.h5") as a, h5py.File(self.folder / "packed.h5") as b:
            numpy.testing.assert_array_equal(a["reflectance"][:], b["reflectance"][:])

    def test_compare_reports_exactly_the_designed_keys(self):
        self.simulate_and_fit()
        text = self.succeed("compare", "table.h5", "map.h5", "--json", "report.json",
                            "--error-image", "errors.png", "--plot", "6,5", "--plot", "12,10",
                            "--plot-dir", "plots")
        self.assertIn("relative error", text)
        report = self.read_json("report.json")
        self.assertEqual(set(report), set(COMPARE_KEYS))
        for key, members in COMPARE_KEYS.items():
            if members:
                self.assertEqual(set(report[key]), members, key)
        self.assertGreater(report["relative_error"]["min"], 0)
        self.assertLess(report["relative_error"]["mean"], 0.15)
        self.assertLess(report["relative_error"]["mean"], report["relative_error"]["max"])
        self.assertGreater(report["psnr_db"]["uniform"], 25)
        self.assertIsNone(report["held_out"])
        self.assertIsNone(report["asymmetry"])
        self.assertEqual(report["missing_in_model"], 0)
        with h5py.File(self.folder / "table.h5") as file:
            self.assertEqual(report["bytes_table"], 4 * file["reflectance"].size)
        self.assertEqual(report["bytes_material"], len(self.read_bytes("map.h5")))
        for name in ("errors.png", "plots/profile-6-5.png", "plots/profile-12-10.png"):
            self.assertEqual(self.read_bytes(name)[:4], b"\x89PNG", name)

    def test_figures_go_to_standard_output_alone(self):
        self.simulate_and_fit()
        text = self.succeed("compare", "table.h5", "map.h5", "--json", "-")
        self.assertEqual(set(program.json.loads(text)), set(COMPARE_KEYS))

    def test_held_out_pairs_are_judged(self):
        self.simulate_and_fit("--hold-out", "0.1", "--seed", "3")
        self.succeed("compare", "table.h5", "map.h5", "--json", "report.json")
        held_out = self.read_json("report.json")["held_out"]
        with h5py.File(self.folder / "table.h5") as file:
            measured = numpy.isfinite(file["reflectance"][:]).sum()
        self.assertAlmostEqual(held_out["pairs"] / measured, 0.1, delta=0.02)
        self.assertGreater(held_out["relative_error"]["mean"], 0)

    def test_a_table_compares_with_itself(self):
        self.succeed("simulate", "sample.json", "-o", "table.h5")
        self.succeed("compare", "table.h5", "table.h5", "--json", "report.json")
        report = self.read_json("report.json")
        self.assertEqual(report["relative_error"], {"min": 0, "mean": 0, "max": 0})
        self.assertEqual(report["psnr_db"], {"uniform": None, "disc": None, "line": None})
        self.assertEqual(report["ssim"]["disc"], 1)

    def test_reconstruction_is_the_models_own_table(self):
        self.simulate_and_fit()
        self.succeed("reconstruct", "map.h5", "--like", "table.h5", "-o", "again.h5")
        self.succeed("compare", "again.h5", "map.h5", "--json", "report.json")
        report = self.read_json("report.json")
        self.assertLess(report["relative_error"]["max"], 1e-6)
        with h5py.File(self.folder / "table.h5") as a, h5py.File(self.folder / "again.h5") as b:
            numpy.testing.assert_array_equal(a["offsets"][:], b["offsets"][:])
            numpy.testing.assert_array_equal(numpy.isfinite(a["reflectance"][:]),
                                             numpy.isfinite(b["reflectance"][:]))

    def test_reconstruction_fills_what_was_not_measured(self):
        self.simulate_and_fit()
        with h5py.File(self.folder / "table.h5", "r+") as file:
            file["reflectance"][:, 3, 2, 4] = numpy.nan
        self.succeed("reconstruct", "map.h5", "--like", "table.h5", "-o", "again.h5")
        with h5py.File(self.folder / "again.h5") as file:
            self.assertTrue(numpy.all(file["reflectance"][:, 3, 2, 4] > 0))

    def test_relit_flats_of_table_and_fit_agree(self):
        self.simulate_and_fit()
        for light in ("uniform", "disc", "line"):
            self.succeed("relight", "table.h5", "--light", light, "-o", f"{light}-table.exr")
            self.succeed("relight", "map.h5", "--like", "table.h5", "--light", light,
                         "-o", f"{light}-fit.exr")
        figures = [program.json.loads(self.succeed("info", f"disc-{name}.exr", "--json", "-"))
                   for name in ("table", "fit")]
        for a, b in zip(figures[0]["values"], figures[1]["values"]):
            self.assertAlmostEqual(b["mean"] / a["mean"], 1, delta=0.05)

    def test_exposure_multiplies(self):
        self.succeed("simulate", "sample.json", "-o", "table.h5")
        self.succeed("relight", "table.h5", "-o", "plain.exr")
        self.succeed("relight", "table.h5", "-o", "brighter.exr", "--exposure", "2")
        plain, brighter = (program.json.loads(self.succeed("info", name, "--json", "-"))
                           for name in ("plain.exr", "brighter.exr"))
        for a, b in zip(plain["values"], brighter["values"]):
            self.assertEqual(b["max"], 4 * a["max"])

    def test_an_image_lights_the_sample(self):
        self.succeed("simulate", "sample.json", "-o", "table.h5")
        self.succeed("relight", "table.h5", "--light", "uniform", "-o", "light.exr")
        self.succeed("relight", "table.h5", "--light", "light.exr", "-o", "twice.exr")
        once, twice = (program.json.loads(self.succeed("info", name, "--json", "-"))
                       for name in ("light.exr", "twice.exr"))
        for a, b in zip(once["values"], twice["values"]):
            self.assertLessEqual(b["max"], a["max"] ** 2 * (1 + 1e-6))

    def test_info_knows_every_kind_of_file(self):
        self.simulate_and_fit("--segments", "4")
        self.succeed("relight", "table.h5", "-o", "lit.png")
        kinds = {}
        for name in ("table.h5", "map.h5", "lit.png", "sample.json"):
            self.assertIn("kind", self.succeed("info", name))
            kinds[name] = program.json.loads(self.succeed("info", name, "--json", "-"))
        self.assertEqual([kinds[name]["kind"] for name in kinds],
                         ["BSSRDF table", "profile map", "image", "sample description"])
        for figures in kinds.values():
            self.assertEqual((figures["width"], figures["height"]), (24, 20))
        self.assertEqual(kinds["table.h5"]["missing"], 0)
        self.assertEqual(kinds["table.h5"]["radius_px"], 5)
        self.assertEqual(kinds["map.h5"]["knots"], 5)
        self.assertTrue(kinds["table.h5"]["provenance"]["simulated"])
        self.assertTrue(all(0 < c["min"] <= c["max"] < 1 for c in kinds["table.h5"]["albedo"]))

    def test_a_table_of_an_independent_writer(self):
        stone = program.SOURCE / "data" / "stone-72x64.h5"
        self.succeed("fit", stone, "-o", "map.h5", "--json", "fit.json")
        self.succeed("compare", stone, "map.h5", "--json", "report.json")
        report = self.read_json("report.json")
        self.assertLessEqual(report["relative_error"]["mean"], 0.0255)
        self.assertLessEqual(report["albedo_error"]["mean"], 0.0032)
        self.assertTrue(all(math.isfinite(c["energy"]) for c in self.read_json("fit.json")["channels"]))


if __name__ == "__main__":
    program.main()
