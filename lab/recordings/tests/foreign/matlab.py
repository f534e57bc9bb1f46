"""MATLAB files by SciPy, hdf5storage and h5py (in MATLAB's manner), and what SciPy and h5py read from them.

    python matlab.py OUTDIR

For each file.mat a file.csv holds one line per channel, `name,first,second ...` with all digits, and one line per
property, `#name,value`. Files without a .csv are to be refused.
"""

import struct
import sys
from pathlib import Path

import h5py
import hdf5storage
import numpy as np
import scipy.io

ROWS = 60


def flatten(name, value, lines):
    """What is to be read of a variable, `value` as MATLAB has it: two dimensions."""
    if value.dtype.names:
        if value.size == 1:
            for field in value.dtype.names:
                flatten(f"{name}.{field}", np.asarray(value[field].item()), lines)
    elif value.dtype.kind == "U":
        if value.size <= 1:
            lines.append(f"#{name}," + "".join(value.ravel().tolist()))
    elif value.dtype.kind in "fiub" and value.ndim == 2 and value.size > 0:
        rows, columns = value.shape
        if value.size == 1:
            number = float(value.item())
            lines.append(f"#{name}," + (str(int(number)) if number.is_integer() else repr(number)))
        elif rows != columns:
            channels = value.T if rows > columns else value
            for index, channel in enumerate(channels, 1):
                own = name if len(channels) == 1 else f"{name}_{index}"
                lines.append(own + "," + ",".join(repr(float(v)) for v in channel))


def write(path, lines):
    path.with_suffix(".csv").write_text("\n".join(lines) + "\n", encoding="utf-8", newline="\n")


def expect_scipy(path):
    lines = []
    for name, value in scipy.io.loadmat(path).items():
        if not name.startswith("__"):
            flatten(name, value, lines)
    write(path, lines)


def expect_h5py(path):
    lines = []

    def walk(prefix, group):
        for name in group:
            item = group[name]
            kind = item.attrs.get("MATLAB_class", b"").decode()
            if name.startswith("#") or "MATLAB_empty" in item.attrs or "MATLAB_sparse" in item.attrs:
                continue
            if isinstance(item, h5py.Group):
                walk(f"{prefix}{name}.", item)
            elif kind == "char":
                text = np.atleast_2d(item[()].T).astype(np.uint16)[0].tobytes().decode("utf-16-le")
                lines.append(f"#{prefix}{name},{text}")
            else:
                value = item[()]
                flatten(prefix + name, value.reshape(-1, 1) if value.ndim < 2 else value.T, lines)

    with h5py.File(path) as file:
        walk("", file)
    write(path, lines)


def big_endian(path, name, values):
    """Version 5 as a big-endian machine wrote it: one column of doubles."""

    def element(kind, data):
        return struct.pack(">II", kind, len(data)) + data + bytes(-len(data) % 8)

    matrix = element(6, struct.pack(">II", 6, 0)) + element(5, struct.pack(">ii", len(values), 1))
    matrix += element(1, name.encode()) + element(9, values.astype(">f8").tobytes())
    text = b"MATLAB 5.0 MAT-file, by hand".ljust(124)
    path.write_bytes(text + struct.pack(">H", 0x0100) + b"MI" + element(14, matrix))


def matlab73(path, packed):
    """In MATLAB's manner: user block, dimensions reversed, attributes."""
    rows = 40
    time = np.arange(rows) / 1000.0
    random = np.random.default_rng(7)

    def dataset(group, name, value, kind, **storage):
        made = group.create_dataset(name, data=np.ascontiguousarray(np.atleast_2d(value).T), **storage)
        made.attrs["MATLAB_class"] = np.bytes_(kind)
        return made

    def chunks(*shape, **options):
        return {"chunks": shape, "compression": "gzip", **options} if packed else {}

    with h5py.File(path, "w", userblock_size=512, libver=("earliest", "v108")) as file:
        dataset(file, "t", time[:, None], "double", **chunks(1, 13))
        dataset(file, "u", random.normal(0, 1, (rows, 3)).round(3), "double", **chunks(2, 30, shuffle=True, fletcher32=True))
        dataset(file, "across", random.integers(-9, 9, (2, 60)).astype(np.int16), "int16", **chunks(50, 2))
        dataset(file, "row", time[None, :30].astype(np.float32), "single")
        dataset(file, "flag", (time[:, None] > 0.1).astype(np.uint8), "logical").attrs["MATLAB_int_decode"] = np.int32(1)
        dataset(file, "fs", [[1000.0]], "double")
        dataset(file, "square", np.eye(4), "double")
        dataset(file, "note", np.array([[ord(c) for c in "Näherung µ"]], np.uint16), "char")
        empty = file.create_dataset("nothing", data=np.array([0, 0], np.uint64))
        empty.attrs["MATLAB_class"] = np.bytes_("double")
        empty.attrs["MATLAB_empty"] = np.uint8(1)
        group = file.create_group("data")
        group.attrs["MATLAB_class"] = np.bytes_("struct")
        dataset(group, "u1", np.sin(time)[:, None].round(4), "double")
        dataset(group, "fs", [[250.5]], "double")
        refs = file.create_group("#refs#")
        dataset(refs, "a", [[1.0, 2.0]], "double")
        cell = file.create_dataset("c", data=np.array([[refs["a"].ref]], dtype=h5py.ref_dtype))
        cell.attrs["MATLAB_class"] = np.bytes_("cell")
    head = b"MATLAB 7.3 MAT-file, in MATLAB's manner".ljust(116) + bytes(8) + struct.pack("<H", 0x0200) + b"IM"
    with open(path, "r+b") as file:
        file.write(head)


