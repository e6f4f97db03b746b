"""Runs the program as a user would, in a temporary folder. Tests are unittest cases:

    python3 tests/e2e/NAME_test.py PATH_OF_PARIAN SOURCE_FOLDER
"""

import json
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

PARIAN = pathlib.Path(sys.argv[1]).resolve()
SOURCE = pathlib.Path(sys.argv[2]).resolve()


def sample(width=24, height=20, radius=5, **changes):
    """A small chessboard's description."""
    return {
        "name": "small chessboard",
        "materials": [
            {"name": "light", "sigma_a": [0.004, 0.01, 0.03], "sigma_s_prime": [2.2, 2.6, 3.0]},
            {"name": "dark", "sigma_a": [0.05, 0.02, 0.01], "sigma_s_prime": [0.9, 0.8, 0.7]},
        ],
        "layout": {"kind": "chessboard", "tile_mm": 3},
        "pitch_mm": 0.5,
        "size": [width, height],
        "radius_px": radius,
        **changes,
    }


class ProgramTest(unittest.TestCase):
    """Each test has a folder of its own, in which the program runs."""

    def setUp(self):
        temporary = tempfile.TemporaryDirectory(prefix="parian-e2e-")
        self.addCleanup(temporary.cleanup)
        self.folder = pathlib.Path(temporary.name)
        self.write_json("sample.json", sample())

    def write_json(self, name, value):
        (self.folder / name).write_text(json.dumps(value))

    def read_json(self, name):
        return json.loads((self.folder / name).read_text())

    def read_bytes(self, name):
        return (self.folder / name).read_bytes()

    def start(self, *arguments):
        environment = {key: value for key, value in os.environ.items()
                       if key not in ("PARIAN_PORTABLE", "GLIBC_TUNABLES")}
        return subprocess.Popen([PARIAN, *map(str, arguments)], cwd=self.folder, env=environment,
                                stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)

    def run_program(self, *arguments):
        process = self.start(*arguments)
        output, errors = process.communicate(timeout=240)
        return process.returncode, output, errors

    def succeed(self, *arguments):
        """Standard output of a run that must end well and say nothing on standard error."""
        status, output, errors = self.run_program(*arguments)
        self.assertEqual((status, errors), (0, ""), f"parian {' '.join(map(str, arguments))}")
        return output

    def fail_with(self, status, message, *arguments):
        """A run that must fail with this status and this one line."""
        found = self.run_program(*arguments)
        self.assertEqual((found[0], found[2]), (status, f"parian: error: {message}\n"))
        self.assertEqual(found[1], "")

    def names(self):
        """All names in the folder, hidden ones too."""
        return sorted(os.listdir(self.folder))


def main():
    unittest.main(argv=sys.argv[:1], verbosity=2)
