"""parian edit: recipes from files, their results, and what it says about wrong ones."""

import json

import h5py
import numpy

import program


def recipe(*layers, **more):
    return json.dumps({"format": "parian-recipe", "version": 1, "layers": layers, **more})


SCRIBBLES = {
    "type": "propagate",
    "strokes": [{"points": [[0.1, 0.2], [0.2, 0.2]], "unit": "relative"},
                {"points": [[0.9, 0.8]], "unit": "relative", "positive": False}],
}


class Edit(program.ProgramTest):
    def setUp(self):
        super().setUp()
        self.succeed("simulate", "sample.json", "-o", "table.h5", "--quiet")
        self.succeed("fit", "table.h5", "-o", "map.h5", "--quiet")

    def write(self, name, text):
        (self.folder / name).write_text(text)

    def edit(self, *layers, out="edited.h5", source="map.h5", more=()):
        self.write("recipe.json", recipe(*layers))
        return self.succeed("edit", source, "--recipe", "recipe.json", "-o", out, *more)

    def planes(self, name):
        with h5py.File(self.folder / name) as file:
            return {key: file[key][:] for key in file}

    def test_albedo_and_range_are_factors(self):
        self.edit({"operation": "adjust", "albedo_scale": [2, 1, 0.5], "range_scale": 1.5})
        before, after = self.planes("map.h5"), self.planes("edited.h5")
        numpy.testing.assert_array_equal(before["log_profile"], after["log_profile"])
        numpy.testing.assert_allclose(after["gain"][0], 2, rtol=1e-7)
        numpy.testing.assert_allclose(after["gain"][2], 0.5, rtol=1e-7)
        numpy.testing.assert_allclose(after["dilation"], 1.5, rtol=1e-7)

    def test_a_recipe_gives_the_same_bits_again(self):
        layers = ({"operation": "adjust", "selection": SCRIBBLES, "hue_deg": 60},
                  {"operation": "shape", "falloff": 1.4},
                  {"operation": "paste", "from": {"min": [0, 0], "max": [2, 2]}, "to": [4, 3]},
                  {"operation": "filter", "kind": "bilateral", "sigma_mm": 0.7, "shape": True},
                  {"operation": "bound_energy"},
                  {"operation": "synthesize", "width_px": 40, "height_px": 30})
        self.edit(*layers, out="a.h5")
        self.edit(*layers, out="b.h5", more=("--threads", 1))
        self.assertEqual(self.read_bytes("a.h5"), self.read_bytes("b.h5"))

    def test_what_it_writes_is_a_material_like_any_other(self):
        self.edit({"operation": "adjust", "range_scale": 1.7, "selection": SCRIBBLES})
        self.succeed("info", "edited.h5", "--json", "info.json", "--quiet")
        info = self.read_json("info.json")
        self.assertEqual(info["provenance"]["kind"], "edit")
        self.assertEqual(info["provenance"]["layers"][0]["range_scale"], 1.7)
        self.succeed("relight", "edited.h5", "--light", "disc", "-o", "disc.png")
        self.succeed("reconstruct", "edited.h5", "--like", "table.h5", "-o", "back.h5", "--quiet")
        self.succeed("compare", "back.h5", "edited.h5", "--json", "e.json", "--quiet")
        self.assertLess(self.read_json("e.json")["relative_error"]["max"], 1e-5)

    def test_figures_and_masks(self):
        self.write("recipe.json", recipe(
            {"name": "left", "operation": "adjust", "albedo_offset": -5,
             "selection": {"type": "rectangle", "min": [0, 0], "max": [0.5, 1],
                           "unit": "relative"}}))
        self.succeed("edit", "map.h5", "-r", "recipe.json", "-o", "e.h5", "--json", "figures.json",
                     "--masks", "masks", "--quiet")
        layer = self.read_json("figures.json")["layers"][0]
        self.assertAlmostEqual(layer["selected"], 0.5, 6)
        pixels = self.planes("map.h5")["log_profile"][0, 0].size
        self.assertEqual(layer["clamped_albedo"], 3 * pixels / 2)
        self.assertEqual(sorted(p.name for p in (self.folder / "masks").iterdir()),
                         ["layer-01.exr", "layer-01.png"])

    def test_edits_go_into_blends(self):
        self.succeed("compress", "table.h5", "-o", "b.kbm", "-M", 8, "--quiet")
        adjust = {"operation": "adjust", "albedo_scale": 0.5, "range_scale": 1.25}
        self.edit(adjust, source="b.kbm", out="e.kbm")
        self.edit(adjust, source="b.kbm", out="e.h5")
        self.succeed("reconstruct", "e.h5", "--like", "table.h5", "-o", "back.h5", "--quiet")
        self.succeed("compare", "back.h5", "e.kbm", "--json", "e.json", "--quiet")
        self.assertLess(self.read_json("e.json")["relative_error"]["max"], 1e-5)
        self.write("recipe.json", recipe({"operation": "shape", "falloff": 2}))
        self.fail_with(1, "recipe.json: expected edits of albedo and range alone, as the material is "
                       "compressed: edit the map and compress it again, found new profile shapes",
                       "edit", "b.kbm", "-r", "recipe.json", "-o", "f.kbm")
        self.assertNotIn("f.kbm", self.names())
        self.succeed("edit", "b.kbm", "-r", "recipe.json", "-o", "f.kbm", "--bases", "--quiet")
        self.succeed("info", "f.kbm", "--json", "info.json", "--quiet")
        self.assertEqual(self.read_json("info.json")["bases"], 8)

    def test_recipes_apply_to_other_maps(self):
        layers = ({"operation": "crop", "min": [0.1, 0.1], "max": [0.9, 0.8], "unit": "relative"},
                  {"operation": "blend", "from": {"map": "map.h5", "at": [0.5, 0.5],
                                                  "unit": "relative"},
                   "selection": {"type": "gradient", "from": [0, 0], "to": [1, 0],
                                 "unit": "relative"}})
        self.edit({"operation": "resample", "pixel_pitch_mm": 0.37}, out="other.h5")
        self.edit(*layers, source="other.h5", out="e.h5")

    def test_operations_can_be_listed(self):
        text = self.succeed("edit", "--list")
        for name in ("adjust", "blend", "paste", "filter", "hallucinate", "synthesize"):
            self.assertIn("\n" + name + ": ", text)

    def test_says_what_is_wrong(self):
        self.write("far.json", "{}")
        cases = [
            ({"operation": "ajust"}, "/layers/0/operation: expected 'adjust', 'interpolate', "
             "'shape', 'blend', 'paste', 'filter', 'hallucinate', 'bound_energy', 'monotone', "
             "'crop', 'tile', 'flip', 'rotate', 'resample' or 'synthesize', found 'ajust' (did you "
             "mean 'adjust'?)"),
            ({"operation": "adjust", "albedo_sale": 2}, "/layers/0/albedo_sale: expected a known "
             "key, found 'albedo_sale' (did you mean 'albedo_scale'?)"),
            ({"operation": "adjust", "range_scale": -1}, "/layers/0/range_scale: expected a value "
             "in (0, 1000], found -1"),
            ({"operation": "adjust", "albedo_scale": [1, 2]}, "layer 1 ('adjust'), "
             "/layers/0/albedo_scale: expected 1 value or 3, as the map has channels, found 2"),
            ({"operation": "adjust", "opacity": 2}, "/layers/0/opacity: expected a number in "
             "[0, 1], found the number 2"),
            ({"operation": "blend", "from": {"map": "none.h5", "at": [1, 1]}},
             "/layers/0/from/map: expected a file that can be read, found none.h5: expected a "
             "readable file, found no such file"),
            ({"operation": "blend", "from": {"at": [99, 1]}}, "layer 1 ('blend'), "
             "/layers/0/from/at: expected a place in [0, 12] x [0, 10], the map, found (99, 1)"),
            ({"operation": "adjust", "selection": {"type": "polygon", "points": [[0, 0], [1, 1]]}},
             "/layers/0/selection/points: expected an array of 3 to 20000 places [x, y], found an "
             "array of 2"),
            ({"operation": "adjust", "selection": {"type": "lasso"}}, "/layers/0/selection/type: "
             "expected 'all', 'rectangle', 'ellipse', 'polygon', 'stroke', 'gradient', 'image', "
             "'threshold', 'similar', 'propagate', 'union', 'intersection' or 'difference', found "
             "'lasso'"),
            ({"name": "edge", "operation": "adjust",
              "selection": {"type": "stroke", "points": [[-9, 0]], "radius": 1}},
             "layer 1 ('edge'), /layers/0/selection: expected a shape that meets the map of 12 x 10 "
             "mm, found one outside"),
            ({"operation": "adjust", "selection": {"type": "threshold", "property": "range",
                                                   "low": 1e6}},
             "layer 1 ('adjust'), selection: expected a selection of at least one pixel, found an "
             "empty one"),
            ({"operation": "paste", "from": {"min": [0, 0], "max": [12, 10]}},
             "layer 1 ('paste'): expected a selection with a border that gives the values, or "
             "'keep_mean', found the whole map, whose mean is not determined"),
            ({"operation": "shape", "scale": [[0.5, 1], [0.2, 1]]}, "/layers/0/scale: expected "
             "places u in [0, 1] that increase, found 0.2 as number 1"),
            ({"operation": "crop", "min": [0, 0], "max": [1, 1], "opacity": 0.5},
             "/layers/0/opacity: expected no 'opacity' beside the operation 'crop', found one"),
            ({"operation": "tile", "nx": 256, "ny": 256}, "layer 1 ('tile'), /layers/0: expected a "
             "map of at most 16777216 pixels, found 6144 x 5120"),
            ({"operation": "synthesize", "width_px": 0}, "/layers/0/width_px: expected a value in "
             "[1, 8192], found 0"),
            ({"operation": "hallucinate", "photograph": "far.json", "pins": []},
             "/layers/0/photograph: expected a file that can be read, found far.json: expected a "
             "file name that ends in .png, .jpg, .exr or .hdr, found '.json'"),
        ]
        before = self.read_bytes("map.h5")
        for layer, message in cases:
            with self.subTest(layer=layer):
                self.write("recipe.json", recipe(layer))
                self.fail_with(1, "recipe.json: " + message, "edit", "map.h5", "-r", "recipe.json",
                               "-o", "out.h5")
                self.assertNotIn("out.h5", self.names())
        self.assertEqual(self.read_bytes("map.h5"), before)
        self.fail_with(1, "table.h5: expected a profile map or a blend (parian fit makes one), found "
                       "a table", "edit", "table.h5", "-r", "recipe.json", "-o", "out.h5")

