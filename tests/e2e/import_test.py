"""import: slices and textures that other programs wrote become tables and maps."""

import unittest

import h5py
import numpy

import program


class Import(program.ProgramTest):
    def write_slices(self, both_directions=False, skew=0.0, **changes):
        """The values of sample.json's table as .npy slices, where asked for in both directions."""
        self.succeed("simulate", "sample.json", "-o", "table.h5")
        with h5py.File(self.folder / "table.h5") as table:
            offsets = table["offsets"][:].tolist()
            values = table["reflectance"][:]
            pitch = float(table.attrs["pixel_pitch_mm"])
        slices = {tuple(offset): values[:, d] for d, offset in enumerate(offsets)}
        if both_directions:
            for (dx, dy), forth in list(slices.items()):
                if (dx, dy) == (0, 0):
                    continue
                back = numpy.full_like(forth, numpy.nan)
                height, width = forth.shape[1:]
                # R(x, x - d) belongs to the pair that R(x - d, x) was measured for.
                ys, xs = slice(max(0, dy), min(height, height + dy)), slice(max(0, dx), min(width, width + dx))
                ys0, xs0 = slice(max(0, -dy), min(height, height - dy)), slice(max(0, -dx), min(width, width - dx))
                back[:, ys, xs] = forth[:, ys0, xs0] * (1 - skew)
                slices[(-dx, -dy)] = back
                slices[(dx, dy)] = forth * (1 + skew)
        files = []
        for (dx, dy), plane in slices.items():
            files.append(f"slice_{dx}_{dy}.npy")
            numpy.save(self.folder / files[-1], numpy.moveaxis(plane, 0, -1))
        self.write_json("slices.json", {
            "kind": "slices", "pitch_mm": pitch, "offsets": [list(d) for d in slices],
            "files": files, "symmetric": not both_directions, **changes})
        return values

    def test_slices_become_the_table(self):
        values = self.write_slices()
        self.assertIn("imported table", self.succeed("import", "slices.json", "-o", "again.h5"))
        with h5py.File(self.folder / "again.h5") as table:
            numpy.testing.assert_array_equal(table["reflectance"][:], values)
        self.succeed("compare", "table.h5", "again.h5", "--json", "report.json", "--quiet")
        self.assertEqual(self.read_json("report.json")["relative_error"]["max"], 0)

    def test_one_array_with_all(self):
        values = self.write_slices()
        numpy.save(self.folder / "all.npy", numpy.asfortranarray(values.astype(">f8")))
        description = self.read_json("slices.json")
        del description["files"]
        description["file"] = "all.npy"
        self.write_json("slices.json", description)
        self.succeed("import", "slices.json", "-o", "again.h5", "--deflate", "4")
        with h5py.File(self.folder / "again.h5") as table:
            numpy.testing.assert_array_equal(table["reflectance"][:], values)

    def test_both_directions_are_averaged_and_judged(self):
        """R (1 + s) forth and R (1 - s) back: the fit is that of R, and |R - R^T| / |R| is about
        2 s where d is not 0."""
        values = self.write_slices(both_directions=True, skew=0.1)
        self.succeed("import", "slices.json", "-o", "raw.h5")
        self.succeed("fit", "raw.h5", "-o", "raw-map.h5")
        self.succeed("fit", "table.h5", "-o", "map.h5")
        self.succeed("compare", "raw.h5", "raw-map.h5", "--json", "report.json", "--quiet")
        offsets = self.read_json("slices.json")["offsets"]
        d2 = a2 = 0.0
        centre = 0.0
        for index, plane in enumerate(numpy.moveaxis(values, 1, 0)):
            squares = float(numpy.nansum(plane.astype(float) ** 2))
            if index == 0:
                centre = squares
            else:
                d2 += 2 * 0.2 ** 2 * squares
                a2 += (1.1 ** 2 + 0.9 ** 2) * squares
        self.assertEqual(offsets[0], [0, 0])
        self.assertAlmostEqual(self.read_json("report.json")["asymmetry"], (d2 / (a2 + centre)) ** 0.5, 5)
        self.succeed("compare", "table.h5", "raw-map.h5", "--json", "raw.json", "--quiet")
        self.succeed("compare", "table.h5", "map.h5", "--json", "own.json", "--quiet")
        raw, own = (self.read_json(name)["log_rms"] for name in ("raw.json", "own.json"))
        # ln 1.1 + ln 0.9 = -0.01: the mean of logarithms, or of values, is within it.
        self.assertLess(abs(raw - own), 0.01)

    def test_noise_takes_part_in_the_fit(self):
        """Counts with zeros, and what a fit of logarithms makes of them."""
        values = self.write_slices(noise_gain=1e-2)
        random = numpy.random.default_rng(4)
        with h5py.File(self.folder / "table.h5") as table:
            offsets = table["offsets"][:].tolist()
        for d, (dx, dy) in enumerate(offsets):
            plane = values[:, d].astype(float)
            known = ~numpy.isnan(plane)
            plane[known] = 1e-2 * random.poisson(plane[known] / 1e-2)
            numpy.save(self.folder / f"slice_{dx}_{dy}.npy", numpy.moveaxis(plane, 0, -1))
        self.succeed("import", "slices.json", "-o", "noisy.h5")
        text = self.succeed("fit", "noisy.h5", "-o", "map.h5", "--json", "fit.json")
        self.assertIn("by the noise model", text)
        fit = self.read_json("fit.json")["channels"][0]
        self.assertGreater(fit["not_positive"], 50)
        self.assertTrue(fit["converged"])
        self.succeed("fit", "noisy.h5", "-o", "logs.h5", "--no-noise-model", "--quiet")
        errors = []
        for name in ("map.h5", "logs.h5"):
            self.succeed("compare", "table.h5", name, "--json", "errors.json", "--quiet")
            errors.append(self.read_json("errors.json")["log_rms"])
        self.assertLess(errors[0], 0.7 * errors[1])
        self.succeed("compress", "noisy.h5", "-o", "noisy.kbm", "-M", "16", "--quiet")

    def test_textures_become_a_map(self):
        import_json = {"kind": "textures", "pitch_mm": 0.5, "albedo": "albedo.exr",
                       "mean_free_path": 0.4, "model": "dipole"}
        # An EXR that the program itself writes: a table's colour under uniform light.
        self.succeed("simulate", "sample.json", "-o", "table.h5")
        self.succeed("relight", "table.h5", "--light", "uniform", "-o", "albedo.exr")
        self.write_json("textures.json", import_json)
        self.assertIn("imported profile map, 24 x 20 pixels of 0.5 mm",
                      self.succeed("import", "textures.json", "-o", "map.h5"))
        self.succeed("reconstruct", "map.h5", "--like", "table.h5", "-o", "again.h5")
        with h5py.File(self.folder / "map.h5") as made:
            self.assertEqual(made.attrs["boundary"], b"included" if isinstance(
                made.attrs["boundary"], bytes) else "included")

    def test_what_is_wrong(self):
        self.write_slices()
        self.write_json("bad.json", {"kind": "tables"})
        self.fail_with(1, "bad.json: /kind: expected 'slices' or 'textures', found 'tables'",
                       "import", "bad.json", "-o", "again.h5")
        (self.folder / "sub").mkdir()
        numpy.save(self.folder / "sub/a.npy", numpy.ones((5, 6)))
        numpy.save(self.folder / "sub/b.npy", numpy.ones((4, 6)))
        numpy.save(self.folder / "sub/rgb.npy", numpy.ones((5, 6, 3)))
        zero = numpy.ones((5, 6))
        zero[2, 3] = 0
        numpy.save(self.folder / "sub/zero.npy", zero)

        def fails(message, *files, **changes):
            self.write_json("sub/s.json", {"kind": "slices", "pitch_mm": 0.5,
                                           "offsets": [[0, 0], [1, 0]], "files": files, **changes})
            self.fail_with(1, message, "import", "sub/s.json", "-o", "again.h5")

        fails("sub/b.npy: shape: expected [5][6], as 'sub/a.npy' has, found [4][6]", "a.npy", "b.npy")
        fails("sub/rgb.npy: shape: expected [5][6], as 'sub/a.npy' has, found [5][6][3]",
              "a.npy", "rgb.npy")
        fails("sub/c.npy: expected a readable file, found no such file", "a.npy", "c.npy")
        fails("sub/c.tif: expected a name that ends in .npy or .exr, found .tif", "a.npy", "c.tif")
        fails("sub/zero.npy: reflectance[0][1][2][3] (channel, offset, y, x): expected a value > 0 or "
              "NaN, as the table has no noise model, found 0", "a.npy", "zero.npy")
        fails("sub/s.json: offsets: expected both directions of each offset, as symmetric = 0: "
              "(-1, 0), found only (1, 0)", "a.npy", "a.npy", symmetric=False)
        self.write_json("sub/t.json", {"kind": "textures", "pitch_mm": 0.5, "albedo": "a.png",
                                       "mean_free_path": 1})
        self.fail_with(1, "sub/a.png: expected a readable file, found no such file",
                       "import", "sub/t.json", "-o", "again.h5")
        (self.folder / "slice_0_0.npy").write_bytes(b"hello")
        self.fail_with(1, "slice_0_0.npy: expected a .npy file, found no NumPy signature",
                       "import", "slices.json", "-o", "again.h5")
        self.assertNotIn("again.h5", self.names())


if __name__ == "__main__":
    program.main()
