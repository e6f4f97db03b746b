"""Ctrl-C in the middle: the old output stays whole, and nothing else is left behind."""

import signal
import time

import program


class Cancel(program.ProgramTest):
    def interrupt(self, has_begun, *arguments):
        """Interrupts the work once it has begun."""
        process = self.start(*arguments)
        while process.poll() is None and not has_begun(process):
            time.sleep(0.01)
        self.assertIsNone(process.poll(), "the work was over before it could be interrupted")
        process.send_signal(signal.SIGINT)
        output, errors = process.communicate(timeout=60)
        self.assertEqual((process.returncode, output, errors), (1, "", "parian: error: cancelled\n"))

    @staticmethod
    def has_read_values(process):
        """Whether it has read more than the program itself and a table's header."""
        with open(f"/proc/{process.pid}/io") as file:
            return int(file.readline().split()[1]) > 3_000_000

    def test_simulate(self):
        self.write_json("sample.json", program.sample(256, 256, 40))
        (self.folder / "table.h5").write_text("old")
        self.interrupt(lambda process: len(self.names()) == 3, "simulate", "sample.json", "-o", "table.h5", "--threads", "1")
        self.assertEqual(self.read_bytes("table.h5"), b"old")
        self.assertEqual(self.names(), ["sample.json", "table.h5"])

    def test_fit(self):
        self.write_json("sample.json", program.sample(160, 160, 12))
        self.succeed("simulate", "sample.json", "-o", "table.h5")
        (self.folder / "map.h5").write_text("old")
        self.interrupt(self.has_read_values, "fit", "table.h5", "-o", "map.h5", "--threads", "1", "--lambda", "0",
                       "--tolerance", "1e-14", "--max-iterations", "100000")
        self.assertEqual(self.read_bytes("map.h5"), b"old")
        self.assertEqual(self.names(), ["map.h5", "sample.json", "table.h5"])

    def test_compress(self):
        self.write_json("sample.json", program.sample(160, 160, 12))
        self.succeed("simulate", "sample.json", "-o", "table.h5")
        (self.folder / "blend.kbm").write_text("old")
        self.interrupt(self.has_read_values, "compress", "table.h5", "-o", "blend.kbm", "--threads",
                       "1", "--rounds", "1000", "--tolerance", "0")
        self.assertEqual(self.read_bytes("blend.kbm"), b"old")
        self.assertEqual(self.names(), ["blend.kbm", "sample.json", "table.h5"])

    def test_precompute_is_taken_up_again(self):
        """Lights that are done are kept; the file is what an uninterrupted run writes."""
        self.write_json("scene.json", {
            "mesh": {"shape": "sphere", "size_mm": 20},
            "material": {"sigma_a": 0.02, "sigma_s": 1, "single_scattering": True},
            "lights": [{"type": "directional", "direction": [1, 1, 1]},
                       {"type": "environment", "sky": "clear"}]})
        command = ("precompute", "scene.json", "--samples", "3000", "--resolution", "256",
                   "--directions", "64", "--rays", "16", "-o")
        self.interrupt(lambda process: "t.h5.partial" in self.names(), *command, "t.h5", "--threads", "1")
        self.assertNotIn("t.h5", self.names())
        self.assertIn("[\"light 1 (directional)\"]", self.succeed("info", "t.h5.partial"))
        self.succeed(*command, "t.h5")
        self.assertNotIn("t.h5.partial", self.names())
        self.succeed(*command, "whole.h5")
        self.assertEqual(self.read_bytes("t.h5"), self.read_bytes("whole.h5"))


if __name__ == "__main__":
    program.main()
