#!/usr/bin/env python3
"""The editor, driven by mouse and keyboard under a virtual display.

usage: studio_test.py PARIAN SOURCE_DIR [--keep FOLDER]

Opens, orbits, scribbles, changes the range, undoes, picks, paints, stamps, compresses, saves, meets
broken files and tiny windows, crashes and recovers; then a scene with layers and several lights is
opened, changed, saved and rendered by the command line. With --keep screenshots stay in FOLDER.
"""

import json
import math
import subprocess
import time

from png import mean_difference
from studio_driver import TIMEOUT, Studio, run_sessions

WIDTH, HEIGHT = 1280, 720


def source(state, layer):
    return state["layers"][layer].get("source", {})


def count_layers(studio, count, what):
    return studio.until(lambda s: len(s["layers"]) == count, what)


def choose_draft(studio):
    """Pictures stay as they are while something moves: the quick ones."""
    studio.choose("still", "draft")
    studio.until(lambda s: s["still"] == "draft", "drafts")


def check_orbit(studio):
    before = studio.settle()
    studio.drag("view", [(0.4, 0.5), (0.6, 0.45)])
    after = studio.settle()
    assert abs(after["yaw_deg"] - before["yaw_deg"]) > 10, after["yaw_deg"]
    assert after["brightness"] != before["brightness"]
    studio.click("tool/light")
    studio.drag("view", [(0.5, 0.5), (0.3, 0.5)])
    lit = studio.settle()
    assert lit["azimuth_deg"] != before["azimuth_deg"] and lit["yaw_deg"] == after["yaw_deg"]
    assert lit["brightness"] != after["brightness"]
    # The right button turns the lamp with any tool, and with Ctrl the environment.
    studio.click("tool/orbit")
    studio.drag("view", [(0.5, 0.5), (0.4, 0.5)], button=3, held="ctrl")
    turned = studio.until(lambda s: s["rotation_deg"] != 0, "turned environment")
    assert turned["azimuth_deg"] == lit["azimuth_deg"] and turned["yaw_deg"] == lit["yaw_deg"]
    studio.move(*studio.place("view"))
    studio.xdotool("click", 4)
    studio.until(lambda s: s["distance_mm"] < before["distance_mm"], "zoom")
    studio.key("f")
    studio.until(lambda s: abs(s["distance_mm"] / before["distance_mm"] - 1) < 0.01, "framed mesh")


def check_undo_of_light(studio):
    """The light is undone like an edit."""
    turned = studio.settle()["rotation_deg"]
    studio.key("ctrl+z")
    studio.until(lambda s: s["rotation_deg"] == 0, "undone environment")
    studio.key("ctrl+y")
    studio.until(lambda s: s["rotation_deg"] == turned, "redone environment")


def check_scribble(studio):
    studio.click("tool/scribble +")
    studio.drag("flat", [(0.5, 0.6), (0.6, 0.7)])
    state = count_layers(studio, 1, "layer of the scribble")
    layer = source(state, 0)
    assert layer["operation"] == "adjust" and layer["selection"]["type"] == "propagate", layer
    state = studio.until(lambda s: "selected" in s["layers"][0], "selection")
    assert 0.01 < state["layers"][0]["selected"] < 0.9, state["layers"][0]["selected"]
    studio.click("tool/scribble -")
    studio.drag("flat", [(0.1, 0.45), (0.2, 0.5)])
    state = studio.until(lambda s: len(source(s, 0)["selection"]["strokes"]) == 2, "two strokes")
    assert source(state, 0)["selection"]["strokes"][1]["positive"] is False
    assert len(state["layers"]) == 1


def check_range(studio):
    before = studio.settle()
    studio.set_number("param/range_scale", "0.25")
    studio.until(lambda s: source(s, 0).get("range_scale") == 0.25, "changed range")
    after = studio.settle()
    assert abs(after["brightness"] - before["brightness"]) > 1e-3, after["brightness"]
    assert after["edit_shown_ms"] > 0
    # A drag is one entry of the history.
    entries = len(after["history"])
    studio.drag("param/albedo_scale", [(0.2, 0.5), (0.1, 0.5), (0.05, 0.5)])
    studio.until(lambda s: "albedo_scale" in source(s, 0), "dragged albedo")
    state = studio.settle()
    assert len(state["history"]) == entries + 1, state["history"]
    return after


