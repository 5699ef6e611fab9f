#!/usr/bin/env python3
"""Makes contours.poly from a real elevation grid: the Jacksboro fault, Tennessee, as shipped with matplotlib.

    pip download --no-deps matplotlib && unzip matplotlib-*.whl 'matplotlib/mpl-data/sample_data/*'
    python3 contours.py matplotlib/mpl-data/sample_data/jacksboro_fault_dem.npz > contours.poly

Marching squares: each contour runs from cell side to cell side, its ends where the elevation, linear along the side,
has the contour's height. The heights lie between whole meters and the elevations on them, so that no contour meets a
corner of a cell. Two contours in a cell do not cross, and rounding along the sides keeps their order.
"""

import ast
import math
import struct
import sys
import zipfile

STEP, FIRST = 75, 275.5
WIDTH, HEIGHT = 160, 160  # cells, from the north-west


def load(archive, name):
    """An integer array of a .npz, as rows."""
    data = zipfile.ZipFile(archive).read(name + ".npy")
    (length,) = struct.unpack("<H", data[8:10])
    header = ast.literal_eval(data[10 : 10 + length].decode())
    assert header["descr"] == "<i2" and not header["fortran_order"], header
    rows, columns = header["shape"]
    values = struct.unpack(f"<{rows * columns}h", data[10 + length :])
    return [values[r * columns : (r + 1) * columns] for r in range(rows)]


def main():
    rows = load(sys.argv[1], "elevation")
    side_y = 3 / 3600 * 111_195  # three seconds of arc, in meters
    side_x = side_y * math.cos(math.radians(36.59))
    height = min(HEIGHT, len(rows) - 1)
    width = min(WIDTH, len(rows[0]) - 1)
    numbers, points, segments = {}, [], []

    def number(a, b, level):
        """The point at this height between two grid corners."""
        key = (min(a, b), max(a, b), level)
        if key not in numbers:
            (r, c), (s, d) = key[:2]
            t = (level - rows[r][c]) / (rows[s][d] - rows[r][c])
            numbers[key] = len(points)
            points.append(((c + t * (d - c)) * side_x, -(r + t * (s - r)) * side_y))
        return numbers[key]

    for r in range(height):
        for c in range(width):
            corners = [(r, c), (r, c + 1), (r + 1, c + 1), (r + 1, c)]
            heights = [rows[i][j] for i, j in corners]
            lowest = FIRST + math.ceil((min(heights) - FIRST) / STEP) * STEP
            level = lowest
            while level < max(heights):
                above = [h > level for h in heights]
                sides = [k for k in range(4) if above[k] != above[(k + 1) % 4]]
                if len(sides) == 4 and (sum(heights) / 4 > level) != above[0]:
                    sides = sides[1:] + sides[:1]  # at a saddle the mean says which corners are joined
                for k, m in zip(sides[::2], sides[1::2]):
                    ends = [number(corners[i], corners[(i + 1) % 4], level) for i in (k, m)]
                    segments.append((ends, int(level)))
                level += STEP

    print("# Contours of the Jacksboro fault, every", STEP, "meters; x and y in meters; see README.md")
    print(len(points), "2 0 0")
    for i, (x, y) in enumerate(points, 1):
        print(i, f"{x:.1f} {y:.1f}")
    print(len(segments), 1, "# the marker is the height")
    for i, ((a, b), level) in enumerate(segments, 1):
        print(i, a + 1, b + 1, level)
    print(0)


main()
