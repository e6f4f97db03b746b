#!/usr/bin/env python3
"""Selections, interpolated strokes, undo of the camera, and dropped files in the editor, driven by
mouse and keyboard under a virtual display.

usage: studio_selections_test.py PARIAN SOURCE_DIR [--keep FOLDER]
"""

import json
import subprocess

from studio_driver import Studio, run_sessions
from studio_test import choose_draft, count_layers, source, write_ball

WIDTH, HEIGHT = 1280, 800


def selection(state, layer=0):
    return source(state, layer).get("selection", {})


def until_type(studio, kind):
    studio.until(lambda s: s["layers"] and selection(s).get("type") == kind, kind)
    return studio.settle()  # its form is laid out


def choose_kind(studio, kind):
    studio.click("selection kind")
    studio.click(f"selection kind/{kind}", u=0.1)


def check_camera(studio):
    """Moves of the camera are one entry, until an edit."""
    start = studio.settle()
    for points in [(0.4, 0.5), (0.6, 0.45)], [(0.6, 0.5), (0.65, 0.7)]:
        studio.drag("view", points)
        studio.settle()
    studio.move(*studio.place("view"))
    for _ in range(4):
        studio.xdotool("click", 4)
    studio.until(lambda s: s["distance_mm"] < 0.7 * start["distance_mm"], "zoom")
    moved = studio.settle()
    assert len(moved["rows"]) == 1, moved["rows"]
    studio.key("ctrl+z")
    back = studio.until(lambda s: s["distance_mm"] == start["distance_mm"], "undone moves")
    assert back["yaw_deg"] == start["yaw_deg"]
    studio.key("ctrl+y")
    studio.until(lambda s: s["yaw_deg"] == moved["yaw_deg"], "redone moves")
    studio.key("ctrl+z")
    studio.settle()


def check_shapes(studio, folder):
    """The tool draws, the form changes the kind, handles and numbers change the shape."""
    studio.click("tool/select")
    studio.drag("flat", [(0.2, 0.3), (0.6, 0.7)])
    state = until_type(studio, "rectangle")
    studio.click("section/operation", u=0.3)  # closed: more room for the selection
    width, height = (0.5 * size for size in state["map_size"])  # half a mm a pixel
    low, high = selection(state)["min"], selection(state)["max"]
    assert abs(low[0] / width - 0.2) < 0.02 and abs(high[1] / height - 0.7) < 0.02, selection(state)
    area = studio.settle()["layers"][0]["selected"]
    assert abs(area - 0.16) < 0.02, area
    entries = len(state["history"])
    studio.drag("flat", [(0.6, 0.7), (0.7, 0.8), (0.8, 0.9)])
    state = studio.until(lambda s: s["layers"][0].get("selected", 0) > 2 * area, "dragged corner")
    assert selection(studio.settle())["min"] == low
    assert len(studio.settle()["history"]) == entries + 1, state["history"]
    studio.screenshot("rectangle")
    choose_kind(studio, "ellipse")
    until_type(studio, "ellipse")
    choose_kind(studio, "polygon")
    until_type(studio, "polygon")
    studio.drag("flat", [(0.3, 0.05), (0.95, 0.5), (0.5, 0.95), (0.05, 0.6)], steps=12)
    state = studio.until(lambda s: max(x for x, _ in selection(s)["points"]) > 0.9 * width,
                         "outline")
    assert len(selection(state)["points"]) == 4, selection(state)  # its corners alone
    assert 0.2 < studio.settle()["layers"][0]["selected"] < 0.6, state["layers"][0]["selected"]
    choose_kind(studio, "gradient")
    until_type(studio, "gradient")
    studio.drag("flat", [(0.1, 0.95), (0.1, 0.05)])
    studio.until(lambda s: selection(s)["to"][1] < 2 < selection(s)["from"][1], "drawn gradient")
    assert abs(studio.settle()["layers"][0]["selected"] - 0.5) < 0.1
    studio.screenshot("gradient")
    choose_kind(studio, "similar")
    until_type(studio, "similar")
    studio.click("flat", 0.3, 0.8)
    studio.until(lambda s: selection(s)["at"][1] > 0.7 * height, "picked pixel")
    choose_kind(studio, "image")
    studio.in_file_dialog(folder, "no-such-mask.exr")
    studio.message("no-such-mask.exr")
    studio.click("notice/close")
    assert selection(studio.settle())["type"] == "similar"
    choose_kind(studio, "image")
    studio.in_file_dialog(folder, "layer-01.exr")
    until_type(studio, "image")
    assert abs(studio.settle()["layers"][0]["selected"] - 0.25) < 0.02