def check_undo(studio):
    studio.key("ctrl+z")
    state = studio.until(lambda s: "albedo_scale" not in source(s, 0), "undone albedo")
    assert source(state, 0)["range_scale"] == 0.25
    studio.key("ctrl+z")
    studio.until(lambda s: "range_scale" not in source(s, 0), "undone range")
    studio.key("ctrl+y")
    studio.until(lambda s: source(s, 0).get("range_scale") == 0.25, "redone range")
    # Back to the start in one step, and forth again.
    rows = len(studio.settle()["history"])
    studio.click("history/0", u=0.2)
    count_layers(studio, 0, "the map as opened")
    last = max(int(name.split("/")[1]) for name in studio.settle()["widgets"]
               if name.startswith("history/"))
    assert last > rows, (last, rows)  # the light's entries are there too
    studio.click(f"history/{last - 1}", u=0.2)
    studio.until(lambda s: s["layers"] and source(s, 0).get("range_scale") == 0.25, "redone all")


def check_paint(studio):
    studio.click("tool/pick")
    studio.click("flat", 0.2, 0.85)
    studio.until(lambda s: s["picked"], "picked profile")
    studio.click("tool/paint")
    studio.drag("flat", [(0.45, 0.1), (0.55, 0.2)])
    state = count_layers(studio, 2, "painted layer")
    assert source(state, 1)["operation"] == "blend", source(state, 1)
    before = studio.settle()
    strokes = len(source(before, 1)["selection"]["of"])
    # On the mesh the same tool paints the map under the pointer.
    studio.drag("view", [(0.19, 0.30), (0.22, 0.26)])
    state = studio.until(lambda s: len(source(s, 1)["selection"]["of"]) > strokes, "mesh stroke")
    assert len(state["layers"]) == 2
    assert studio.settle()["brightness"] != before["brightness"]


def check_brush_and_stamp(studio):
    """A brush widens the selected layer's selection, or makes a layer over one of another kind."""
    studio.click("tool/brush")
    strokes = len(source(studio.state(), 1)["selection"]["of"])
    studio.drag("view", [(0.8, 0.5), (0.82, 0.55)])
    studio.until(lambda s: len(source(s, 1)["selection"]["of"]) > strokes, "wider selection")
    studio.click("layer/0", u=0.3)
    studio.until(lambda s: s["selected_layer"] == 0, "selected scribble")
    studio.drag("view", [(0.8, 0.5), (0.82, 0.55)])
    state = count_layers(studio, 3, "brushed layer")
    assert source(state, 1)["selection"]["type"] == "union"
    studio.click("tool/stamp")
    studio.drag("flat", [(0.1, 0.1), (0.35, 0.4)])
    studio.message("pattern taken")
    studio.click("flat", 0.6, 0.6)
    state = count_layers(studio, 4, "stamped layer")
    assert [layer["source"]["operation"] for layer in state["layers"]] == [
        "adjust", "adjust", "paste", "blend"], state["layers"]
    studio.settle()


