"""precompute and render --transport: homogeneous materials edited live."""

import program

QUICK = ("--samples", "2000", "--rays", "16", "--directions", "16", "--path-samples", "16",
         "--resolution", "128")
PICTURE = ("--antialias", "1")


def scene(**changes):
    return {
        "mesh": {"shape": "sphere", "size_mm": 20},
        "material": {"sigma_a": 0.02, "sigma_s": [1, 2, 0.5], "g": 0.2, "single_scattering": True},
        "lights": [{"type": "environment", "sky": "clear"},
                   {"type": "directional", "direction": [1, 1, 1], "irradiance": 2}],
        "camera": {"width": 48, "height": 36},
        **changes,
    }


class Homogeneous(program.ProgramTest):
    def setUp(self):
        super().setUp()
        self.write_json("scene.json", scene())

    def precompute(self, *more):
        return self.succeed("precompute", "scene.json", "-o", "t.h5", *QUICK, *more)

    def mean(self, name):
        figures = program.json.loads(self.succeed("info", name, "--json", "-"))
        return [c["mean"] for c in figures["values"]]

    def test_transport_shows_what_render_shows(self):
        self.assertIn("2 lights", self.precompute("--json", "report.json"))
        report = self.read_json("report.json")
        self.assertEqual((report["lights"], report["multiple_functions"]), (2, 17))
        self.assertEqual(set(report["seconds"]), {"sampling", "irradiance", "multiple", "single"})
        self.assertIn("transport", self.succeed("info", "t.h5"))
        self.succeed("render", "scene.json", "--transport", "t.h5", "-o", "a.exr", *PICTURE)
        self.succeed("render", "scene.json", "-o", "b.exr", "--samples", "2000", "--rays", "16",
                     "--shading", "vertex", *PICTURE)
        for a, b in zip(self.mean("a.exr"), self.mean("b.exr")):
            self.assertAlmostEqual(a / b, 1, delta=0.03)
        # The material of the scene may change, its mesh and lights may not.
        self.write_json("scene.json", scene(material={"named": "Ketchup"}))
        self.succeed("render", "scene.json", "--transport", "t.h5", "-o", "c.exr", *PICTURE)
        self.assertNotEqual(self.read_bytes("a.exr"), self.read_bytes("c.exr"))

    def test_transport_on_the_graphics_device(self):
        self.precompute()
        for name, method in (("a.exr", "tree"), ("b.exr", "splat")):
            self.succeed("render", "scene.json", "--transport", "t.h5", "-o", name, "--method",
                         method, "--json", name + ".json", *PICTURE)
        self.assertEqual(self.read_json("b.exr.json")["gather"], "transport on the graphics device")
        for a, b in zip(self.mean("a.exr"), self.mean("b.exr")):
            self.assertAlmostEqual(b / a, 1, delta=0.02)
        self.succeed("render", "scene.json", "--transport", "t.h5", "-o", "f-#.exr", "--method",
                     "splat", "--sweep", "sigma_s=0.3:4:2", *PICTURE)
        self.assertNotEqual(self.mean("f-1.exr"), self.mean("f-2.exr"))

    def test_transport_is_made_once_and_the_same_by_any_threads(self):
        self.precompute("--threads", "1")
        first = self.read_bytes("t.h5")
        self.assertEqual(self.precompute(), "t.h5: up to date\n")
        self.assertNotIn("t.h5.partial", self.names())
        (self.folder / "t.h5").unlink()
        self.precompute("--threads", "2")
        self.assertEqual(self.read_bytes("t.h5"), first)

    def test_sweeps(self):
        self.precompute()
        self.succeed("render", "scene.json", "--transport", "t.h5", "-o", "s.png", "--sweep",
                     "sigma_s=0.3:4:3", *PICTURE)
        self.assertEqual(program.json.loads(self.succeed("info", "s.png", "--json", "-"))["width"], 144)
        self.succeed("render", "scene.json", "--transport", "t.h5", "-o", "f-##.png", "--sweep",
                     "g=-0.3:0.3:2", "--json", "sweep.json", *PICTURE)
        self.assertEqual([f["file"] for f in self.read_json("sweep.json")["frames"]],
                         ["f-01.png", "f-02.png"])
        self.assertNotEqual(self.read_bytes("f-01.png"), self.read_bytes("f-02.png"))

    def test_bad_sweeps(self):
        for text, message in (
                ("sigma_s", "expected NAME=FIRST:LAST:COUNT, as sigma_s=0.3:4:30, found 'sigma_s'"),
                ("sigma_t=1:2:3", "expected sigma_a, sigma_s, sigma_s_prime, g or thickness_mm, found 'sigma_t' "
                                  "(did you mean 'sigma_a'?)"),
                ("sigma_s=0:2:3", "expected numbers in [1e-06, 1000] for sigma_s, found '0'"),
                ("g=0:1:3", "expected numbers in [-0.99, 0.99] for g, found '1'"),
                ("g=0:nan:3", "expected numbers in [-0.99, 0.99] for g, found 'nan'"),
                ("g=0:0.5:0", "expected a count in [1, 10000], found '0'")):
            self.fail_with(2, "--sweep: " + message, "render", "scene.json", "-o", "x.png",
                           "--sweep", text)

    def test_transport_of_another_scene(self):
        self.precompute()
        render = ("render", "scene.json", "--transport", "t.h5", "-o", "x.png")
        self.write_json("scene.json", scene(mesh={"shape": "sphere", "size_mm": 21}))
        self.fail_with(1, "t.h5: attribute 'mesh_hash': expected the hash of the scene's mesh, "
                       "found that of another", *render)
        changed = scene()
        changed["lights"][1]["irradiance"] = 3
        self.write_json("scene.json", changed)
        self.fail_with(1, "t.h5: attribute 'light_hash_2': expected the hash of the scene's "
                       "light 2, found that of another", *render)
        changed = scene()
        changed["material"]["eta"] = 1.5
        self.write_json("scene.json", changed)
        self.fail_with(1, "t.h5: attribute 'eta': expected 1.5, the scene's, found 1.3", *render)
        self.write_json("scene.json", scene())
        data = self.read_bytes("t.h5")
        (self.folder / "t.h5").write_bytes(data[:len(data) // 2])
        status, _, errors = self.run_program(*render)
        self.assertEqual(status, 1)
        self.assertIn("t.h5", errors)
        self.assertNotIn("x.png", self.names())

    def test_what_cannot_be_precomputed(self):
        self.write_json("scene.json", scene(lights=[]))
        self.fail_with(1, "scene.json: /lights: expected at least one light, found none",
                       "precompute", "scene.json", "-o", "t.h5", "--quiet")
        changed = scene()
        changed["material"]["sigma_s"] = -1
        self.write_json("scene.json", changed)
        self.fail_with(1, "scene.json: /material/sigma_s: expected a number in [1e-06, 1000], "
                       "found the number -1", "precompute", "scene.json", "-o", "t.h5")
        self.assertNotIn("t.h5", self.names())


if __name__ == "__main__":
    program.main()
