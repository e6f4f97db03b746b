#!/usr/bin/env python3
"""The editor, driven by mouse and keyboard under a virtual display.

usage: studio_test.py PARIAN SOURCE_DIR [--keep FOLDER]

Opens, orbits, scribbles, changes the range, undoes, picks, paints, compresses, saves, crashes and
recovers. The program says in a file (--probe) what its state is and where its widgets are; the
test moves a real pointer there. With --keep screenshots and figures stay in FOLDER.
"""

import json
import os
import pathlib
import shutil
import signal
import subprocess
import sys
import tempfile
import time

TIMEOUT = 60


class Display:
    def __init__(self):
        read, write = os.pipe()
        self.process = subprocess.Popen(
            ["Xvfb", "-displayfd", str(write), "-screen", "0", "1440x900x24", "-nolisten", "tcp"],
            pass_fds=[write],
            stderr=subprocess.DEVNULL,
        )
        os.close(write)
        with os.fdopen(read) as stream:
            self.name = ":" + stream.readline().strip()
        assert self.name != ":", "Xvfb did not start"

    def stop(self):
        self.process.terminate()
        self.process.wait()


class Studio:
    def __init__(self, program, display, folder, files=()):
        self.folder = folder
        self.probe = folder / "probe.json"
        self.probe.unlink(missing_ok=True)
        self.env = dict(os.environ, DISPLAY=display.name)
        self.env.pop("WAYLAND_DISPLAY", None)
        self.started = time.monotonic()
        self.process = subprocess.Popen(
            [program, "studio", *files, "--probe", self.probe, "--state", folder / "state",
             "--screenshots", folder],
            env=self.env,
            stdout=subprocess.DEVNULL,
            stderr=open(folder / "stderr.txt", "w"),
        )
        self.until(lambda s: "picture" in s, "a first picture")
        self.first_picture_s = time.monotonic() - self.started
        window = self.xdotool("search", "--sync", "--onlyvisible", "--name", "Parian Studio")
        self.xdotool("windowfocus", "--sync", window.split()[-1])

    def xdotool(self, *words):
        done = subprocess.run(["xdotool", *map(str, words)], env=self.env, capture_output=True,
                              text=True, timeout=TIMEOUT)
        assert done.returncode == 0, f"xdotool {words}: {done.stderr}"
        return done.stdout.strip()

    def state(self):
        try:
            return json.loads(self.probe.read_text())
        except FileNotFoundError:
            return {}

    def until(self, holds, what):
        end = time.monotonic() + TIMEOUT
        state = {}
        while time.monotonic() < end:
            code = self.process.poll()
            assert code is None, (f"waiting for {what}: the program ended with {code}: "
                                  + (self.folder / "stderr.txt").read_text())
            state = self.state()
            if state and holds(state):
                return state
            time.sleep(0.05)
        state.pop("widgets", None)
        raise AssertionError(f"no {what} within {TIMEOUT} s: {json.dumps(state)[:3000]}")

    def settle(self):
        time.sleep(0.15)
        return self.until(lambda s: s["settled"], "settled state")

    def place(self, widget, u=0.5, v=0.5):
        box = self.until(lambda s: widget in s["widgets"], f"widget '{widget}'")["widgets"][widget]
        return (round(box[0] + u * (box[2] - box[0])), round(box[1] + v * (box[3] - box[1])))

    def click(self, widget, u=0.5, v=0.5, keys=()):
        x, y = self.place(widget, u, v)
        self.xdotool("mousemove", x, y)
        time.sleep(0.15)
        for key in keys:
            self.xdotool("keydown", key)
        time.sleep(0.1)
        self.xdotool("mousedown", 1)
        time.sleep(0.1)
        self.xdotool("mouseup", 1)
        time.sleep(0.1)
        for key in keys:
            self.xdotool("keyup", key)
        time.sleep(0.1)

    def drag(self, widget, points):
        places = [self.place(widget, *point) for point in points]
        self.xdotool("mousemove", *places[0])
        time.sleep(0.15)
        self.xdotool("mousedown", 1)
        for (x0, y0), (x1, y1) in zip(places, places[1:]):
            for i in range(1, 5):
                self.xdotool("mousemove", x0 + (x1 - x0) * i // 4, y0 + (y1 - y0) * i // 4)
                time.sleep(0.06)
        time.sleep(0.1)
        self.xdotool("mouseup", 1)

    def key(self, name):
        self.xdotool("key", name)
        time.sleep(0.2)

    def type_into(self, widget, text):
        self.click(widget)
        self.key("ctrl+a")
        self.xdotool("type", "--delay", "40", text)
        time.sleep(0.3)

    def screenshot(self, name):
        before = set(self.folder.glob("parian-*.png"))
        self.xdotool("mousemove", 5, 880)
        time.sleep(0.2)
        self.key("F12")
        self.until(lambda s: set(self.folder.glob("parian-*.png")) - before, "screenshot")
        self.until(lambda s: any("screenshot" in m for m in s["messages"]), "screenshot message")
        (made,) = set(self.folder.glob("parian-*.png")) - before
        assert made.stat().st_size > 20000, f"{name}: {made.stat().st_size} bytes"
        made.rename(self.folder / f"studio-{name}.png")


def source(state, layer):
    return state["layers"][layer]["source"]


def check_orbit(studio):
    before = studio.settle()
    studio.drag("view", [(0.4, 0.5), (0.6, 0.45)])
    after = studio.until(lambda s: s["yaw_deg"] != before["yaw_deg"], "turned camera")
    assert abs(after["yaw_deg"] - before["yaw_deg"]) > 10, after["yaw_deg"]
    studio.settle()
    studio.click("tool/light")
    studio.drag("view", [(0.5, 0.5), (0.3, 0.5)])
    lit = studio.until(lambda s: s["azimuth_deg"] != before["azimuth_deg"], "turned lamp")
    assert lit["yaw_deg"] == after["yaw_deg"]
    assert studio.settle()["brightness"] != after["brightness"]


def check_scribble(studio):
    studio.click("tool/scribble +")
    studio.drag("flat", [(0.5, 0.6), (0.6, 0.7)])
    state = studio.until(lambda s: len(s["layers"]) == 1, "layer of the scribble")
    layer = source(state, 0)
    assert layer["operation"] == "adjust" and layer["selection"]["type"] == "propagate", layer
    assert 0.01 < state["layers"][0]["selected"] < 0.9, state["layers"][0]["selected"]
    studio.click("tool/scribble -")
    studio.drag("flat", [(0.1, 0.45), (0.2, 0.5)])
    state = studio.until(lambda s: len(source(s, 0)["selection"]["strokes"]) == 2, "two strokes")
    assert source(state, 0)["selection"]["strokes"][1]["positive"] is False
    assert len(state["layers"]) == 1


def check_range(studio):
    before = studio.settle()
    studio.click("param/range_scale", u=0.25, keys=["ctrl"])
    studio.key("ctrl+a")
    studio.xdotool("type", "--delay", "40", "0.25")
    studio.key("Return")
    studio.until(lambda s: source(s, 0).get("range_scale") == 0.25, "changed range")
    after = studio.settle()
    assert abs(after["brightness"] - before["brightness"]) > 1e-3, after["brightness"]
    assert after["edit_shown_ms"] > 0
    # A drag is one entry of the history.
    entries = len(after["history"])
    studio.drag("param/albedo_scale", [(0.2, 0.5), (0.1, 0.5), (0.05, 0.5)])
    state = studio.until(lambda s: "albedo_scale" in source(s, 0), "dragged albedo")
    state = studio.settle()
    assert len(state["history"]) == entries + 1, state["history"]
    return after


def check_undo(studio):
    studio.xdotool("mousemove", 5, 880)
    studio.key("ctrl+z")
    state = studio.until(lambda s: "albedo_scale" not in source(s, 0), "undone albedo")
    assert source(state, 0)["range_scale"] == 0.25
    studio.key("ctrl+z")
    studio.until(lambda s: "range_scale" not in source(s, 0), "undone range")
    studio.key("ctrl+y")
    studio.until(lambda s: source(s, 0).get("range_scale") == 0.25, "redone range")


def check_paint(studio):
    studio.click("tool/pick")
    studio.click("flat", 0.2, 0.85)
    studio.until(lambda s: s["picked"], "picked profile")
    studio.click("tool/paint")
    studio.drag("flat", [(0.45, 0.1), (0.55, 0.2)])
    state = studio.until(lambda s: len(s["layers"]) == 2, "painted layer")
    assert source(state, 1)["operation"] == "blend", source(state, 1)
    # On the mesh the same stroke tool paints the map under the pointer.
    studio.drag("view", [(0.35, 0.2), (0.38, 0.22)])
    state = studio.until(lambda s: len(source(s, 1)["selection"]["of"]) >= 2, "stroke on the mesh")
    assert len(state["layers"]) == 2


def check_modes(studio):
    seen = set()
    for mode in ["albedo", "range", "irradiance", "difference", "wireframe", "shaded"]:
        studio.click("view mode")
        studio.click("view mode/" + mode)
        state = studio.until(lambda s: s["mode"] == mode, f"mode {mode}")
        seen.add(round(studio.settle()["brightness"], 3))
        if mode in ("range", "difference"):
            studio.screenshot(mode)
    assert len(seen) == 6, seen
    for mode in ["uniform", "selection", "beam", "albedo"]:
        studio.click("flat mode")
        studio.click("flat mode/" + mode)
        studio.until(lambda s: s["flat_mode"] == mode, f"flat mode {mode}")
        studio.settle()


def check_compress(studio):
    studio.click("tab/Compress")
    studio.click("compress")
    state = studio.until(lambda s: s["compressed"] >= 3 and s["settled"], "compressions")
    studio.click("compressed/0", u=0.05)
    shown = studio.until(lambda s: s["picture"] > state["picture"] and s["settled"], "its picture")
    assert shown["brightness"] != state["brightness"]
    studio.screenshot("compress")
    studio.click("compressed/none", u=0.05)
    studio.click("tab/Layers")


def check_homogeneous(studio):
    studio.click("tab/Material")
    before = studio.settle()
    studio.click("homogeneous", u=0.1)
    studio.until(lambda s: s["homogeneous"], "homogeneous material")
    state = studio.settle()
    assert state["brightness"] != before["brightness"]
    studio.click("measured")
    studio.click("measured/Ketchup")
    ketchup = studio.settle()
    assert ketchup["brightness"] != state["brightness"]
    studio.screenshot("homogeneous")
    studio.click("homogeneous", u=0.1)
    studio.until(lambda s: not s["homogeneous"], "map again")
    studio.click("tab/Layers")


def check_save(studio, folder):
    studio.xdotool("mousemove", 5, 880)
    studio.key("ctrl+s")
    studio.type_into("file/folder", str(folder))
    studio.type_into("file/name", "made.json")
    studio.click("file/ok")
    studio.until(lambda s: any("saved" in m for m in s["messages"]), "saved recipe")
    assert (folder / "made.json").exists(), studio.state()["messages"]
    recipe = json.loads((folder / "made.json").read_text())
    assert [layer["operation"] for layer in recipe["layers"]] == ["adjust", "blend"], recipe


def check_errors(studio, folder):
    (folder / "broken.ply").write_text("ply\nno")
    for name, part in [("no-such-file.h5", "no-such-file.h5"), ("broken.ply", "broken.ply")]:
        studio.xdotool("mousemove", 5, 880)
        studio.key("ctrl+o")
        studio.type_into("file/folder", str(folder))
        studio.type_into("file/name", name)
        studio.click("file/ok")
        studio.until(lambda s: any(part in m for m in s["messages"]), f"message about {name}")


def check_recipe(program, source_dir, folder):
    """What the window saved, the command line applies."""
    subprocess.run([program, "fit", source_dir / "data/stone-72x64.h5", "-o", folder / "map.h5",
                    "--quiet"], check=True)
    subprocess.run([program, "edit", folder / "map.h5", "--recipe", folder / "made.json", "-o",
                    folder / "edited.h5", "--quiet"], check=True)


def run(program, source_dir, folder, figures):
    display = Display()
    try:
        studio = Studio(program, display, folder)
        figures["first_picture_s"] = studio.first_picture_s
        studio.until(lambda s: s["settled"], "refined picture")
        studio.screenshot("start")
        studio.click("refine", u=0.1)
        check_orbit(studio)
        check_scribble(studio)
        state = check_range(studio)
        figures["edit_ms"] = state["edit_ms"]
        figures["edit_shown_ms"] = state["edit_shown_ms"]
        studio.screenshot("range")
        check_undo(studio)
        check_paint(studio)
        studio.settle()
        studio.screenshot("paint")
        check_modes(studio)
        check_compress(studio)
        check_homogeneous(studio)
        check_save(studio, folder)
        check_errors(studio, folder)
        studio.settle()
        studio.process.send_signal(signal.SIGKILL)
        studio.process.wait()

        studio = Studio(program, display, folder)
        assert studio.until(lambda s: True, "state")["recoverable"]
        studio.click("recover/yes")
        studio.until(lambda s: len(s["layers"]) == 2, "recovered layers")
        studio.screenshot("recovered")
        studio.key("ctrl+q")
        studio.click("quit/yes")
        assert studio.process.wait(timeout=TIMEOUT) == 0
        assert not (folder / "state/autosave.json").exists()
        check_recipe(program, source_dir, folder)
    finally:
        display.stop()


def main():
    program, source_dir = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2]).resolve()
    keep = pathlib.Path(sys.argv[4]) if sys.argv[3:4] == ["--keep"] else None
    figures = {}
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        try:
            run(program, source_dir, folder, figures)
        finally:
            if keep is not None:
                keep.mkdir(parents=True, exist_ok=True)
                for path in folder.glob("studio-*.png"):
                    shutil.copy(path, keep)
    for name, value in figures.items():
        print(f"{name}: {value:.3g}")


if __name__ == "__main__":
    main()