def check_layers(studio):
    """Add, change, move, switch off, remove."""
    studio.click("add layer")
    studio.click("add layer/filter", u=0.1)
    state = count_layers(studio, 5, "filter")
    assert source(state, 3)["operation"] == "filter"
    studio.set_number("param/sigma_mm", "2.5")
    studio.until(lambda s: source(s, 3).get("sigma_mm") == 2.5, "its width")
    studio.set_number("param/opacity", "0.5")
    studio.until(lambda s: source(s, 3).get("opacity") == 0.5, "its opacity")
    studio.click("layer/3/down")
    studio.until(lambda s: source(s, 2)["operation"] == "filter", "moved layer")
    before = studio.settle()
    studio.click("layer/2/on")
    studio.until(lambda s: source(s, 2).get("enabled") is False, "layer that is off")
    assert studio.settle()["brightness"] != before["brightness"]
    studio.leave_widgets()
    studio.key("Delete")
    count_layers(studio, 4, "removed filter")
    # What needs something first says so.
    studio.click("add layer")
    studio.click("add layer/hallucinate", u=0.1)
    studio.message("Material from photograph")
    for layer in (2, 1):
        studio.click(f"layer/{layer}/remove")
        count_layers(studio, layer + 1, "fewer layers")
    studio.click("layer/1", u=0.3)
    studio.settle()


def check_second_material(studio, folder):
    studio.menu("file", "export map")
    studio.in_file_dialog(folder, "other.h5")
    studio.message("saved")
    studio.menu("file", "second")
    studio.in_file_dialog(folder, "other.h5")
    studio.until(lambda s: s["second"].endswith("other.h5"), "second material")
    studio.click("tool/pick")
    studio.click("flat", 0.5, 0.5)
    studio.choose("flat source", "this map")
    studio.click("tool/paint")
    studio.drag("flat", [(0.8, 0.8), (0.9, 0.9)])
    state = count_layers(studio, 3, "layer with a profile of the second material")
    assert source(state, 2)["from"]["map"].endswith("other.h5"), source(state, 2)
    studio.key("ctrl+z")
    count_layers(studio, 2, "undone paint")


def check_modes(studio):
    seen = set()
    for mode in ["albedo", "range", "irradiance", "difference", "wireframe", "shaded"]:
        studio.choose("view mode", mode)
        studio.until(lambda s: s["mode"] == mode, f"mode {mode}")
        seen.add(round(studio.settle()["brightness"], 3))
        if mode in ("range", "difference"):
            studio.screenshot(mode)
    assert len(seen) == 6, seen
    for mode in ["uniform", "disc", "line", "selection", "beam", "albedo"]:
        studio.choose("flat mode", mode)
        studio.until(lambda s: s["flat_mode"] == mode, f"flat mode {mode}")
        studio.settle()


def check_profile(studio):
    """The shape curve is dragged: one layer, one entry."""
    entries = len(studio.settle()["history"])
    studio.drag("shape handle 2", [(0.5, 0.5), (0.5, -1.5)])
    state = count_layers(studio, 3, "layer of the shape curve")
    assert source(state, 2)["operation"] == "shape"
    assert len(studio.settle()["history"]) <= entries + 2
    while len(studio.settle()["layers"]) == 3:
        studio.key("ctrl+z")


def check_compress(studio, folder):
    studio.click("tab/Compress")
    studio.click("compress")
    studio.until(lambda s: s["compressed"] >= 4, "compressions")
    state = studio.settle()
    studio.click("rate/0")
    shown = studio.until(lambda s: s["shown_compressed"] == 0, "chosen point")
    assert studio.settle()["brightness"] != state["brightness"]
    studio.screenshot("compress")
    studio.menu("file", "export blend")
    studio.in_file_dialog(folder, "made.kbm")
    studio.until(lambda s: (folder / "made.kbm").exists(), "exported blend")
    studio.click("compressed/none", u=0.05)
    studio.until(lambda s: s["shown_compressed"] == -1, "the map again")
    studio.click("tab/Layers")
    return shown


def write_ball(path, rings=24):
    """A mesh of a few hundred vertices, whose transport is ready soon."""
    points, faces = [(0, 1, 0)], []
    for i in range(1, rings):
        a = math.pi * i / rings
        points += [(math.sin(a) * math.cos(b), math.cos(a), math.sin(a) * math.sin(b))
                   for b in (math.pi * k / rings for k in range(2 * rings))]
    points.append((0, -1, 0))
    n, last = 2 * rings, len(points) - 1
    for k in range(n):
        m = (k + 1) % n
        faces += [(0, 1 + m, 1 + k), (last, last - n + k, last - n + m)]
        for i in range(rings - 2):
            u, v = 1 + i * n, 1 + (i + 1) * n
            faces += [(u + k, u + m, v + k), (u + m, v + m, v + k)]
    lines = ["ply", "format ascii 1.0", f"element vertex {len(points)}",
             *(f"property float {axis}" for axis in "xyz"), f"element face {len(faces)}",
             "property list uchar int vertex_indices", "end_header",
             *(" ".join(map(str, point)) for point in points),
             *(f"3 {a} {b} {c}" for a, b, c in faces)]
    path.write_text("\n".join(lines) + "\n")


