"""render: scenes of shapes and files, what is reported, and what is wrong with bad ones."""

import signal
import time

import h5py

import program

QUICK = ("--samples", "2000", "--rays", "16", "--antialias", "1")
REPORT_KEYS = {
    "gather", "triangles", "vertices", "mesh", "area_mm2", "samples", "sample_spacing_mm",
    "targets", "nodes_per_target", "certified_targets", "max_half_width", "mean_half_width",
    "escaping_fraction", "seconds", "warnings",
}


def scene(**changes):
    """A small knot of marble under the sky."""
    return {
        "mesh": {"shape": "knot", "size_mm": 30},
        "material": {"named": "marble"},
        "lights": [{"type": "environment", "sky": "clear"}],
        "camera": {"width": 48, "height": 36},
        **changes,
    }


# A tetrahedron.
PLY = """ply
format ascii 1.0
element vertex 4
property float x
property float y
property float z
element face 4
property list uchar int vertex_indices
end_header
0 0 0
1 0 0
0 1 0
0 0 1
3 0 2 1
3 0 1 3
3 0 3 2
3 1 2 3
"""


class Render(program.ProgramTest):
    def setUp(self):
        super().setUp()
        self.write_json("scene.json", scene())

    def mean(self, name):
        figures = program.json.loads(self.succeed("info", name, "--json", "-"))
        return [c["mean"] for c in figures["values"]]

    def fails(self):
        """The last line of a run that must fail."""
        status, output, errors = self.run_program("render", "scene.json", "-o", "x.png", *QUICK)
        self.assertEqual((status, output), (1, ""), errors)
        lines = errors.splitlines()
        self.assertTrue(lines[-1].startswith("parian: error: "), errors)
        self.assertNotIn("x.png", self.names())
        return lines[-1]

    def fails_with_scene(self, **changes):
        self.write_json("scene.json", scene(**changes))
        return self.fails()

    def test_pictures_of_all_kinds(self):
        for name, magic in (("a.png", b"\x89PNG"), ("a.exr", b"\x76\x2f\x31\x01"),
                            ("a.hdr", b"#?RADIANCE")):
            text = self.succeed("render", "scene.json", "-o", name, *QUICK)
            self.assertTrue(self.read_bytes(name).startswith(magic), name)
            self.assertIn("48 x 36 pixels", text)
            self.assertIn("certified half-width", text)
            self.assertIn("seconds", text)
        self.assertTrue(all(c > 0.01 for c in self.mean("a.exr")))

    def test_report(self):
        self.succeed("render", "scene.json", "-o", "a.png", "--json", "report.json", *QUICK)
        report = self.read_json("report.json")
        self.assertEqual(set(report), REPORT_KEYS)
        self.assertEqual((report["gather"], report["samples"]), ("tree", 2000))
        self.assertEqual(set(report["seconds"]),
                         {"sampling", "irradiance", "tree", "gather", "shading", "total"})
        self.assertLess(0, report["mean_half_width"])
        self.assertLessEqual(report["mean_half_width"], report["max_half_width"])
        self.assertEqual((report["warnings"], report["escaping_fraction"]), ([], 0))
        self.succeed("render", "scene.json", "-o", "a.png", "--json", "report.json", "--method",
                     "brute", *QUICK)
        report = self.read_json("report.json")
        self.assertEqual((report["gather"], report["max_half_width"]), ("brute", None))

    def test_tolerance_is_certified(self):
        self.succeed("render", "scene.json", "-o", "a.exr", "--json", "report.json", "--tolerance",
                     "0.05", *QUICK)
        report = self.read_json("report.json")
        self.assertEqual(report["certified_targets"], report["targets"])
        self.assertLessEqual(report["max_half_width"], 0.05)
        self.succeed("render", "scene.json", "-o", "b.exr", "--method", "brute", *QUICK)
        for a, b in zip(self.mean("a.exr"), self.mean("b.exr")):
            self.assertAlmostEqual(a / b, 1, delta=0.05)

    def test_threads_do_not_change_a_bit(self):
        self.succeed("render", "scene.json", "-o", "a.exr", "--threads", "1", *QUICK)
        self.succeed("render", "scene.json", "-o", "b.exr", "--threads", "2", *QUICK)
        self.assertEqual(self.read_bytes("a.exr"), self.read_bytes("b.exr"))

    def test_splatting(self):
        quick = ("--samples", "20000", "--rays", "16", "--antialias", "1")
        lit = scene(lights=[{"type": "directional", "direction": [1, 1, 1], "irradiance": 2}])
        self.write_json("scene.json", lit)
        self.succeed("render", "scene.json", "-o", "a.exr", "--json", "report.json", "--method",
                     "splat", *quick)
        report = self.read_json("report.json")
        self.assertEqual((set(report), report["gather"]), (REPORT_KEYS, "splat"))
        self.succeed("render", "scene.json", "-o", "b.exr", "--method", "brute", *quick)
        for a, b in zip(self.mean("a.exr"), self.mean("b.exr")):
            self.assertAlmostEqual(a / b, 1, delta=0.03)

    def test_splatting_layers(self):
        quick = ("--samples", "20000", "--rays", "16", "--antialias", "1")
        red = {"material": {"sigma_a": [0, 2, 2], "sigma_s_prime": 2, "eta": 1.5},
               "mask": {"type": "gradient", "from": [-10, 0, 0], "to": [10, 0, 0]}}
        lit = scene(lights=[{"type": "directional", "direction": [1, 1, 1], "irradiance": 2}])
        means = []
        for layers, method in (([], "splat"), ([red], "splat"), ([red], "tree")):
            self.write_json("scene.json", {**lit, "layers": layers})
            self.succeed("render", "scene.json", "-o", "a.exr", "--method", method, *quick)
            means.append(self.mean("a.exr"))
        self.assertLess(means[1][1], 0.8 * means[0][1])
        for a, b in zip(means[1], means[2]):
            self.assertAlmostEqual(a / b, 1, delta=0.03)

    def test_splatting_what_it_cannot(self):
        self.write_json("sample.json", program.sample(40, 32, 10))
        self.succeed("simulate", "sample.json", "-o", "table.h5", "--quiet")
        self.write_json("scene.json", scene(material={"file": "table.h5"}))
        self.fail_with(2, "table.h5: expected a fitted or homogeneous material for splatting, found "
                       "a table without a fit", "render", "scene.json", "-o", "a.png", "--method",
                       "splat", *QUICK)
        self.write_json("scene.json", scene(camera={"width": 16384, "height": 10}))
        status, _, errors = self.run_program("render", "scene.json", "-o", "a.png", "--method",
                                             "splat", "--antialias", "2", "--samples", "2000")
        self.assertEqual(status, 1)
        self.assertRegex(errors, r"^parian: error: geometry buffer: expected at most \d+ texels or "
                                 r"layers, the graphics driver's limit, found 32768\n$")
        self.assertNotIn("a.png", self.names())

    def test_table_and_its_fit(self):
        self.write_json("sample.json", program.sample(40, 32, 10))
        self.succeed("simulate", "sample.json", "-o", "table.h5", "--quiet")
        self.succeed("fit", "table.h5", "-o", "map.h5", "--quiet")
        (self.folder / "scenes").mkdir()
        means = {}
        for name in ("table", "map"):  # paths are relative to the scene
            self.write_json(f"scenes/{name}.json", scene(material={"file": f"../{name}.h5"}))
            self.succeed("render", f"scenes/{name}.json", "-o", f"{name}.exr", "--json",
                         "report.json", "--method", "brute", *QUICK)
            means[name] = self.mean(f"{name}.exr")
            self.assertEqual(self.read_json("report.json")["gather"],
                             "table" if name == "table" else "brute")
        for a, b in zip(means["table"], means["map"]):
            self.assertAlmostEqual(a / b, 1, delta=0.06)

    def test_layers(self):
        (self.folder / "tetrahedron.ply").write_text(PLY)
        mesh = {"file": "tetrahedron.ply", "size_mm": 20}
        red = {"name": "red", "material": {"sigma_a": [0, 2, 2], "sigma_s_prime": 2, "eta": 1.5}}

        def mean_with(*layers):
            self.write_json("scene.json", scene(mesh=mesh, layers=list(layers)))
            self.succeed("render", "scene.json", "-o", "a.exr", *QUICK)
            return self.mean("a.exr")

        def painted(*weights):
            self.write_json("weights.json", list(weights))
            return {**red, "mask": {"type": "vertex", "file": "weights.json"}}

        bare, covered = mean_with(), mean_with(red)
        self.assertLess(covered[1], 0.5 * bare[1])
        self.assertEqual(mean_with(painted(0, 0, 0, 0)), bare)
        self.assertEqual(mean_with(painted(1, 1, 1, 1)), covered)
        part = mean_with(painted(0, 1, 1, 0.5))
        self.assertTrue(covered[1] < part[1] < bare[1], part)
        self.succeed("render", "scene.json", "-o", "mask.png", *QUICK)
        mask = {"type": "projected", "file": "mask.png", "center": [0, 10, 0],
                "direction": [0, 0, -1], "width_mm": 30, "height_mm": 30, "invert": True}
        part = mean_with({**red, "mask": mask})
        self.assertTrue(covered[1] < part[1] < bare[1], part)
        figures = program.json.loads(self.succeed("info", "scene.json", "--json", "-"))
        self.assertEqual(figures["layers"], ["red"])
        # Masks are inputs: no output replaces them.
        self.fail_with(2, "mask.png: expected an output of another name, found the input",
                       "render", "scene.json", "-o", "mask.png", *QUICK)

    def test_layers_that_do_not_fit(self):
        self.assertEqual(
            self.fails_with_scene(layers=[{"material": {"sigma_a": 1, "sigma_s_prime": 1}}]),
            "parian: error: scene.json: /layers/0/material: expected the eta 1.5 of 'marble', which "
            "lies below, found 1.3 of 'homogeneous'")
        self.write_json("weights.json", [0, 2])
        layer = {"material": {"named": "marble"}, "mask": {"type": "vertex", "file": "weights.json"}}
        self.assertEqual(self.fails_with_scene(layers=[layer]),
                         "parian: error: weights.json: /1: expected a number in [0, 1], found the number 2")
        self.write_json("weights.json", [0, 1])
        self.assertIn("weights, one per vertex of the mesh, found 2",
                      self.fails_with_scene(layers=[layer]))

    def test_exposure(self):
        self.succeed("render", "scene.json", "-o", "a.exr", *QUICK)
        self.write_json("scene.json", scene(exposure=2))
        self.succeed("render", "scene.json", "-o", "b.exr", *QUICK)
        for a, b in zip(self.mean("a.exr"), self.mean("b.exr")):
            self.assertAlmostEqual(b / a, 4, delta=1e-4)

    def test_output_of_the_scene(self):
        (self.folder / "scenes").mkdir()
        self.write_json("scenes/a.json", scene(output="a.exr"))
        self.succeed("render", "scenes/a.json", *QUICK)
        self.succeed("render", "scene.json", "-o", "b.exr", *QUICK)
        self.assertEqual(self.read_bytes("scenes/a.exr"), self.read_bytes("b.exr"))
        status, _, errors = self.run_program("render", "scene.json", *QUICK)
        self.assertEqual(status, 2)
        self.assertIn("--output: expected an image to write, here or as the scene's 'output', "
                      "found neither", errors)

    def test_mesh_from_a_file(self):
        (self.folder / "tetrahedron.ply").write_text(PLY)
        self.write_json("scene.json", scene(mesh={"file": "tetrahedron.ply", "size_mm": 20}))
        self.assertIn("4 triangles", self.succeed("render", "scene.json", "-o", "a.png", *QUICK))

    def test_holes_stop_the_work(self):
        (self.folder / "open.ply").write_text(
            PLY.replace("element face 4", "element face 3").replace("3 1 2 3\n", ""))
        message = self.fails_with_scene(mesh={"file": "open.ply", "size_mm": 20})
        self.assertIn("open.ply: faces: expected a closed surface, found ", message)
        self.assertIn(" of 2000 rays into the mesh escape (", message)

    def test_scenes_without_light_are_black_and_say_so(self):
        self.write_json("scene.json", scene(lights=[]))
        status, _, errors = self.run_program("render", "scene.json", "-o", "a.exr", *QUICK)
        self.assertEqual(status, 0)
        self.assertEqual(errors, "parian: warning: scene.json: /lights: no light: the mesh will be "
                         "black\n")
        self.assertEqual(self.mean("a.exr"), [0, 0, 0])
        self.assertEqual(self.succeed("render", "scene.json", "-o", "a.exr", "--quiet", *QUICK), "")

    def test_materials_of_another_kind(self):
        self.succeed("render", "scene.json", "-o", "picture.png", *QUICK)
        self.assertEqual(self.fails_with_scene(material={"file": "picture.png"}),
                         "parian: error: picture.png: expected a profile map, a blend or a table, found an "
                         "image")
        self.assertEqual(self.fails_with_scene(material={"file": "sample.json"}),
                         "parian: error: sample.json: expected a profile map, a blend or a table, found a "
                         "JSON file")
        with h5py.File(self.folder / "other.h5", "w") as file:
            file.attrs["format"] = "something-else"
        self.assertIn("other.h5", self.fails_with_scene(material={"file": "other.h5"}))
        self.assertIn("missing.h5", self.fails_with_scene(material={"file": "missing.h5"}))

    def test_files_that_are_missing_or_broken(self):
        self.assertIn("none.ply",
                      self.fails_with_scene(mesh={"file": "none.ply", "size_mm": 20}))
        self.assertIn("none.exr", self.fails_with_scene(
            lights=[{"type": "environment", "file": "none.exr"}]))
        (self.folder / "broken.ply").write_text("ply\nformat")
        self.assertIn("broken.ply",
                      self.fails_with_scene(mesh={"file": "broken.ply", "size_mm": 20}))

    def test_unknown_keys_and_values(self):
        self.assertIn("did you mean 'exposure'", self.fails_with_scene(exposre=1))
        self.assertIn("scene.json: /mesh/size_mm: ",
                      self.fails_with_scene(mesh={"shape": "knot", "size_mm": 0}))

    def test_output_is_checked_before_the_work(self):
        self.fail_with(2, "x.jpg: expected a file name that ends in .png, .exr or .hdr, found "
                       "'.jpg'", "render", "scene.json", "-o", "x.jpg")
        status, _, errors = self.run_program("render", "scene.json", "-o", "nowhere/x.png",
                                             "--samples", "20000000")
        self.assertEqual(status, 1)
        self.assertIn("nowhere/x.png", errors)
        self.fail_with(2, "--samples: expected a value in [100, 20000000], found 3",
                       "render", "scene.json", "-o", "x.png", "--samples", "3")

    def test_memory_is_estimated_beforehand(self):
        self.write_json("scene.json", scene(camera={"width": 16384, "height": 16384}))
        status, _, message = self.run_program("render", "scene.json", "-o", "x.png", "--antialias",
                                              "16")
        self.assertEqual(status, 1)
        self.assertIn("parian: error: memory: expected ", message)
        self.assertIn("GiB (fewer pixels, --samples or --antialias need less), found ", message)

    def test_info(self):
        figures = program.json.loads(self.succeed("info", "scene.json", "--json", "-"))
        self.assertEqual((figures["kind"], figures["width"], figures["lights"]), ("scene", 48, 1))
        self.assertEqual(figures["material"], "marble")
        (self.folder / "t.ply").write_text(PLY)
        figures = program.json.loads(self.succeed("info", "t.ply", "--json", "-"))
        self.assertEqual((figures["kind"], figures["triangles"], figures["boundary_edges"]),
                         ("mesh", 4, 0))
        self.assertAlmostEqual(figures["volume"], 1 / 6, delta=1e-6)

    def test_interrupted_work_leaves_the_old_picture(self):
        (self.folder / "a.png").write_text("old")
        process = self.start("render", "scene.json", "-o", "a.png", "--samples", "20000",
                             "--rays", "60000", "--threads", "1")
        time.sleep(1)
        self.assertIsNone(process.poll(), "the work was over before it could be interrupted")
        process.send_signal(signal.SIGINT)
        output, errors = process.communicate(timeout=60)
        self.assertEqual((process.returncode, output, errors),
                         (1, "", "parian: error: cancelled\n"))
        self.assertEqual(self.read_bytes("a.png"), b"old")
        self.assertEqual(self.names(), ["a.png", "sample.json", "scene.json"])


if __name__ == "__main__":
    program.main()