def check_tree(studio):
    """Parts of sets: added, chosen, changed, taken out; each is an entry that is undone."""
    choose_kind(studio, "all")
    until_type(studio, "all")
    studio.click("add part")
    studio.click("add part/threshold", u=0.1)
    until_type(studio, "union")
    studio.click("part", u=0.1)
    studio.settle()
    choose_kind(studio, "difference")
    state = until_type(studio, "difference")
    assert [part["type"] for part in selection(state)["of"]] == ["all", "threshold"]
    studio.click("part/1", u=0.1)
    studio.until(lambda s: "param/property" in s["widgets"], "its form")
    studio.settle()
    studio.click("param/property", u=0.2)
    studio.click("param/property/lightness", u=0.2)
    studio.until(lambda s: selection(s)["of"][1]["property"] == "lightness", "another property")
    half = studio.settle()["layers"][0]["selected"]
    assert 0.02 < half < 0.98, half
    studio.drag("param/low", [(0.3, 0.5), (0.2, 0.5), (0.05, 0.5)])
    studio.until(lambda s: s["layers"][0].get("selected", 1) < 0.5 * half, "lower bound")
    studio.choose("flat mode", "selection")
    studio.settle()
    studio.screenshot("difference")
    studio.choose("flat mode", "albedo")
    studio.key("ctrl+z")
    studio.until(lambda s: abs(s["layers"][0].get("selected", 0) - half) < 1e-6, "undone drag")
    # What is drawn is one part more.
    studio.click("part", u=0.1)
    studio.drag("flat", [(0.1, 0.1), (0.3, 0.3)])
    studio.until(lambda s: len(selection(s)["of"]) == 3, "rectangle in the set")
    studio.settle()
    studio.click("part/2/earlier")
    studio.until(lambda s: selection(s)["of"][1]["type"] == "rectangle", "raised part")
    for count in (2, 1):
        studio.settle()
        studio.click("part/0/remove")
        studio.until(lambda s: len(selection(s)["of"]) == count, "fewer parts")
    studio.settle()
    studio.click("part/0/remove")
    studio.until(lambda s: "selection" not in source(s, 0), "no selection")
    studio.key("ctrl+z")
    until_type(studio, "difference")
    studio.leave_widgets()
    studio.key("Delete")
    count_layers(studio, 0, "no layers")


def check_interpolation(studio):
    """Strokes with parameters of their own."""
    studio.click("add layer")
    studio.click("add layer/interpolate", u=0.1)
    count_layers(studio, 1, "interpolation")
    studio.click("section/operation", u=0.3)  # open again
    studio.click("tool/scribble +")
    studio.drag("flat", [(0.15, 0.2), (0.25, 0.3)])
    studio.until(lambda s: len(source(s, 0)["strokes"]) == 2, "second stroke")
    studio.settle()
    studio.set_number("param/range_scale", "0.25")
    studio.until(lambda s: source(s, 0)["strokes"][1].get("range_scale") == 0.25, "its range")
    studio.click("stroke/0", u=0.2)
    studio.set_number("param/hue_deg", "120")
    state = studio.until(lambda s: source(s, 0)["strokes"][0].get("hue_deg") == 120, "its hue")
    assert "hue_deg" not in source(state, 0)["strokes"][1]
    studio.settle()
    studio.screenshot("interpolate")
    studio.click("stroke/0/remove")
    state = studio.until(lambda s: len(source(s, 0)["strokes"]) == 1, "one stroke")
    assert source(state, 0)["strokes"][0]["range_scale"] == 0.25
    studio.leave_widgets()
    studio.key("Delete")
    count_layers(studio, 0, "no layers")


def check_mesh_stroke(studio):
    """A stroke across the mesh, over its seams and gaps, is one entry."""
    studio.click("tool/brush")
    entries = len(studio.settle()["history"])
    studio.drag("view", [(0.1, 0.35), (0.9, 0.75)], steps=6)
    state = count_layers(studio, 1, "brushed layer")
    assert len(selection(state)["of"]) > 1, selection(state)
    assert len(studio.settle()["history"]) == entries + 1, state["history"]
    if not studio.state()["show_selection"]:
        studio.click("show selection", u=0.1)
    studio.settle()
    studio.screenshot("mesh-stroke")
    studio.key("ctrl+z")
    count_layers(studio, 0, "undone stroke")


def check_drops(studio, folder):
    """Files come from another program: one, several at once, and broken ones."""
    place = folder / "a folder" / "Kugel für 100 % é漢"
    place.mkdir(parents=True)
    write_ball(place / "ball & more.ply", rings=8)
    studio.drop(place / "ball & more.ply")
    studio.until(lambda s: s["mesh"] == str(place / "ball & more.ply"), "dropped mesh")
    (place / "broken.h5").write_bytes(b"\x89HDF\r\n\x1a\n" + bytes(50))
    studio.drop(place / "broken.h5", place / "gone.kbm")
    studio.message(f"{place}/broken.h5: expected")
    studio.message(f"{place}/gone.kbm: expected")
    assert studio.settle()["mesh"] == str(place / "ball & more.ply")
    # A recipe waits for the map that comes with it, in whatever order they lie.
    recipe = {"layers": [{"operation": "adjust", "range_scale": 0.5}]}
    (place / "recipe.json").write_text(json.dumps(recipe))
    studio.drop(place / "recipe.json", folder / "map.h5")
    state = studio.until(lambda s: s["material"] == str(folder / "map.h5") and len(s["layers"]) == 1,
                         "dropped map and recipe")
    assert source(state, 0)["range_scale"] == 0.5 and state["selected_layer"] == 0
    studio.settle()
    studio.screenshot("dropped")


def make_files(program, source_dir, folder):
    """A map, and a mask of a quarter of it."""
    subprocess.run([program, "fit", source_dir / "data/stone-72x64.h5", "-o", folder / "map.h5",
                    "--quiet"], check=True)
    box = {"type": "rectangle", "min": [0, 0], "max": [0.5, 0.5], "unit": "relative"}
    recipe = {"layers": [{"operation": "adjust", "selection": box}]}
    (folder / "mask.json").write_text(json.dumps(recipe))
    subprocess.run([program, "edit", folder / "map.h5", "--recipe", folder / "mask.json", "-o",
                    folder / "same.h5", "--masks", folder, "--quiet"], check=True)


def run(program, source_dir, display, folder):
    make_files(program, source_dir, folder)
    studio = Studio(program, display, folder, width=WIDTH, height=HEIGHT)
    try:
        choose_draft(studio)
        check_camera(studio)
        check_shapes(studio, folder)
        check_tree(studio)
        check_interpolation(studio)
        check_mesh_stroke(studio)
        check_drops(studio, folder)
    finally:
        studio.stop()


if __name__ == "__main__":
    run_sessions(run, WIDTH, HEIGHT)