def check_homogeneous(studio, folder):
    write_ball(folder / "ball.ply")
    studio.key("ctrl+o")
    studio.in_file_dialog(folder, "ball.ply")
    studio.until(lambda s: s["mesh"].endswith("ball.ply"), "another mesh")
    studio.click("tab/Material")
    before = studio.settle()
    studio.click("homogeneous", u=0.1)
    studio.until(lambda s: s["homogeneous"], "homogeneous material")
    studio.choose("measured", "Ketchup")
    # Once nothing moves the transport is computed; then pictures come from it.
    live = studio.until(lambda s: s.get("live") and s["settled"], "precomputed transport")
    assert live["brightness"] != before["brightness"]
    studio.drag("absorption, 1/mm/r", [(0.2, 0.5), (0.3, 0.5), (0.4, 0.5)])
    after = studio.settle()
    assert after["live"] and after["brightness"] != live["brightness"]
    studio.screenshot("homogeneous")
    update_ms = after["live_ms"]["project"] + after["live_ms"]["update"]
    studio.key("ctrl+z")
    assert abs(studio.settle()["brightness"] - live["brightness"]) < 0.01
    studio.click("homogeneous", u=0.1)
    studio.until(lambda s: not s["homogeneous"], "map again")
    studio.click("tab/Layers")
    return update_ms


def check_windows(studio):
    """No size of the window ends the program, and borders are dragged."""
    for width, height in [(1, 1), (300, 20), (40, 500), (WIDTH, HEIGHT)]:
        studio.xdotool("windowsize", studio.window, width, height)
        studio.until(lambda s: s["input"]["width"] == width and s["input"]["height"] == height,
                     f"window of {width} x {height}")
    before = studio.settle()["widgets"]["view"]
    studio.drag("split/map", [(0.5, 0.5), (-10, 0.5)])
    after = studio.settle()["widgets"]["view"]
    assert after[2] < before[2] - 20, (before, after)
    studio.key("F1")
    studio.key("F1")


def check_save(studio, folder):
    studio.key("ctrl+s")
    studio.in_file_dialog(folder, "made.json")
    studio.until(lambda s: (folder / "made.json").exists(), "saved recipe")
    recipe = json.loads((folder / "made.json").read_text())
    assert [layer["operation"] for layer in recipe["layers"]] == ["adjust", "blend"], recipe


def check_errors(studio, folder):
    (folder / "broken.ply").write_text("ply\nno")
    (folder / "broken.json").write_text('{"layers": [{"operation": "adjst"}]}')
    (folder / "broken.h5").write_bytes(b"\x89HDF\r\n\x1a\n" + bytes(50))
    layers = studio.state()["layers"]
    for name in ["no-such-file.h5", "broken.ply", "broken.h5", "broken.json"]:
        count = len(studio.state()["messages"])
        studio.key("ctrl+o")
        studio.in_file_dialog(folder, name)
        studio.until(lambda s: any(name in m for m in s["messages"][count:]), f"message on {name}")
    studio.screenshot("error")
    studio.click("notice/close")
    # All that was there still is.
    assert studio.settle()["layers"] == layers


def check_recipe(program, source_dir, folder):
    """What the window saved, the command line applies."""
    subprocess.run([program, "fit", source_dir / "data/stone-72x64.h5", "-o", folder / "map.h5",
                    "--quiet"], check=True)
    subprocess.run([program, "edit", folder / "map.h5", "--recipe", folder / "made.json", "-o",
                    folder / "edited.h5", "--quiet"], check=True)


