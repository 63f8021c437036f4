# SPDX-License-Identifier: Apache-2.0
# Reads a recording as a user of h5py does, without options, and holds it against the text of the same run.
#   python3 read_recording.py FOLDER ROLE
import csv
import sys

import h5py

folder, role = sys.argv[1:]
rows = list(csv.DictReader(open(f"{folder}/{role}.csv")))
with h5py.File(f"{folder}/{role}.h5", "r") as file:
    assert file.attrs["format"].decode() == "telekerf-run"
    group = file[role]
    tool, tick, time = group["tool"], group["tick"], group["time"]
    assert tool.shape == (len(rows), 3) and tool.dtype == "float64" and tick.dtype == "uint64"
    assert tool.attrs["units"].decode() == "m" and tool.attrs["axes"].decode() == "x y z"
    assert tool.attrs["frame"].decode().endswith("workpiece")
    assert sorted(tool.dims[0].keys()) == ["tick", "time"], "dimension scales"
    assert time.attrs["units"].decode() == "s"
    for n, row in enumerate(rows):
        assert tick[n] == int(row["tick"])
        if n % 97 == 0:
            assert [float(row[f"tool_{axis}_m"]) for axis in "xyz"] == list(tool[n])
    assert len(file["contours/points"]) == file["contours/list/count"][:].sum() > 100
print(role, len(rows), "rows")