class Examples(program.ProgramTest):
    """The recipes of examples/recipes, on one small map that stands in for all that they name."""

    FILES = ("map", "image", "photograph", "guidance", "file", "table")

    def files(self, node):
        if isinstance(node, dict):
            for key, value in node.items():
                if key in self.FILES and isinstance(value, str):
                    yield value
                yield from self.files(value)
        elif isinstance(node, list):
            for value in node:
                yield from self.files(value)

    def test_each_recipe_applies(self):
        self.write_json("sample.json", program.sample(width=60, height=56))
        self.succeed("simulate", "sample.json", "-o", "table.h5", "--quiet")
        self.succeed("fit", "table.h5", "-o", "map.h5", "--quiet")
        self.succeed("relight", "map.h5", "--light", "uniform", "-o", "map.png", "--quiet")
        paths = sorted((program.SOURCE / "examples/recipes").glob("*.json"))
        self.assertGreater(len(paths), 10)
        for path in paths:
            with self.subTest(recipe=path.name):
                for name in self.files(json.loads(path.read_text())):
                    stand_in = ("map.png" if name.endswith(".png") else
                                "map.h5" if name.endswith("-map.h5") else "table.h5")
                    (self.folder / name).write_bytes(self.read_bytes(stand_in))
                (self.folder / "recipe.json").write_bytes(path.read_bytes())
                self.succeed("edit", "map.h5", "-r", "recipe.json", "-o", "out.h5", "--quiet")


if __name__ == "__main__":
    program.main()
