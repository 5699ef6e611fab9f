#!/usr/bin/env python3
"""Makes the small classics: a_letter.poly, box.poly, spiral.poly, face.poly. Own work, public domain.

    python3 classics.py
"""

import math


def write(name, comment, loops, holes=(), regions=(), lines=(), first=1):
    """Closed loops and open lines of points; equal points are one."""
    numbers, points, segments = {}, [], []

    def number(p):
        if p not in numbers:
            numbers[p] = len(points) + first
            points.append(p)
        return numbers[p]

    for marker, loop in enumerate(loops, 1):
        segments += [(number(a), number(b), marker) for a, b in zip(loop, loop[1:] + loop[:1])]
    for line in lines:
        segments += [(number(a), number(b), 99) for a, b in zip(line, line[1:])]
    with open(name, "w") as f:
        print("#", comment, file=f)
        print(len(points), "2 0 0", file=f)
        for i, (x, y) in enumerate(points, first):
            print(i, f"{x:g} {y:g}", file=f)
        print(len(segments), 1, file=f)
        for i, segment in enumerate(segments, first):
            print(i, *segment, file=f)
        print(len(holes), file=f)
        for i, (x, y) in enumerate(holes, first):
            print(i, f"{x:g} {y:g}", file=f)
        if regions:
            print(len(regions), file=f)
            for i, region in enumerate(regions, first):
                print(i, *region, file=f)


def ring(x, y, rx, ry, n, start=0.0, end=2 * math.pi):
    """Points on an arc, rounded to four digits so that the file is the same everywhere."""
    steps = [start + (end - start) * i / n for i in range(n)]
    return [(round(x + rx * math.cos(a), 4), round(y + ry * math.sin(a), 4)) for a in steps]


def spiral():
    arms = [[], []]
    for i in range(181):
        a = math.radians(7.5 * i)
        for arm, r in zip(arms, (1 + a, 2.2 + a)):
            arm.append((round(r * math.cos(a), 4), round(r * math.sin(a), 4)))
    return arms[0] + arms[1][::-1]


write(
    "a_letter.poly",
    "The letter A, slanted, with its hole",
    [
        [(0, 0), (1.5, 0), (2.25, 2.25), (5.25, 2.25), (6, 0), (7.5, 0), (4.75, 8), (3.25, 8)],
        [(2.7, 3.6), (4.8, 3.6), (3.75, 6.75)],
    ],
    holes=[(3.75, 4.5)],
)
write(
    "box.poly",
    "A box with two square holes and a bar between them; two regions. Counted from 0",
    [
        [(0, 0), (8, 0), (8, 4), (0, 4)],
        [(1, 1), (3, 1), (3, 3), (1, 3)],
        [(5, 1), (7, 1), (7, 3), (5, 3)],
    ],
    holes=[(2, 2), (6, 2)],
    regions=[(0.5, 0.5, 1, 0.1), (7.5, 0.5, 2, 0.3)],
    lines=[[(4, 0), (4, 4)]],
    first=0,
)
write("spiral.poly", "A spiral band, four times round", [spiral()])
write(
    "face.poly",
    "A face: eyes and mouth are holes",
    [
        ring(0, 0, 10, 11, 72),
        ring(-3.8, 3.4, 1.5, 1.0, 24),
        ring(3.8, 3.4, 1.5, 1.0, 24),
        ring(0, -2.2, 6, 4.6, 28, math.pi, 2 * math.pi) + ring(0, -2.2, 6, 2.4, 28, 2 * math.pi, math.pi),
    ],
    holes=[(-3.8, 3.4), (3.8, 3.4), (0, -5.6)],
    lines=[[(0, 2.6), (-1.2, -1), (0.6, -1.2)], [(-6, 6), (-4, 6.7), (-2.2, 6.2)], [(2.2, 6.2), (4, 6.7), (6, 6)]],
)
