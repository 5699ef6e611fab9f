"""Turns the full-resolution coastlines of Debian's package gmt-gshhg-full into one .pslg file.

    apt-get download gmt-gshhg-full && dpkg -x gmt-gshhg-full_*.deb gshhg
    pip install netCDF4
    python3 benches/coastlines.py gshhg/usr/share/gmt-gshhg/binned_GSHHS_f.nc coastlines.pslg

The file holds polylines cut at the borders of bins of one degree, each point as two 16-bit fractions of its bin.
Coordinates of the output are whole 65535ths of a degree, so that points on a border between bins meet exactly.
Points that are equal are written once; constraints keep their number, less those that have no length.

The coastlines cross themselves here and there. To leave out the second segment of each pair that crosses:

    polder triangulate coastlines.pslg -o coastlines.tri --error-format json 2> crossings.json
    python3 benches/coastlines.py gshhg/usr/share/gmt-gshhg/binned_GSHHS_f.nc coastlines.pslg crossings.json
"""

import json
import sys

import netCDF4
import numpy as np


def main(source: str, target: str, crossings: str | None = None) -> None:
    data = netCDF4.Dataset(source)
    data.set_auto_mask(False)

    def read(name: str) -> np.ndarray:
        return np.asarray(data.variables[name][:])

    per_row = int(read("N_bins_in_360_longitude_range")[0])
    rows = int(read("N_bins_in_180_degree_latitude_range")[0])
    first_segment = read("Id_of_first_segment_in_a_bin")
    segments_in_bin = read("N_segments_in_a_bin").astype(np.int64)
    lengths = read("Embedded_npts_levels_exit_entry_for_a_segment") >> 9
    starts = read("Id_of_first_point_in_a_segment").astype(np.int64)
    dx = read("Relative_longitude_from_SW_corner_of_bin").astype(np.uint16).astype(np.int64)
    dy = read("Relative_latitude_from_SW_corner_of_bin").astype(np.uint16).astype(np.int64)

    bin_of_segment = np.empty(len(lengths), np.int64)
    for i, (first, count) in enumerate(zip(first_segment, segments_in_bin)):
        bin_of_segment[first : first + count] = i
    segment_of_point = np.repeat(np.arange(len(lengths)), lengths)
    order = np.concatenate([np.arange(s, s + n) for s, n in zip(starts, lengths)])
    assert (order == np.arange(len(dx))).all(), "segments do not follow each other"

    bins = bin_of_segment[segment_of_point]
    x = bins % per_row * 65535 + dx
    y = (rows - 1 - bins // per_row) * 65535 + dy
    keys, index = np.unique(y << 32 | x, return_inverse=True)
    # Number the points in the order of their first appearance, as a file of coastlines would.
    first = np.full(len(keys), len(x))
    np.minimum.at(first, index, np.arange(len(x)))
    rank = np.empty(len(keys), np.int64)
    by_appearance = np.argsort(first)
    rank[by_appearance] = np.arange(len(keys))
    ids = rank[index]
    points = np.stack([x, y], axis=1)[first[by_appearance]].astype("<f8")

    same = segment_of_point[1:] == segment_of_point[:-1]
    constraints = np.stack([ids[:-1], ids[1:]], axis=1)[same]
    constraints = constraints[constraints[:, 0] != constraints[:, 1]].astype("<u4")
    if crossings is not None:
        with open(crossings) as lines:
            error = json.loads(lines.readlines()[-1])
        # Pairs count segments from the first number that the file's format has, 0 for .pslg.
        second = np.array([pair[1] for pair in error["pairs"]]) - error["first"]
        constraints = np.delete(constraints, second, axis=0)
    with open(target, "wb") as out:
        out.write(np.array([len(points), len(constraints)], "<u8").tobytes())
        out.write(points.tobytes())
        out.write(constraints.tobytes())
    print(f"{len(points)} points, {len(constraints)} constraints")


if __name__ == "__main__":
    main(*sys.argv[1:])
