"""Drives the editor by mouse and keyboard under a virtual display, for tests and for the pictures of
the docs.

The editor says in a file (--probe) what its state is, where its widgets are, and which input it has
taken in: each step waits for that, never for time to pass.
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

from xdnd import drop_files

TIMEOUT = 120


class Display:
    def __init__(self, width=1440, height=900):
        read, write = os.pipe()
        self.process = subprocess.Popen(
            ["Xvfb", "-displayfd", str(write), "-screen", "0", f"{width}x{height}x24",
             "-nolisten", "tcp"],
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
    def __init__(self, program, display, folder, files=(), width=1440, height=900, flags=(), env=()):
        self.folder = folder
        self.probe = folder / "probe.json"
        self.probe.unlink(missing_ok=True)
        self.env = dict(os.environ, DISPLAY=display.name, **dict(env))
        self.env.pop("WAYLAND_DISPLAY", None)
        self.started = time.monotonic()
        self.process = subprocess.Popen(
            [program, "studio", *files, "--probe", self.probe, "--state", folder / "state",
             "--screenshots", folder, "--width", str(width), "--height", str(height), *flags],
            env=self.env,
            stdout=subprocess.DEVNULL,
            stderr=open(folder / "stderr.txt", "w"),
        )
        self.until(lambda s: "picture" in s, "first picture")
        self.first_picture_s = time.monotonic() - self.started
        window = self.xdotool("search", "--sync", "--onlyvisible", "--name", "Parian Studio")
        self.window = window.split()[-1]
        self.xdotool("windowfocus", "--sync", self.window)

    def stop(self):
        if self.process.poll() is None:
            self.process.send_signal(signal.SIGKILL)
        self.process.wait()

    def xdotool(self, *words):
        done = subprocess.run(["xdotool", *map(str, words)], env=self.env, capture_output=True,
                              text=True, timeout=TIMEOUT)
        assert done.returncode == 0, f"xdotool {words}: {done.stderr}"
        return done.stdout.strip()

    # What the editor says.

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
            time.sleep(0.02)
        state["widgets"] = sorted(state.get("widgets", {}))
        raise AssertionError(f"no {what} within {TIMEOUT} s: {json.dumps(state)[:4000]}")

    def settle(self):
        """After all input so far: nothing runs, and what is shown is of the present state."""
        return self.until(lambda s: s["settled"], "settled state")

    def message(self, part):
        return self.until(lambda s: any(part in m for m in s["messages"]), f"message '{part}'")

    # Input, each step waiting until it was taken in.

    def move(self, x, y):
        self.xdotool("mousemove", x, y)
        self.until(lambda s: abs(s["input"]["mouse"][0] - x) < 1
                   and abs(s["input"]["mouse"][1] - y) < 1, f"mouse at {x}, {y}")

    def press(self, button=1):
        before = self.state()["input"]["presses"]
        self.xdotool("mousedown", button)
        self.until(lambda s: s["input"]["presses"] > before and s["input"]["down"], "press")

    def release(self, button=1):
        self.xdotool("mouseup", button)
        self.until(lambda s: not s["input"]["down"], "release")

    def keys(self, count, *words):
        before = self.state()["input"]["keys"]
        self.xdotool(*words)
        self.until(lambda s: s["input"]["keys"] >= before + count, f"keys {words}")

    def key(self, name):
        self.keys(len(name.split("+")) if name != "plus" else 1, "key", name)

    def write(self, text):
        self.keys(len(text), "type", "--delay", "15", "--", text)

    def place(self, widget, u=0.5, v=0.5):
        box = self.until(lambda s: widget in s["widgets"], f"widget '{widget}'")["widgets"][widget]
        return (round(box[0] + u * (box[2] - box[0])), round(box[1] + v * (box[3] - box[1])))

    def click(self, widget, u=0.5, v=0.5, held=None):
        self.move(*self.place(widget, u, v))
        if held:
            self.keys(1, "keydown", held)
        self.press()
        self.release()
        if held:
            self.xdotool("keyup", held)

    def click_to_end(self, widget):
        """A click that ends the program, which may answer nothing after it; its exit status."""
        self.move(*self.place(widget))
        self.press()
        self.xdotool("mouseup", 1)
        return self.process.wait(timeout=TIMEOUT)

    def key_to_end(self, name):
        """The same for a key."""
        self.xdotool("key", name)
        return self.process.wait(timeout=TIMEOUT)

    def drag(self, widget, points, button=1, held=None, steps=4):
        places = [self.place(widget, *point) for point in points]
        self.move(*places[0])
        if held:
            self.keys(1, "keydown", held)
        self.press(button)
        for (x0, y0), (x1, y1) in zip(places, places[1:]):
            for i in range(1, steps + 1):
                self.move(round(x0 + (x1 - x0) * i / steps), round(y0 + (y1 - y0) * i / steps))
        self.release(button)
        if held:
            self.xdotool("keyup", held)

    def drop(self, *paths):
        """Files from another program, dropped on the 3-D view all at once."""
        drop_files(self.env["DISPLAY"], int(self.window), paths, *self.place("view"))

    def leave_widgets(self):
        """Where nothing is under the mouse."""
        self.move(3, self.state()["input"]["height"] - 3)

    def choose(self, group, name):
        self.click(group)
        self.click(f"{group}/{name}")

    def write_into(self, widget, text):
        self.click(widget)
        self.key("ctrl+a")
        self.write(text)

    def set_number(self, widget, text):
        self.click(widget, u=0.25, held="ctrl")
        self.key("ctrl+a")
        self.write(text)
        self.key("Return")

    def in_file_dialog(self, folder, name):
        self.write_into("file/folder", str(folder))
        self.write_into("file/name", name)
        self.click("file/ok")

    def menu(self, menu, item):
        self.click(f"menu/{menu}")
        self.click(f"menu/{item}")

    def screenshot(self, name):
        before = set(self.folder.glob("parian-*.png"))
        count = len(self.state()["messages"])
        self.leave_widgets()
        self.key("F12")
        self.until(lambda s: len(set(self.folder.glob("parian-*.png")) - before) == 1, "screenshot")
        self.until(lambda s: len(s["messages"]) > count or "screenshot" in s["messages"][-1],
                   "message of the screenshot")
        (made,) = set(self.folder.glob("parian-*.png")) - before
        assert made.stat().st_size > 5000, f"{name}: {made.stat().st_size} bytes"
        made.rename(self.folder / f"studio-{name}.png")


def run_sessions(run, width, height):
    """Calls run(program, source_dir, display, folder) as `TEST PARIAN SOURCE_DIR [--keep FOLDER]`
    says; screenshots stay in FOLDER."""
    program, source_dir = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2]).resolve()
    keep = pathlib.Path(sys.argv[4]) if sys.argv[3:4] == ["--keep"] else None
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        display = Display(width, height)
        try:
            started = time.monotonic()
            run(program, source_dir, display, folder)
            print(f"seconds: {time.monotonic() - started:.3g}")
        finally:
            display.stop()
            if keep is not None:
                keep.mkdir(parents=True, exist_ok=True)
                for path in folder.glob("studio-*.png"):
                    shutil.copy(path, keep)