def first_session(program, display, folder, figures):
    studio = Studio(program, display, folder, width=WIDTH, height=HEIGHT)
    try:
        figures["first_picture_s"] = studio.first_picture_s
        state = studio.settle()
        assert state["fine"] and state["refined"] == state["picture"] and state["mesh"] == "knot", state["mesh"]
        studio.screenshot("start")
        choose_draft(studio)
        check_orbit(studio)
        check_undo_of_light(studio)
        check_scribble(studio)
        state = check_range(studio)
        figures["edit_ms"] = state["edit_ms"]
        figures["edit_shown_ms"] = state["edit_shown_ms"]
        studio.screenshot("range")
        check_undo(studio)
        check_paint(studio)
        studio.screenshot("paint")
        check_brush_and_stamp(studio)
        check_layers(studio)
        check_second_material(studio, folder)
        check_modes(studio)
        check_profile(studio)
        check_compress(studio, folder)
        figures["homogeneous_update_ms"] = check_homogeneous(studio, folder)
        check_windows(studio)
        check_save(studio, folder)
        # One more edit, which no file holds when the program dies.
        studio.click("layer/0", u=0.3)
        studio.set_number("param/range_scale", "0.5")
        studio.until(lambda s: source(s, 0).get("range_scale") == 0.5, "unsaved edit")
        studio.settle()
        (kept,) = (folder / "state").glob("autosave-*.json")
        end = time.monotonic() + TIMEOUT
        while '"range_scale": 0.5' not in kept.read_text():
            assert time.monotonic() < end, "no autosave"
            time.sleep(0.05)
    finally:
        studio.stop()


def second_session(program, display, folder):
    """Recovers, meets broken files, and asks before it ends."""
    studio = Studio(program, display, folder, width=WIDTH, height=HEIGHT)
    try:
        assert studio.until(lambda s: True, "state")["recoverable"]
        studio.click("recover/yes")
        state = count_layers(studio, 2, "recovered layers")
        assert source(state, 0)["range_scale"] == 0.5
        studio.screenshot("recovered")
        choose_draft(studio)
        check_errors(studio, folder)
        studio.key("ctrl+q")
        studio.click("quit/no")
        studio.settle()
        studio.key("ctrl+q")
        assert studio.click_to_end("quit/yes") == 0
        assert not list((folder / "state").glob("autosave-*.json"))
    finally:
        studio.stop()


def third_session(program, display, folder):
    """Without what the renderer needs of the driver, and with files that are no good."""
    studio = Studio(program, display, folder, [folder / "broken.ply", folder / "no-such-file.h5"],
                    width=WIDTH, height=HEIGHT, env={"__EGL_VENDOR_LIBRARY_DIRS": "/nonexistent"})
    try:
        state = studio.message("pictures come from the processor")
        assert any("broken.ply" in m for m in state["messages"]), state["messages"]
        assert not state["recoverable"]
        assert studio.key_to_end("ctrl+q") == 0
    finally:
        studio.stop()


def write_layered_scene(source_dir, folder):
    scene = json.loads((source_dir / "examples/scenes/knot-layers.json").read_text())
    del scene["$schema"]
    scene["mesh"] = {"file": "ball.ply", "size_mm": 60}
    scene["lights"] += [
        {"type": "directional", "direction": [1, 1, 1], "irradiance": [0.5, 0.4, 0.3]},
        {"type": "point", "position": [-60, 60, 60], "intensity": [800, 1600, 3200]},
    ]
    (folder / "layered.json").write_text(json.dumps(scene))


