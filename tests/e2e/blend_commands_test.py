"""Every command that takes a material takes a .kbm file, and its figures agree with each other."""

import h5py
import numpy

import program


class BlendCommands(program.ProgramTest):
    def setUp(self):
        super().setUp()
        self.succeed("simulate", "sample.json", "-o", "table.h5", "--quiet")
        self.succeed("compress", "table.h5", "-o", "b.kbm", "-M", 16, "--quiet")

    def info(self, name):
        self.succeed("info", name, "--json", "info.json", "--quiet")
        return self.read_json("info.json")

    def test_info_accounts_for_every_byte(self):
        for encoding in ("packed", "paper"):
            self.succeed("compress", "table.h5", "-o", "b.kbm", "-M", 16, "--encoding", encoding,
                         "--quiet")
            figures = self.info("b.kbm")
            self.assertEqual((figures["kind"], figures["encoding"]), ("profile blend", encoding))
            self.assertEqual((figures["bases"], figures["per_pixel"]), (16, 2))
            self.assertEqual(figures["bytes"], len(self.read_bytes("b.kbm")))
            self.assertEqual(figures["bytes"], sum(figures["bytes_" + part] for part in (
                "profiles", "indices", "weights", "gain_dilation", "overhead")))
            self.assertEqual(figures["bytes_as_paper"], 12 * 16 * 6 + 6 * 480)
            self.assertEqual(figures["pixels_per_base"][0]["mean"], 480 / 16)
            self.assertEqual(figures["provenance"]["kind"], "compress")
        for line in self.succeed("info", "b.kbm").split("provenance")[0].splitlines():
            self.assertRegex(line, r"^(?=.{19} \S)\w+ +\S")  # values stand in one column

    def test_info_agrees_with_the_fit(self):
        self.succeed("fit", "table.h5", "-o", "map.h5", "--quiet")
        blend, fit = self.info("b.kbm"), self.info("map.h5")
        self.assertEqual(blend["knots_mm"], fit["knots_mm"])
        for ours, theirs in zip(blend["albedo"], fit["albedo"]):
            self.assertAlmostEqual(ours["mean"] / theirs["mean"], 1, delta=0.03)

    def test_reconstructs_what_it_is_compared_as(self):
        self.succeed("reconstruct", "b.kbm", "--like", "table.h5", "-o", "back.h5", "--quiet")
        self.succeed("compare", "back.h5", "b.kbm", "--json", "e.json", "--quiet")
        self.assertLess(self.read_json("e.json")["relative_error"]["max"], 1e-5)
        figures = {}
        for name in ("b.kbm", "back.h5"):
            self.succeed("compare", "table.h5", name, "--json", "e.json", "--quiet")
            figures[name] = self.read_json("e.json")
        self.assertAlmostEqual(figures["b.kbm"]["relative_error"]["mean"],
                               figures["back.h5"]["relative_error"]["mean"], 6)
        self.assertEqual(figures["b.kbm"]["bytes_material"], len(self.read_bytes("b.kbm")))
        with h5py.File(self.folder / "back.h5") as file:
            self.assertTrue(numpy.nanmin(file["reflectance"][:]) > 0)

    def test_relights_as_its_reconstruction(self):
        self.succeed("reconstruct", "b.kbm", "--like", "table.h5", "-o", "back.h5", "--quiet")
        self.succeed("relight", "b.kbm", "--like", "table.h5", "--light", "line", "-o", "b.png")
        self.succeed("relight", "back.h5", "--light", "line", "-o", "back.png")
        self.assertEqual(self.read_bytes("b.png"), self.read_bytes("back.png"))
        self.succeed("relight", "b.kbm", "--light", "disc", "-o", "whole.exr")
        self.assertIn("whole.exr", self.names())

    def test_renders_by_its_contents_whatever_its_name(self):
        scene = {
            "mesh": {"shape": "sphere", "size_mm": 20},
            "camera": {"width": 32, "height": 24},
            "lights": [{"type": "environment", "sky": "clear"}],
        }
        (self.folder / "unnamed").write_bytes(self.read_bytes("b.kbm"))
        pictures = []
        for name in ("b.kbm", "unnamed"):
            self.write_json("scene.json", {**scene, "material": {"file": name}})
            self.succeed("render", "scene.json", "-o", "picture.png", "--samples", 2000, "--quiet")
            pictures.append(self.read_bytes("picture.png"))
        self.assertEqual(*pictures)
        self.assertEqual(self.info("scene.json")["material"], "unnamed")

    def test_plots(self):
        self.succeed("compare", "table.h5", "b.kbm", "--plot", "3,4", "--plot", "20,10",
                     "--plot-dir", "plots", "--error-image", "errors.png")
        self.assertEqual(sorted(path.name for path in (self.folder / "plots").iterdir()),
                         ["profile-20-10.png", "profile-3-4.png"])

    def test_errors(self):
        self.write_json("other.json", program.sample(width=23))
        self.succeed("simulate", "other.json", "-o", "other.h5", "--quiet")
        message = ("b.kbm: grid: expected 23 x 20 pixels, 3 channels, as the table, found 24 x 20 "
                   "pixels, 3 channels")
        self.fail_with(1, message, "compare", "other.h5", "b.kbm")
        self.fail_with(1, message, "reconstruct", "b.kbm", "--like", "other.h5", "-o", "x.h5")
        self.assertNotIn("x.h5", self.names())
        self.fail_with(2, "b.kbm: expected an output of another name, found the input", "relight",
                       "b.kbm", "-o", "b.kbm")
        truncated = self.read_bytes("b.kbm")[:-40]
        (self.folder / "short.kbm").write_bytes(truncated)
        for command in (["info", "short.kbm"], ["compare", "table.h5", "short.kbm"],
                        ["relight", "short.kbm", "-o", "x.png"]):
            status, _, errors = self.run_program(*command)
            self.assertEqual(status, 1)
            self.assertRegex(errors, r"^parian: error: short\.kbm: [^\n]*\n$")
        self.assertNotIn("x.png", self.names())


if __name__ == "__main__":
    program.main()
