#!/usr/bin/env python3
"""Masks painted on the mesh, and the zoom of the flat map, driven by mouse and keyboard under a
virtual display.

usage: studio_mask_test.py PARIAN SOURCE_DIR [--keep FOLDER]
"""

import json
import subprocess

from png import mean_difference
from studio_driver import Studio, run_sessions
from studio_test import choose_draft, count_layers, source, write_ball, write_layered_scene

WIDTH, HEIGHT = 1280, 800


def painted(state, layer=0):
    return state["surface"][layer]["painted"]


def check_paint(studio):
    """From nothing, with the eraser, and back by undo."""
    studio.click("tab/Surface")
    studio.click("surface/0", u=0.3)
    studio.choose("mask", "painted")
    state = studio.until(lambda s: s["surface"][0]["mask"] == "painted" and s["tool"] == "mask",
                         "painted mask")
    assert painted(state) == 0
    bare = studio.settle()
    studio.screenshot("mask-nothing")
    studio.drag("view", [(0.35, 0.45), (0.5, 0.55), (0.65, 0.45)], steps=8)
    # A stroke becomes an entry once the button is up.
    studio.until(lambda s: s["rows"][-2:] == ["mask of jade", "mask of jade"], "two entries")
    first = studio.settle()
    assert 0.005 < painted(first) < 0.2, painted(first)
    assert abs(first["brightness"] - bare["brightness"]) > 0.2, first["brightness"]
    studio.drag("view", [(0.5, 0.3), (0.5, 0.7)], held="ctrl")
    erased = studio.settle()
    assert painted(erased) < painted(first)
    studio.key("ctrl+z")
    studio.until(lambda s: painted(s) == painted(first), "undone eraser")
    # A key while the button is down belongs to no stroke.
    studio.move(*studio.place("view", 0.6, 0.6))
    studio.press()
    studio.move(*studio.place("view", 0.5, 0.65))
    studio.key("ctrl+z")
    studio.key("5")
    studio.move(*studio.place("view", 0.4, 0.6))
    studio.release()
    studio.until(lambda s: len(s["rows"]) == len(first["rows"]) + 1, "another entry")
    radius = studio.settle()
    assert painted(radius) > painted(first) and radius["tool"] == "mask"
    studio.key("bracketright")
    studio.set_number("param/strength", "0.5")
    studio.key("m")
    studio.until(lambda s: s["show_selection"], "mask in red")
    assert studio.settle()["brightness"] != radius["brightness"]
    studio.screenshot("mask-red")
    studio.key("m")
    studio.set_number("param/radius_mm", "16")
    studio.set_number("param/strength", "1")
    studio.drag("view", [(0.4, 0.45), (0.6, 0.55)])
    return studio.settle()


def check_saved(program, studio, folder, state):
    """The scene that is saved is rendered as it is shown."""
    studio.choose("still", "fine")
    studio.settle()
    studio.menu("file", "export picture")
    studio.in_file_dialog(folder, "shown.png")
    studio.screenshot("mask-painted")
    # It is asked for before the program ends.
    studio.key("ctrl+q")
    studio.click("quit/no")
    studio.menu("file", "save scene as")
    studio.in_file_dialog(folder, "painted.json")
    studio.message("painted.json")
    scene = json.loads((folder / "painted.json").read_text())
    assert scene["layers"][0]["mask"][0] == {"type": "vertex", "file": "painted-mask-1.json"}, scene
    weights = json.loads((folder / "painted-mask-1.json").read_text())
    assert abs(sum(weights) / len(weights) - painted(state)) < 1e-6
    subprocess.run([program, "render", folder / "painted.json", "-o", folder / "rendered.png",
                    "--method", "splat", "--samples", "16000", "--quiet"], check=True)
    scene["layers"][0]["enabled"] = False
    (folder / "bare.json").write_text(json.dumps(scene))
    subprocess.run([program, "render", folder / "bare.json", "-o", folder / "bare.png",
                    "--method", "splat", "--samples", "16000", "--quiet"], check=True)
    same = mean_difference(folder / "rendered.png", folder / "shown.png")
    changed = mean_difference(folder / "rendered.png", folder / "bare.png")
    assert same < 0.2 * changed, (same, changed)
    studio.choose("still", "draft")


def center_of_stroke(state, layer=0):
    points = source(state, layer)["selection"]["of"][-1]["points"]
    return [sum(p[i] for p in points) / len(points) for i in (0, 1)]


def click_at(studio, place):
    """Where on the screen: the map's own places move under it."""
    studio.move(*place)
    studio.press()
    studio.release()


def check_zoom(studio):
    """Tools meet the same place of the map at any zoom."""
    studio.click("tab/Layers")
    studio.click("tool/brush")
    studio.click("flat", 0.7, 0.3)
    whole = center_of_stroke(count_layers(studio, 1, "brushed layer"))
    studio.settle()
    at = studio.place("flat", 0.7, 0.3)
    studio.move(*at)
    for _ in range(5):
        studio.xdotool("click", 4)
    studio.until(lambda s: s["flat_zoom"] > 2.9, "zoomed map")
    studio.settle()
    click_at(studio, at)
    state = studio.until(lambda s: len(source(s, 0)["selection"]["of"]) == 2, "second stroke")
    zoomed = center_of_stroke(state)
    pixel = 0.5
    assert abs(zoomed[0] - whole[0]) < pixel and abs(zoomed[1] - whole[1]) < pixel, (whole, zoomed)
    # What is panned by pixels of the screen is so on the map.
    width = state["widgets"]["flat"][2] - state["widgets"]["flat"][0]
    per_mm = state["flat_zoom"] * width / (state["map_size"][0] * pixel)
    studio.drag("flat", [(0.5, 0.5), (0.3, 0.4)], button=2)
    studio.settle()
    click_at(studio, at)
    state = studio.until(lambda s: len(source(s, 0)["selection"]["of"]) == 3, "third stroke")
    moved = center_of_stroke(state)
    assert abs((moved[0] - zoomed[0]) * per_mm - 0.2 * width) < 3, (moved, zoomed, per_mm)
    studio.settle()
    for _ in range(8):
        studio.xdotool("click", 4)
    studio.settle()
    studio.screenshot("zoomed")
    studio.click("flat fit")
    studio.until(lambda s: s["flat_zoom"] == 1, "all of the map")


def run(program, source_dir, display, folder):
    write_ball(folder / "ball.ply", rings=40)
    write_layered_scene(source_dir, folder)
    studio = Studio(program, display, folder, [folder / "layered.json"], width=WIDTH, height=HEIGHT)
    try:
        studio.message("opened layered.json")
        choose_draft(studio)
        studio.settle()
        state = check_paint(studio)
        check_saved(program, studio, folder, state)
        studio.click("tab/Material")
        studio.click("homogeneous", u=0.1)
        studio.until(lambda s: not s["homogeneous"], "the map")
        check_zoom(studio)
    finally:
        studio.stop()


if __name__ == "__main__":
    run_sessions(run, WIDTH, HEIGHT)
