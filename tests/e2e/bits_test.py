"""The same bits for any number of threads, and of --portable from run to run."""

import time

import program


class Bits(program.ProgramTest):
    def make_files(self, *flags):
        """The bytes of table, map and report, by name."""
        self.succeed("simulate", "sample.json", "-o", "table.h5", "--quiet", *flags)
        self.succeed("fit", "table.h5", "-o", "map.h5", "--quiet", *flags)
        self.succeed("compare", "table.h5", "map.h5", "--json", "report.json", "--quiet", *flags)
        return {name: self.read_bytes(name) for name in ("table.h5", "map.h5", "report.json")}

    def assert_same_bits(self, first, second):
        self.assertEqual([name for name in first if first[name] != second[name]], [])

    def test_threads_do_not_change_a_bit(self):
        self.write_json("sample.json", program.sample(40, 33, 7))
        first = self.make_files("--threads", "1")
        time.sleep(1.1)  # no file holds the time of day
        self.assert_same_bits(first, self.make_files("--threads", "2"))

    def test_portable_runs_agree(self):
        self.assert_same_bits(self.make_files("--portable", "--threads", "1"),
                              self.make_files("--portable"))

    def test_portable_keeps_the_c_library_from_fused_operations(self):
        self.write_json("sample.json", program.sample(512, 512, 30))
        process = self.start("simulate", "sample.json", "-o", "table.h5", "--portable")
        while process.poll() is None and len(self.names()) < 2:
            time.sleep(0.01)
        with open(f"/proc/{process.pid}/environ") as file:
            environment = file.read()
        process.terminate()
        self.assertIn("hwcaps=-FMA,", environment)
        self.assertEqual(process.communicate(timeout=60)[1], "parian: error: cancelled\n")


if __name__ == "__main__":
    program.main()
