"""compress -> compare, relight, reconstruct, render, info; .kbm files read by the Python example."""

import json
import subprocess
import sys

import h5py
import numpy

import program

sys.path.insert(0, str(program.SOURCE / "examples"))
import read_kbm  # noqa: E402


class Blend(program.ProgramTest):
    def setUp(self):
        super().setUp()
        self.succeed("simulate", "sample.json", "-o", "table.h5", "--quiet")

    def compress(self, output, *flags):
        return self.succeed("compress", "table.h5", "-o", output, "-M", 16, *flags)

    def compare(self, name):
        self.succeed("compare", "table.h5", name, "--json", "errors.json", "--quiet")
        return self.read_json("errors.json")

    def test_paper_encoding_has_exactly_the_papers_bytes(self):
        for per_pixel, expected in ((1, 480 * 1), (2, 480 * 6), (3, 480 * 11)):
            self.compress("b.kbm", "--encoding", "paper", "-K", per_pixel, "--json", "f.json")
            figures = self.read_json("f.json")
            spent = figures["bytes"]
            self.assertEqual(spent["profiles"], 12 * 16 * 6)
            self.assertEqual(spent["indices"] + spent["weights"], expected)
            self.assertEqual(spent["file"], len(self.read_bytes("b.kbm")))

    def test_more_bases_per_pixel_and_packed_files(self):
        errors = []
        for per_pixel in (1, 2, 3):
            self.compress("b.kbm", "-K", per_pixel, "--encoding", "paper")
            errors.append(self.compare("b.kbm")["relative_error"]["mean"])
            paper = len(self.read_bytes("b.kbm"))
            self.compress("p.kbm", "-K", per_pixel)
            packed = self.compare("p.kbm")
            self.assertLess(packed["relative_error"]["mean"], 1.05 * errors[-1])
            self.assertLess(packed["bytes_material"], paper)
        self.assertEqual(errors, sorted(errors, reverse=True))

    def test_python_reads_what_the_program_wrote(self):
        self.succeed("fit", "table.h5", "-o", "map.h5", "--quiet")
        for encoding in ("paper", "packed"):
            for per_pixel in (1, 2, 4):
                self.compress("b.kbm", "--encoding", encoding, "-K", per_pixel, "--quiet")
                header, bases, index, weight, gain, dilation = read_kbm.read_blend(
                    self.folder / "b.kbm")
                self.assertEqual((header["width"], header["height"]), (24, 20))
                self.assertEqual((gain, dilation), (None, None))
                numpy.testing.assert_allclose(weight.sum(axis=0), 1, atol=1e-6)
                self.succeed("reconstruct", "b.kbm", "--like", "table.h5", "-o", "back.h5",
                             "--quiet")
                log_p = read_kbm.log_profiles(bases, index, weight)
                with h5py.File(self.folder / "back.h5") as file:
                    here = file["offsets"][:].tolist().index([0, 0])
                    numpy.testing.assert_allclose(file["reflectance"][:, here],
                                                  numpy.exp(log_p[:, 0]), rtol=1e-5)
                    knot = header["knots_mm"].index(1.0)  # two pixels to the right
                    there = file["offsets"][:].tolist().index([2, 0])
                    root = numpy.exp(0.5 * log_p[:, knot])
                    numpy.testing.assert_allclose(file["reflectance"][:, there, :, :-2],
                                                  root[:, :, :-2] * root[:, :, 2:], rtol=1e-5)

    def test_python_reader_as_a_program(self):
        self.compress("b.kbm", "--quiet")
        done = subprocess.run([sys.executable, program.SOURCE / "examples" / "read_kbm.py",
                               self.folder / "b.kbm", "--profile", "3,4"],
                              capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual([len(line.split()) for line in done.stdout.splitlines()], [6, 6, 6])

    def test_blends_work_wherever_maps_do(self):
        self.compress("b.kbm", "--quiet")
        self.assertIn("profile blend", self.succeed("info", "b.kbm"))
        self.succeed("relight", "b.kbm", "--light", "disc", "-o", "lit.png")
        self.succeed("compare", "table.h5", "b.kbm", "--plot", "6,5", "--plot-dir", "plots")
        self.write_json("scene.json", {
            "mesh": {"shape": "sphere", "size_mm": 20},
            "material": {"file": "b.kbm"}, 
            "camera": {"width": 32, "height": 24},
            "lights": [{"type": "environment", "sky": "clear"}],
        })
        self.succeed("render", "scene.json", "-o", "picture.png", "--samples", 2000)

    def test_objectives_each_win_at_their_own(self):
        found = {}
        for objective in ("balanced", "relative", "albedo", "paper"):
            self.compress("b.kbm", "--objective", objective, "--encoding", "paper", "--rounds", 30)
            found[objective] = self.compare("b.kbm")
        relative = {key: value["relative_error"]["mean"] for key, value in found.items()}
        albedo = {key: value["albedo_error"]["mean"] for key, value in found.items()}
        self.assertLess(relative["relative"], relative["albedo"])
        self.assertLess(albedo["albedo"], albedo["relative"])
        self.assertLess(relative["balanced"], relative["paper"])

    def test_limits(self):
        self.compress("b.kbm", "--max-bytes", 4000, "--quiet")
        self.assertLessEqual(len(self.read_bytes("b.kbm")), 4000)
        self.compress("b.kbm", "--max-error", 0.12, "--quiet")
        self.assertLess(self.compare("b.kbm")["relative_error"]["mean"], 0.12)
        status, _, error = self.run_program("compress", "table.h5", "-o", "c.kbm", "--max-bytes",
                                            100)
        self.assertEqual(status, 1)
        self.assertRegex(error, r"^parian: error: --max-bytes: expected at least \d+.*, found 100\n$")
        self.assertNotIn("c.kbm", self.names())

    def test_goes_on_from_a_blend_and_shows_rounds(self):
        self.compress("b.kbm", "--rounds", 2, "--watch", "rounds", "--encoding", "paper", "--json",
                      "first.json")
        rounds = sorted(path.name for path in (self.folder / "rounds").iterdir())
        self.assertEqual(rounds, ["latest.kbm", *(f"round-00{i}-{kind}.png" for i in range(3)
                                                  for kind in ("indices", "weights"))])
        self.succeed("compress", "table.h5", "-o", "c.kbm", "--start", "rounds/latest.kbm", "-K", 3,
                     "--encoding", "paper", "--json", "second.json")
        first, second = self.read_json("first.json"), self.read_json("second.json")
        self.assertAlmostEqual(second["rounds"][0]["energy"], first["energy"], 5)
        self.assertLess(second["energy"], first["energy"])

    def test_from_a_map_with_and_without_its_table(self):
        self.succeed("fit", "table.h5", "-o", "map.h5", "--quiet")
        self.succeed("compress", "map.h5", "-o", "a.kbm", "-M", 16, "--quiet")
        self.succeed("compress", "map.h5", "-o", "b.kbm", "-M", 16, "--table", "table.h5", "--quiet")
        self.assertLess(self.compare("b.kbm")["albedo_error"]["mean"],
                        self.compare("a.kbm")["albedo_error"]["mean"])

    def test_same_bits_for_any_number_of_threads(self):
        self.compress("a.kbm", "-K", 3, "--threads", 1)
        self.compress("b.kbm", "-K", 3, "--threads", 2)
        self.assertEqual(self.read_bytes("a.kbm"), self.read_bytes("b.kbm"))

    def test_errors(self):
        self.fail_with(2, "--bases: expected a value in [1, 65535], found 0", "compress", "table.h5",
                       "-o", "b.kbm", "-M", 0)
        self.fail_with(2, "--table: expected a profile map to compress, found table.h5", "compress",
                       "table.h5", "-o", "b.kbm", "--table", "table.h5")
        (self.folder / "bad.kbm").write_bytes(b"nothing of the kind")
        self.fail_with(1, "bad.kbm: magic number: expected 'KBM1', found another kind of file",
                       "info", "bad.kbm")
        self.compress("b.kbm", "--quiet")
        damaged = bytearray(self.read_bytes("b.kbm"))
        damaged[-3] ^= 1
        (self.folder / "bad.kbm").write_bytes(damaged)
        status, _, error = self.run_program("compare", "table.h5", "bad.kbm")
        self.assertEqual(status, 1)
        self.assertRegex(error, r"^parian: error: bad.kbm: section 'weights': expected checksum "
                                r"[0-9a-f]{8}, found [0-9a-f]{8}: the file is damaged\n$")
        (self.folder / "old.kbm").write_text("kept")
        self.run_program("compress", "nowhere.h5", "-o", "old.kbm")
        self.assertEqual((self.folder / "old.kbm").read_text(), "kept")


if __name__ == "__main__":
    program.main()
