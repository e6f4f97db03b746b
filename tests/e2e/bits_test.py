"""The same bits for any number of threads, and of --portable from run to run."""

import time

import program


class Bits(program.ProgramTest):
    def fit(self, name, *flags):
        self.succeed("simulate", "sample.json", "-o", f"{name}-table.h5", "--quiet", *flags)
        self.succeed("fit", f"{name}-table.h5", "-o", f"{name}.h5", "--quiet", *flags)
        self.succeed("compare", f"{name}-table.h5", f"{name}.h5", "--json", f"{name}.json",
                     "--quiet", *flags)
        return [self.read_bytes(f"{name}{end}") for end in ("-table.h5", ".h5", ".json")]

    def test_threads_do_not_change_a_bit(self):
        self.write_json("sample.json", program.sample(40, 33, 7))
        first = self.fit("a", "--threads", "1")
        time.sleep(1.1)  # no file holds the time of day
        self.assertEqual(first, self.fit("b", "--threads", "2"))

    def test_portable_runs_agree(self):
        self.assertEqual(self.fit("a", "--portable", "--threads", "1"), self.fit("b", "--portable"))


if __name__ == "__main__":
    program.main()
