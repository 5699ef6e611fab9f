#!/usr/bin/env python3
"""Makes coast.poly from the npm package world-atlas (Natural Earth, public domain).

    npm pack world-atlas@2.0.2 && tar xzf world-atlas-2.0.2.tgz
    python3 natural_earth.py package/countries-10m.json > coast.poly

TopoJSON stores each line that two countries share once, so that borders are shared edges here too. Kept is what lies
whole inside a box around the North Sea. x is the longitude times the cosine of the box's middle latitude, y the
latitude, both in degrees: distances are true along the middle.
"""

import json
import math
import sys

WEST, EAST, SOUTH, NORTH = -6.2, 12.6, 49.3, 58.8


def main():
    topology = json.load(open(sys.argv[1]))
    scale, translate = topology["transform"]["scale"], topology["transform"]["translate"]
    squeeze = math.cos(math.radians((SOUTH + NORTH) / 2))
    numbers, points, segments = {}, [], set()

    def number(p):
        """Points equal on the quantized grid are one."""
        if p not in numbers:
            lon, lat = (p[k] * scale[k] + translate[k] for k in (0, 1))
            numbers[p] = len(points)
            points.append((lon * squeeze, lat))
        return numbers[p]

    def inside(p):
        lon, lat = (p[k] * scale[k] + translate[k] for k in (0, 1))
        return WEST <= lon <= EAST and SOUTH <= lat <= NORTH

    def crosses(a, b, c, d):
        side = lambda p, q, r: (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0])
        return side(a, b, c) * side(a, b, d) < 0 and side(c, d, a) * side(c, d, b) < 0

    for arc in topology["arcs"]:
        x = y = 0
        line = []
        for dx, dy in arc:
            x, y = x + dx, y + dy
            line.append((x, y))
        # Rounding to the grid has tied one knot: a line that crosses itself two steps later. It is cut off.
        for i in range(len(line) - 4, -1, -1):
            if crosses(*line[i : i + 4]):
                del line[i + 2]
        for a, b in zip(line, line[1:]):
            if a != b and inside(a) and inside(b):
                segments.add(tuple(sorted((number(a), number(b)))))

    print("# Coasts and borders around the North Sea. Made with Natural Earth, public domain; see README.md")
    print(len(points), "2 0 0")
    for i, (x, y) in enumerate(points):
        print(i, f"{x:.4f} {y:.4f}")
    print(len(segments), 0)
    for i, (a, b) in enumerate(sorted(segments)):
        print(i, a, b)
    print(0)


main()
