"""Runs inside Blender (blender -b --python blender_jobs.py -- JOB.json): renders with Cycles, and
turns EXR pictures into NumPy arrays. compare writes the job; its lengths are mm, its axes Parian's.

Parian looks along -z with y up at the middle of an environment image, Cycles along +X with Z up:
X = -z, Y = -x, Z = y takes one to the other.
"""

import json
import math
import pathlib
import sys
import time

import bpy
import mathutils
import numpy

SUN_COLUMN = 0.66  # of the width; 0.5 is behind the mesh, 0.75 on its right


def to_blender(points):
    points = numpy.asarray(points, float).reshape(-1, 3)
    return numpy.stack([-points[:, 2], -points[:, 0], points[:, 1]], axis=1)


def read_image(path):
    """[row][column][RGBA], row 0 on top, linear."""
    image = bpy.data.images.load(path)
    image.colorspace_settings.name = "Non-Color"  # the numbers as they are
    width, height = image.size
    pixels = numpy.empty(width * height * 4, numpy.float32)
    image.pixels.foreach_get(pixels)
    bpy.data.images.remove(image)
    return pixels.reshape(height, width, 4)[::-1]


def write_environment(source, path):
    """The environment without negative values, which two renderers might treat differently, turned
    so that its brightest column is SUN_COLUMN."""
    pixels = numpy.maximum(read_image(source), 0)[::-1]
    height, width = pixels.shape[:2]
    brightest = int(pixels[..., :3].max(axis=(0, 2)).argmax())
    pixels = numpy.roll(pixels, int(SUN_COLUMN * width) - brightest, axis=1)
    image = bpy.data.images.new("environment", width, height, float_buffer=True)
    image.colorspace_settings.name = "Non-Color"
    image.pixels.foreach_set(numpy.ascontiguousarray(pixels).ravel())
    image.file_format = "OPEN_EXR"
    image.filepath_raw = path
    image.save()


def add_mesh(job):
    data = numpy.load(job["mesh"])
    points, triangles = to_blender(data["points"]), data["triangles"]
    mesh = bpy.data.meshes.new("mesh")
    mesh.vertices.add(len(points))
    mesh.vertices.foreach_set("co", points.ravel())
    mesh.loops.add(triangles.size)
    mesh.loops.foreach_set("vertex_index", triangles.ravel())
    mesh.polygons.add(len(triangles))
    mesh.polygons.foreach_set("loop_start", numpy.arange(0, triangles.size, 3))
    mesh.polygons.foreach_set("loop_total", numpy.full(len(triangles), 3))
    mesh.polygons.foreach_set("use_smooth", numpy.ones(len(triangles), bool))
    mesh.update(calc_edges=True)
    mesh.validate()
    thing = bpy.data.objects.new("mesh", mesh)
    bpy.context.collection.objects.link(thing)
    return mesh


def add_camera(job):
    position, target, up = (mathutils.Vector(to_blender(job["camera"][key])[0])
                            for key in ("position", "target", "up"))
    back = (position - target).normalized()
    right = up.cross(back).normalized()
    camera = bpy.data.cameras.new("camera")
    camera.sensor_fit = "VERTICAL"
    camera.angle_y = math.radians(job["camera"]["fov_deg"])
    camera.clip_end = 1e5
    thing = bpy.data.objects.new("camera", camera)
    thing.matrix_world = mathutils.Matrix.Translation(position) @ mathutils.Matrix(
        (right, back.cross(right), back)).transposed().to_4x4()
    bpy.context.collection.objects.link(thing)
    bpy.context.scene.camera = thing


def add_light(job):
    world = bpy.data.worlds.new("world")
    bpy.context.scene.world = world
    world.use_nodes = True
    background = world.node_tree.nodes["Background"]
    background.inputs["Color"].default_value = (0, 0, 0, 1)
    if "environment" in job:
        node = world.node_tree.nodes.new("ShaderNodeTexEnvironment")
        node.image = bpy.data.images.load(job["environment"])
        node.image.colorspace_settings.name = "Non-Color"
        world.node_tree.links.new(node.outputs["Color"], background.inputs["Color"])
    else:
        sun = bpy.data.lights.new("sun", "SUN")
        sun.energy, sun.angle = job["sun"]["irradiance"], 0
        thing = bpy.data.objects.new("sun", sun)
        direction = mathutils.Vector(to_blender(job["sun"]["direction"])[0])
        thing.rotation_euler = direction.to_track_quat("Z", "Y").to_euler()
        bpy.context.collection.objects.link(thing)


def add_materials(job):
    """One pure subsurface scattering material for each falloff: no reflection on top."""
    materials = {}
    for falloff, values in job["materials"].items():
        material = bpy.data.materials.new(falloff)
        material.use_nodes = True
        nodes = material.node_tree.nodes
        nodes.clear()
        scattering = nodes.new("ShaderNodeSubsurfaceScattering")
        scattering.falloff = falloff
        scattering.inputs["Color"].default_value = (*values["color"], 1)
        scattering.inputs["Radius"].default_value = values["radius_mm"]
        scattering.inputs["Scale"].default_value = 1
        output = nodes.new("ShaderNodeOutputMaterial")
        material.node_tree.links.new(scattering.outputs[0], output.inputs["Surface"])
        materials[falloff] = material
    return materials


def set_up(job):
    for thing in list(bpy.data.objects):
        bpy.data.objects.remove(thing)
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    scene.render.resolution_x, scene.render.resolution_y = job["size"]
    scene.render.resolution_percentage = 100
    scene.render.film_transparent = True
    scene.render.image_settings.file_format = "OPEN_EXR"
    scene.render.image_settings.color_mode = "RGBA"
    scene.render.image_settings.color_depth = "32"
    cycles = scene.cycles
    cycles.device = "CPU"
    cycles.use_adaptive_sampling = cycles.use_denoising = False
    cycles.pixel_filter_type, cycles.filter_width = "BOX", 1
    cycles.sample_clamp_direct = cycles.sample_clamp_indirect = 0
    # Light that falls on the surface from the lights alone, as in Parian: no interreflection.
    cycles.max_bounces = 0


def render(job, settings, materials, mesh):
    mesh.materials.clear()
    mesh.materials.append(materials[settings["falloff"]])
    scene = bpy.context.scene
    scene.cycles.samples, scene.cycles.seed = settings["samples"], settings["seed"]
    scene.render.filepath = settings["output"] + ".exr"
    start, cpu_start = time.perf_counter(), time.process_time()
    bpy.ops.render.render(write_still=True)
    times = time.perf_counter() - start, time.process_time() - cpu_start
    numpy.save(settings["output"] + ".npy", read_image(scene.render.filepath))
    return times


def main():
    job_path = pathlib.Path(sys.argv[sys.argv.index("--") + 1])
    job = json.loads(job_path.read_text())
    for source, path in job.get("environments", []):
        write_environment(source, path)
    for source, path in job.get("read", []):
        numpy.save(path, read_image(source))
    times = []
    if job.get("renders"):
        set_up(job)
        mesh = add_mesh(job)
        add_camera(job)
        add_light(job)
        materials = add_materials(job)
        for settings in job["renders"]:
            times.append(render(job, settings, materials, mesh))
    job_path.with_suffix(".times").write_text(json.dumps(times))


main()
