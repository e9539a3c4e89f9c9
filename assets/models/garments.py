#!/usr/bin/env python3
"""Writes garments.glb, a small model as Blender would write it, for the test and the example `gltf`.

    Wardrobe                  a transform, nothing else
    |- Banner                 a square metre, scaled to 2 m x 1.5 m: canvas, hung by its top edge, tearable
    |- Mirrored               the same mesh, mirrored by a scale of -1 along x; pinned where it is red
    |- Tunic                  two primitives of different fabric (by their materials), pinned by an attribute
    |- Crate                  no cloth
    `- Misspelt               a fabric and a key that do not exist

Only the standard library is used: python3 assets/models/garments.py
"""

import json
import math
import struct
from pathlib import Path

FLOAT, UNSIGNED_SHORT, UNSIGNED_BYTE = 5126, 5123, 5121
CELLS = 12

buffer = bytearray()
views, accessors = [], []


def accessor(rows, kind, component=FLOAT, target=34962, **more):
    """Adds rows of numbers to the buffer; returns the number of the accessor."""
    while len(buffer) % 4:
        buffer.append(0)
    form = {FLOAT: "f", UNSIGNED_SHORT: "H", UNSIGNED_BYTE: "B"}[component]
    start = len(buffer)
    for row in rows:
        buffer.extend(struct.pack(f"<{len(row)}{form}", *row))
    views.append({"buffer": 0, "byteOffset": start, "byteLength": len(buffer) - start, "target": target})
    entry = {"bufferView": len(views) - 1, "componentType": component, "count": len(rows), "type": kind, **more}
    accessors.append(entry)
    return len(accessors) - 1


def sheet(place, painted=()):
    """A sheet of CELLS x CELLS quads, `place` giving a position for u and v in 0..1, v running down."""
    places = [(i / CELLS, j / CELLS) for j in range(CELLS + 1) for i in range(CELLS + 1)]
    positions = [place(u, v) for u, v in places]
    low, high = [[f(p[k] for p in positions) for k in range(3)] for f in (min, max)]
    attributes = {
        "POSITION": accessor(positions, "VEC3", min=low, max=high),
        "TEXCOORD_0": accessor(places, "VEC2"),
        "TEXCOORD_1": accessor([(v, u) for u, v in places], "VEC2"),
    }
    if "color" in painted:
        # Red in the two upper corners.
        red = [1.0 if v == 0 and u in (0, 1) else 0.0 for u, v in places]
        attributes["COLOR_0"] = accessor([(r, 0.2, 0.2, 1.0) for r in red], "VEC4")
    if "pin" in painted:
        attributes["_CLOTH_PIN"] = accessor([(1.0 if v == 0 else 0.0,) for u, v in places], "SCALAR")
    corner = lambda i, j: j * (CELLS + 1) + i
    indices = []
    for j in range(CELLS):
        for i in range(CELLS):
            a, b, c, d = corner(i, j), corner(i + 1, j), corner(i, j + 1), corner(i + 1, j + 1)
            indices += [(a,), (c,), (b,), (b,), (c,), (d,)]
    return {"attributes": attributes, "indices": accessor(indices, "SCALAR", UNSIGNED_SHORT, 34963)}


def flat(u, v):
    return (u - 0.5, 0.5 - v, 0.0)


def half_tube(turn):
    def place(u, v):
        angle = turn + math.pi * u
        return (-0.25 * math.cos(angle), 0.4 - 0.8 * v, 0.25 * math.sin(angle))
    return place


def box():
    corners = [(x, y, z) for x in (-0.2, 0.2) for y in (-0.2, 0.2) for z in (-0.2, 0.2)]
    faces = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    indices = [(k,) for a, b, c, d in faces for k in (a, b, c, a, c, d)]
    position = accessor(corners, "VEC3", min=[-0.2] * 3, max=[0.2] * 3)
    return {"attributes": {"POSITION": position}, "indices": accessor(indices, "SCALAR", UNSIGNED_SHORT, 34963)}


def material(name, colour, **extras):
    entry = {"name": name, "doubleSided": True, "pbrMetallicRoughness": {
        "baseColorFactor": [*colour, 1.0], "metallicFactor": 0.0, "roughnessFactor": 0.9}}
    return {**entry, "extras": extras} if extras else entry


materials = [
    material("Red", (0.6, 0.1, 0.1)),
    material("Front", (0.2, 0.3, 0.6), cloth="Wool suiting"),
    material("Back", (0.8, 0.75, 0.6), cloth="Cotton jersey"),
    material("Wood", (0.4, 0.25, 0.1)),
]
meshes = [
    {"name": "Square", "primitives": [{**sheet(flat, ("color",)), "material": 0}]},
    {"name": "Tunic", "extras": {"cloth_pins": "attribute"}, "primitives": [
        {**sheet(half_tube(0.0), ("pin",)), "material": 1},
        {**sheet(half_tube(math.pi), ("pin",)), "material": 2},
    ]},
    {"name": "Box", "primitives": [{**box(), "material": 3}]},
]
half = math.sqrt(0.5)
nodes = [
    {"name": "Wardrobe", "translation": [0, 1.5, 0], "rotation": [0, half, 0, half], "children": [1, 2, 3, 4, 5]},
    {"name": "Banner", "mesh": 0, "translation": [-2, 0, 0], "scale": [2, 1.5, 1],
     "extras": {"cloth": "Canvas", "cloth_pins": "top", "cloth_strength": 0.05}},
    {"name": "Mirrored", "mesh": 0, "translation": [0, 0, 0], "scale": [-1, 1, 1],
     "extras": {"cloth": True, "cloth_pins": "color", "cloth_burns": 1, "cloth_air": False}},
    {"name": "Tunic", "mesh": 1, "translation": [1.5, 0, 0]},
    {"name": "Crate", "mesh": 2, "translation": [3, 0, 0], "extras": {"price": 3}},
    {"name": "Misspelt", "mesh": 0, "translation": [4, 0, 0], "extras": {"cloth": "Cottn", "cloth_pinz": 3}},
]
document = {
    "asset": {"version": "2.0", "generator": "garments.py"},
    "scene": 0,
    "scenes": [{"name": "Scene", "nodes": [0]}],
    "nodes": nodes,
    "meshes": meshes,
    "materials": materials,
    "accessors": accessors,
    "bufferViews": views,
    "buffers": [{"byteLength": len(buffer)}],
}


def chunk(kind, data, filler):
    data = bytes(data) + filler * (-len(data) % 4)
    return struct.pack("<I4s", len(data), kind) + data


document["buffers"][0]["byteLength"] = len(buffer)
body = chunk(b"JSON", json.dumps(document).encode(), b" ") + chunk(b"BIN\0", buffer, b"\0")
Path(__file__).with_suffix(".glb").write_bytes(struct.pack("<4sII", b"glTF", 2, 12 + len(body)) + body)