def main(folder):
    folder.mkdir(parents=True, exist_ok=True)
    random = np.random.default_rng(5)
    time = np.arange(ROWS) / 1000.0
    wave = (np.sin(2 * np.pi * 37 * time) * 5 + random.normal(0, 1e-3, ROWS)).round(4)

    signals = {
        "t": time[:, None],
        "u1": wave[None, :],
        "m": np.column_stack([wave, np.arange(ROWS) % 11, time])[:40],
        "across": np.arange(60).reshape(2, 30).astype(np.int16),
        "fs": 1000.0,
        "note": "Kanal eins",
        "square": np.eye(3),
        "single": wave[:50].astype(np.float32)[:, None],
        "flag": (wave > 0)[:, None],
        "odd": np.array([[np.nan, np.inf, -np.inf, 5e-324, 1.7976931348623157e308]]),
        "z": np.array([[1 + 2j, 3]]),
        "cells": np.array([[1, "x"]], dtype=object),
        "cube": np.zeros((2, 3, 4)),
        "empty": np.zeros((0, 0)),
        "data": {"u2": wave[:40, None], "fs": 512.0, "inner": {"v": np.arange(5.0)[:, None], "who": "me"}},
    }
    for name in ["int8", "uint8", "int16", "uint16", "int32", "uint32", "int64", "uint64"]:
        info = np.iinfo(name)
        signals[name] = np.array([[info.min, 0, 1, info.max]], dtype=name)
    for name, packed in [("v6", False), ("v7", True)]:
        path = folder / f"{name}.mat"
        scipy.io.savemat(path, signals if packed else {k: signals[k] for k in signals if k != "m"}, do_compression=packed)
        # SciPy writes the time of day into the header's text.
        with open(path, "r+b") as file:
            file.write(b"MATLAB 5.0 MAT-file".ljust(116))
        expect_scipy(path)
    big_endian(folder / "big_endian.mat", "u", wave[:30])
    expect_scipy(folder / "big_endian.mat")

    scipy.io.savemat(folder / "cells_only.mat", {"c": np.array([[1, "x"]], dtype=object)}, do_compression=True)
    with open(folder / "cells_only.mat", "r+b") as file:
        file.write(b"MATLAB 5.0 MAT-file".ljust(116))
    scipy.io.savemat(folder / "v4.mat", {"u": wave[:20]}, format="4")

    for name, packed in [("v73_plain", False), ("v73_packed", True)]:
        path = folder / f"{name}.mat"
        matlab73(path, packed)
        expect_h5py(path)
    # One sample to a chunk makes a tree of two levels.
    path = folder / "v73_tree.mat"
    with h5py.File(path, "w") as file:
        file.create_dataset("u", data=np.arange(66.0)[None, :] / 8, chunks=(1, 1))
    expect_h5py(path)
    path = folder / "hdf5storage.mat"
    path.unlink(missing_ok=True)
    hdf5storage.savemat(
        str(path),
        {"t": time[:30, None], "u": signals["m"][:30, :2], "fs": 1000.0, "data": {"u1": wave[:50, None]}},
        format="7.3",
        store_python_metadata=False,
        action_for_matlab_incompatible="discard",
    )
    with open(path, "r+b") as file:
        file.write(b"MATLAB 7.3 MAT-file".ljust(116))
    expect_h5py(path)
    with h5py.File(folder / "latest.mat", "w", libver="latest") as file:
        file.create_dataset("u", data=wave[:30], chunks=(10,), compression="gzip")


if __name__ == "__main__":
    main(Path(sys.argv[1]))