def check_surface(studio):
    """Layers and lights of the scene are switched, and undone."""
    before = studio.settle()
    assert [layer["name"] for layer in before["surface"]] == ["jade", "red wax"], before["surface"]
    assert [light["kind"] for light in before["lights"]] == ["environment", "lamp", "point light"]
    studio.click("tab/Surface")
    studio.click("surface/0/on")
    studio.until(lambda s: not s["surface"][0]["enabled"], "layer that is off")
    after = studio.settle()
    assert abs(after["brightness"] - before["brightness"]) > 0.5, after["brightness"]
    studio.key("ctrl+z")
    studio.until(lambda s: s["surface"][0]["enabled"], "layer that is on again")
    assert abs(studio.settle()["brightness"] - before["brightness"]) < 0.01
    studio.key("ctrl+y")
    studio.until(lambda s: not s["surface"][0]["enabled"], "layer that is off again")
    studio.click("surface/1", u=0.3)
    studio.set_number("param/opacity", "0.5")
    studio.until(lambda s: s["surface"][1]["opacity"] == 0.5, "half a layer")
    studio.screenshot("surface")
    studio.click("tab/Light")
    studio.click("light/1", u=0.3)
    azimuth = studio.settle()["azimuth_deg"]
    studio.drag("view", [(0.5, 0.5), (0.6, 0.5)], button=3)
    assert studio.settle()["azimuth_deg"] != azimuth
    studio.click("light/2/on")
    studio.until(lambda s: not s["lights"][2]["enabled"], "point light that is off")
    studio.click("add light")
    studio.click("add light/lamp")
    studio.until(lambda s: len(s["lights"]) == 4, "another lamp")
    studio.screenshot("lights")


def fourth_session(program, display, source_dir, folder, figures):
    """A scene with layers: changed, saved, rendered by the command line, opened again."""
    write_layered_scene(source_dir, folder)
    studio = Studio(program, display, folder, [folder / "layered.json"], width=WIDTH, height=HEIGHT)
    try:
        studio.message("opened layered.json")
        studio.choose("still", "fine")
        studio.settle()
        studio.menu("file", "export picture")
        studio.in_file_dialog(folder, "before.png")
        choose_draft(studio)
        check_surface(studio)
        studio.choose("still", "fine")
        studio.until(lambda s: s["still"] == "fine", "fine pictures")
        saved = studio.settle()
        assert saved["fine"]
        studio.menu("file", "export picture")
        studio.in_file_dialog(folder, "after.png")
        studio.menu("file", "save scene as")
        studio.in_file_dialog(folder, "saved.json")
        studio.message("saved.json")
        studio.settle()
        for name in ["layered.json", "saved.json"]:
            count = len(studio.state()["messages"])
            studio.key("ctrl+o")
            studio.in_file_dialog(folder, name)
            studio.until(lambda s: any(f"opened {name}" in m for m in s["messages"][count:]), name)
        state = studio.settle()
        for key in ["surface", "lights", "homogeneous", "sigma_a"]:
            assert state[key] == saved[key], (key, state[key], saved[key])
        for key in ["yaw_deg", "distance_mm", "rotation_deg"]:
            assert abs(state[key] - saved[key]) < 1e-3, (key, state[key], saved[key])
        studio.key_to_end("ctrl+q")
    finally:
        studio.stop()
    scene = json.loads((folder / "saved.json").read_text())
    assert scene["mesh"] == {"file": "ball.ply", "size_mm": 60}, scene["mesh"]
    subprocess.run([program, "render", folder / "saved.json", "-o", folder / "rendered.png",
                    "--method", "splat", "--samples", "16000", "--quiet"], check=True)
    figures["rendered_difference"] = mean_difference(folder / "rendered.png", folder / "after.png")
    changed = mean_difference(folder / "before.png", folder / "after.png")
    assert figures["rendered_difference"] < 0.2 * changed, (figures, changed)


def main():
    figures = {}

    def run(program, source_dir, display, folder):
        first_session(program, display, folder, figures)
        second_session(program, display, folder)
        third_session(program, display, folder)
        fourth_session(program, display, source_dir, folder, figures)
        check_recipe(program, source_dir, folder)

    run_sessions(run, WIDTH, HEIGHT)
    for name, value in figures.items():
        print(f"{name}: {value:.3g}")


if __name__ == "__main__":
    main()
