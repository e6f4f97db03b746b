"""capture: photographs that the program makes of a table, and the table that it makes of them."""

import shutil
import unittest

import h5py
import numpy

import program

SMALL = ("--radius-px", "2", "--lattice-px", "6", "--exposures", "2", "--calibration-frames", "2",
         "--scale", "2.5", "--quiet")


class Capture(program.ProgramTest):
    @classmethod
    def setUpClass(cls):
        cls.cache = {}

    def setUp(self):
        super().setUp()
        self.write_json("sample.json", program.sample(14, 13, 2, channels=1, materials=[
            {"name": "light", "sigma_a": 0.01, "sigma_s_prime": 2.2},
            {"name": "dark", "sigma_a": 0.05, "sigma_s_prime": 0.9}]))

    def synthesize(self, name="photos", *more):
        self.succeed("capture", "--synthesize", "sample.json", "-o", name, *SMALL, *more)

    def test_round_trip(self):
        self.succeed("simulate", "sample.json", "-o", "truth.h5")
        self.synthesize()
        text = self.succeed("capture", "photos", "-o", "table.h5", "--json", "report.json")
        self.assertIn("captured table, 14 x 13 pixels of 0.5 mm, 7 offsets, 1 channels", text)
        self.succeed("compare", "truth.h5", "table.h5", "--json", "errors.json", "--quiet")
        errors = self.read_json("errors.json")
        self.assertLess(errors["relative_error"]["mean"], 0.03)
        self.assertLess(errors["albedo_error"]["mean"], 0.01)
        report = self.read_json("report.json")
        self.assertLess(report["white_error"], 0.02)
        with h5py.File(self.folder / "table.h5") as table:
            self.assertEqual(table.attrs["symmetric"], 1)
            self.assertTrue(program.json.loads(table.attrs["provenance"])["simulated"])
            self.assertGreater(table.attrs["noise_floor"][0] + table.attrs["noise_gain"][0], 0)

    def test_noise_model_goes_with_the_fit(self):
        """The fit of a noisy capture is that of the truth, on average over the pixels."""
        self.succeed("simulate", "sample.json", "-o", "truth.h5")
        self.synthesize("photos", "--full-well", "1000", "--read-noise", "8")
        self.succeed("capture", "photos", "-o", "table.h5", "--quiet")
        self.succeed("fit", "truth.h5", "-o", "truth-map.h5", "--quiet")
        self.assertIn("by the noise model", self.succeed("fit", "table.h5", "-o", "map.h5"))
        with h5py.File(self.folder / "map.h5") as noisy, h5py.File(self.folder / "truth-map.h5") as exact:
            difference = noisy["log_profile"][:].astype(float) - exact["log_profile"][:]
        for bias in difference.mean(axis=(0, 2, 3)):
            self.assertLess(abs(bias), 0.05)  # single pixels differ by 0.07 to 0.19

    def test_table_of_table(self):
        """A table is photographed; its own values come back, in both directions where asked for."""
        self.succeed("simulate", "sample.json", "-o", "truth.h5")
        self.succeed("capture", "--synthesize", "truth.h5", "-o", "photos", *SMALL, "--format", "exr")
        self.succeed("capture", "photos", "-o", "raw.h5", "--raw", "--quiet")
        self.succeed("fit", "raw.h5", "-o", "map.h5", "--quiet")
        self.succeed("compare", "raw.h5", "map.h5", "--json", "fit.json", "--quiet")
        self.assertGreater(self.read_json("fit.json")["asymmetry"], 0)
        self.succeed("capture", "photos", "-o", "table.h5", "--quiet")
        self.succeed("compare", "truth.h5", "table.h5", "--json", "errors.json", "--quiet")
        self.assertLess(self.read_json("errors.json")["relative_error"]["mean"], 0.03)

    def test_same_seed_same_frames(self):
        self.synthesize("one", "--threads", "1")
        self.synthesize("two", "--threads", "2")
        self.synthesize("other", "--seed", "2")
        frame = "dots_003_001_1.png"
        self.assertEqual(self.read_bytes("one/" + frame), self.read_bytes("two/" + frame))
        self.assertNotEqual(self.read_bytes("one/" + frame), self.read_bytes("other/" + frame))

    def test_what_is_wrong_with_a_folder(self):
        self.synthesize("good")

        def fails(message, spoil):
            shutil.rmtree(self.folder / "photos", ignore_errors=True)
            shutil.copytree(self.folder / "good", self.folder / "photos")
            spoil(self.folder / "photos")
            self.fail_with(1, message, "capture", "photos", "-o", "table.h5")
            self.assertNotIn("table.h5", self.names())

        def remove(pattern):
            return lambda folder: [path.unlink() for path in folder.glob(pattern)]

        def change(key, value):
            def spoil(folder):
                meta = program.json.loads((folder / "meta.json").read_text())
                meta[key] = value
                (folder / "meta.json").write_text(program.json.dumps(meta))
            return spoil

        def copy(source, pattern):
            return lambda folder: [shutil.copy(folder / source, path) for path in folder.glob(pattern)]

        fails("photos/meta.json: expected a readable file, found no such file", remove("meta.json"))
        fails("photos: expected dark frames, dark_0_0.png and so on, found none", remove("dark_*"))
        fails("photos: expected frames of exposure 2, 5 s, found none",
              change("exposures_s", [0.01, 0.08, 5]))
        fails("photos/dots_003_002_1.png: expected a frame of 0.08 s, found no such file",
              remove("dots_003_002_1.png"))
        with_size = program.json.loads((self.folder / "good" / "meta.json").read_text())["camera_size"]
        fails(f"photos/dark_0_0.png: size: expected 30 x 20 pixels of 1 channel, found "
              f"{with_size[0]} x {with_size[1]} pixels of 1 channel", change("camera_size", [30, 20]))
        fails("photos: dots: expected dots that stand out of the background, found none",
              copy("dark_0_0.png", "reference_dots_*"))
        fails("photos: lattice: expected 4 x 4 dots, as the description says, found 9 dots, of "
              "which 9 make a lattice of 3 x 3",
              lambda folder: (change("lattice_px", 4)(folder), change("radius_px", 1)(folder)))
        fails("photos/meta.json: /latice_px: expected a known key, found 'latice_px' (did you mean "
              "'lattice_px'?)", change("latice_px", 4))

    def test_saturated_everywhere(self):
        self.synthesize("photos", "--reference-level", "100")
        status, _, errors = self.run_program("capture", "photos", "-o", "table.h5")
        self.assertEqual(status, 1)
        self.assertRegex(errors, r"^parian: error: photos: reference_0_0.png: expected pixels that are "
                         r"not saturated at 0.01 s, found \d+ of \d+ values saturated\n$")

    def test_frames_must_hold_numbers(self):
        self.synthesize("photos", "--format", "exr")
        data = bytearray(self.read_bytes("photos/white_0_0.exr"))
        (self.folder / "photos/white_0_0.exr").write_bytes(data[:200])
        status, _, errors = self.run_program("capture", "photos", "-o", "table.h5")
        self.assertEqual(status, 1)
        self.assertTrue(errors.startswith("parian: error: photos/white_0_0.exr: expected"), errors)

    def test_a_folder_is_not_overwritten(self):
        self.synthesize()
        self.fail_with(2, "photos: expected a new or empty folder, found one with a meta.json",
                       "capture", "--synthesize", "sample.json", "-o", "photos", *SMALL)


if __name__ == "__main__":
    program.main()
