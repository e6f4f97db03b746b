"""Wrong usage and bad input: exit status, and one line that says what is wrong."""

import os
import stat
import unittest

import h5py
import numpy

import program


class Usage(program.ProgramTest):
    def test_help_shows_an_example(self):
        commands = ("simulate", "capture", "import", "fit", "compress", "edit", "reconstruct", "compare", "relight",
                    "precompute", "render", "info", "studio", "demo")
        overview = self.succeed("--help")
        for command in commands:
            self.assertIn(command, overview)
            self.assertIn(f"parian {command}", self.succeed(command, "--help"))
            self.assertIn("--threads", self.succeed(command, "--help"))

    def test_flags_come_from_the_parameters(self):
        text = self.succeed("fit", "--help")
        for word in ("--segments", "--no-monotone", "--lambda", "--knots-mm", "[0, 256]", "default 0.01"):
            self.assertIn(word, text)

    def test_without_a_command(self):
        status, output, errors = self.run_program()
        self.assertEqual((status, output), (2, ""))
        self.assertIn("simulate", errors)

    def test_unknown_names_get_the_nearest(self):
        self.fail_with(2, "expected a command: 'simulate', 'capture', 'import', 'fit', 'compress', 'edit', 'reconstruct', "
                       "'compare', 'relight', 'precompute', 'render', 'info', 'studio' or 'demo', found 'rlight' (did you mean 'relight'?)",
                       "rlight", "x")
        self.fail_with(2, "expected a flag of 'parian fit', found '--segmants' "
                       "(did you mean '--segments'?)", "fit", "t.h5", "-o", "m.h5", "--segmants", "3")
        self.fail_with(2, "--weight: expected one of 'uniform', 'inverse-quadratic', 'energy' or "
                       "'noise', found 'unifrom' (did you mean 'uniform'?)",
                       "fit", "t.h5", "-o", "m.h5", "--weight", "unifrom")

    def test_missing_and_surplus_words(self):
        self.fail_with(2, "expected TABLE.h5 after 'fit', found nothing", "fit", "-o", "m.h5")
        self.fail_with(2, "--output: expected MAP.h5, found nothing", "fit", "t.h5")
        self.fail_with(2, "expected TABLE.h5 after 'fit', found nothing", "fit", "", "-o", "m.h5")
        self.fail_with(2, "--output: expected MAP.h5, found nothing", "fit", "t.h5", "-o", "")
        self.fail_with(2, "expected 1 file after 'fit', found 'b.h5' too", "fit", "a.h5", "b.h5",
                       "-o", "m.h5")

    def test_values_out_of_range(self):
        self.fail_with(2, "--segments: expected a value in [0, 256], found 100000",
                       "fit", "t.h5", "-o", "m.h5", "--segments", "100000")
        self.fail_with(2, "--segments: expected a whole number, found 'many'",
                       "fit", "t.h5", "-o", "m.h5", "--segments", "many")
        self.fail_with(2, "--threads: expected a value in [0, 4096], found -2",
                       "info", "t.h5", "--threads", "-2")
        self.fail_with(2, "--lambda: expected a value in [0, 1000000], found -1",
                       "fit", "t.h5", "-o", "m.h5", "--lambda", "-1")

    def test_output_must_not_be_the_input(self):
        self.succeed("simulate", "sample.json", "-o", "table.h5")
        before = self.read_bytes("table.h5")
        self.fail_with(2, "table.h5: expected an output of another name, found the input",
                       "fit", "table.h5", "-o", "table.h5")
        self.assertEqual(self.read_bytes("table.h5"), before)

    def test_output_must_not_be_what_a_recipe_reads(self):
        self.succeed("simulate", "sample.json", "-o", "table.h5")
        self.succeed("fit", "table.h5", "-o", "map.h5")
        self.succeed("fit", "table.h5", "-o", "other.h5", "--segments", "3")
        self.write_json("recipe.json", {"format": "parian-recipe", "version": 1, "layers": [
            {"operation": "blend", "from": {"map": "other.h5"}}]})
        before = self.read_bytes("other.h5")
        self.fail_with(2, "./other.h5: expected an output of another name, found the input",
                       "edit", "map.h5", "-r", "recipe.json", "-o", "./other.h5")
        self.assertEqual(self.read_bytes("other.h5"), before)

    def test_figures_must_not_take_the_place_of_a_file_in_use(self):
        before = self.read_bytes("sample.json")
        for name in ("sample.json", "./sample.json", str(self.folder / "sample.json")):
            self.fail_with(2, "--json: expected a file of its own, found 'sample.json' again",
                           "simulate", "sample.json", "-o", "table.h5", "--json", name)
        self.fail_with(2, "--json: expected a file of its own, found 'table.h5' again",
                       "simulate", "sample.json", "-o", "table.h5", "--json", "./table.h5")
        self.fail_with(2, "--json: expected a file of its own, found 'sample.json' again",
                       "info", "sample.json", "--json", "sample.json")
        self.assertEqual(self.read_bytes("sample.json"), before)
        self.assertEqual(self.names(), ["sample.json"])


class BadInput(program.ProgramTest):
    def setUp(self):
        super().setUp()
        self.succeed("simulate", "sample.json", "-o", "table.h5")

    def fails(self, *arguments):
        """One line of error and status 1; the line."""
        status, output, errors = self.run_program(*arguments)
        self.assertEqual((status, output), (1, ""), errors)
        self.assertTrue(errors.startswith("parian: error: ") and errors.count("\n") == 1, errors)
        return errors

    def test_files_that_are_no_tables(self):
        (self.folder / "text.h5").write_text("hello")
        (self.folder / "short.h5").write_bytes(self.read_bytes("table.h5")[:5000])
        for name in ("text.h5", "short.h5", "absent.h5"):
            self.assertIn(name, self.fails("fit", name, "-o", "map.h5"))
            self.assertIn(name, self.fails("info", name))
        self.assertNotIn("map.h5", self.names())

    def test_a_pixel_without_pairs(self):
        with h5py.File(self.folder / "table.h5", "r+") as file:
            values, offsets = file["reflectance"], file["offsets"][:]
            for d, (dx, dy) in enumerate(offsets):
                for x, y in ((7, 9), (7 - dx, 9 - dy)):
                    values[1, d, y, x] = numpy.nan
        self.assertIn("7", self.fails("fit", "table.h5", "-o", "map.h5"))

    def test_infinite_and_negative_values(self):
        for value in (numpy.inf, -1.0, 0.0):
            with h5py.File(self.folder / "table.h5", "r+") as file:
                file["reflectance"][2, 1, 4, 5] = value
            self.assertIn("table.h5", self.fails("fit", "table.h5", "-o", "map.h5"))

    def test_unknown_key_of_a_sample(self):
        self.write_json("sample.json", {**program.sample(), "radius_pixels": 4})
        self.assertIn("did you mean 'radius_px'", self.fails("simulate", "sample.json", "-o", "t.h5"))

    def test_a_material_on_another_grid(self):
        self.write_json("other.json", program.sample(30, 20))
        self.succeed("simulate", "other.json", "-o", "other.h5")
        self.succeed("fit", "other.h5", "-o", "other-map.h5")
        self.assertIn("other-map.h5", self.fails("compare", "table.h5", "other-map.h5"))
        self.assertIn("other.h5", self.fails("compare", "table.h5", "other.h5"))

    def test_parameters_that_mean_nothing(self):
        self.succeed("fit", "table.h5", "-o", "map.h5")
        self.succeed("compress", "map.h5", "-o", "b.kbm", "-M", "4")
        self.fail_with(2, "--segments: expected a table to fit, found map.h5",
                       "compress", "map.h5", "-o", "c.kbm", "--segments", "5")
        self.fail_with(2, "--blur-px: expected --synthesize with it, found photographs",
                       "capture", ".", "-o", "t.h5", "--blur-px", "3")
        self.fail_with(1, "b.kbm: expected a table or a profile map, found a blend",
                       "compress", "b.kbm", "-o", "c.kbm")
        render = ("render", "scene.json", "-o", "a.png")
        self.fail_with(2, "--tolerance: expected --method tree with it, found --method splat",
                       *render, "--method", "splat", "--tolerance", "0.1")
        self.fail_with(2, "--quality: expected --method tree with it, found --method brute",
                       *render, "--method", "brute", "--quality", "0.1")
        self.fail_with(2, "--shading: expected --method tree with it, found --method splat",
                       *render, "--method", "splat", "--shading", "vertex")
        self.fail_with(2, "--rays: expected a picture without --transport, found t.h5",
                       *render, "--transport", "t.h5", "--rays", "16")

    def test_folders_that_cannot_be_made_fail_before_the_work(self):
        self.succeed("fit", "table.h5", "-o", "map.h5")
        self.write_json("recipe.json", {"format": "parian-recipe", "version": 1, "layers": []})
        names = self.names()
        for command in (["edit", "map.h5", "-r", "recipe.json", "-o", "e.h5", "--masks"],
                        ["edit", "map.h5", "-r", "recipe.json", "-o", "e.h5", "--planes"],
                        ["compress", "map.h5", "-o", "b.kbm", "--watch"],
                        ["compare", "table.h5", "map.h5", "--plot", "1,1", "--plot-dir"]):
            self.fail_with(1, "table.h5: expected a folder that can be made, found Not a directory",
                           *command, "table.h5")
        self.fail_with(1, "e.kbm: expected an output named .h5, as the input is a map "
                       "(parian compress makes a blend of it), found .kbm",
                       "edit", "map.h5", "-r", "recipe.json", "-o", "e.kbm")
        self.assertEqual(self.names(), names)

    def test_a_table_is_no_material(self):
        self.assertIn("expected a material", self.fails("reconstruct", "table.h5", "--like", "table.h5",
                                                        "-o", "again.h5"))

    def test_folders_that_do_not_exist_fail_before_the_work(self):
        self.assertIn("nowhere/map.h5", self.fails("fit", "table.h5", "-o", "nowhere/map.h5"))
        self.assertIn("nowhere/r.json",
                      self.fails("fit", "table.h5", "-o", "map.h5", "--json", "nowhere/r.json"))
        self.assertNotIn("map.h5", self.names())

    @unittest.skipIf(os.geteuid() == 0, "root may write everywhere")
    def test_folder_that_cannot_be_written(self):
        locked = self.folder / "locked"
        locked.mkdir()
        locked.chmod(stat.S_IRUSR | stat.S_IXUSR)
        self.assertIn("locked/map.h5", self.fails("fit", "table.h5", "-o", "locked/map.h5"))

    def test_full_disk(self):
        status, _, errors = self.run_program("info", "table.h5", "--json", "/dev/full")
        self.assertEqual(status, 1, errors)
        with open("/dev/full", "w") as full:
            done = program.subprocess.run([program.PARIAN, "info", "table.h5"], cwd=self.folder,
                                          stdout=full, stderr=program.subprocess.PIPE, text=True)
        self.assertEqual((done.returncode, done.stderr),
                         (1, "parian: error: standard output: expected to be written, found an error\n"))

    def test_light_of_another_size(self):
        self.succeed("relight", "table.h5", "-o", "light.png")
        self.write_json("other.json", program.sample(30, 20))
        self.succeed("simulate", "other.json", "-o", "other.h5")
        self.fail_with(1, "light.png: size: expected 30 x 20 pixels, as the sample, found 24 x 20",
                       "relight", "other.h5", "--light", "light.png", "-o", "x.png")
        self.fail_with(2, "--light: expected 'uniform', 'disc' or 'line', or an image file, "
                       "found 'disk' (did you mean 'disc'?)",
                       "relight", "table.h5", "--light", "disk", "-o", "x.png")

    def test_plot_outside_the_grid(self):
        self.succeed("fit", "table.h5", "-o", "map.h5")
        for pixel in ("24,3", "-1,0", "3", "a,b", "3,4,5"):
            self.fail_with(2, f"--plot: expected a pixel X,Y in a grid of 24 x 20, found '{pixel}'",
                           "compare", "table.h5", "map.h5", f"--plot={pixel}")


if __name__ == "__main__":
    program.main()
