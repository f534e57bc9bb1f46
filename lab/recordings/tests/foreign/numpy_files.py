"""NPY and NPZ files as NumPy writes them, and the numbers that NumPy reads from them.

Usage: python numpy_files.py OUTDIR. Writes the files and expected.json: per file the names, the columns (floats as their repr)
and, where the file says so, units, sample rate and properties; or the part of the message with which it is to be refused.
"""

import json
import sys
import zipfile
from pathlib import Path

import numpy as np
from numpy.lib import format as npy

out = Path(sys.argv[1])
out.mkdir(parents=True, exist_ok=True)
expected = {}
rng = np.random.default_rng(21)
ROWS = 12


def texts(column):
    return [repr(float(v)) for v in column]


def save(name, array, version=None):
    with open(out / name, "wb") as file:
        npy.write_array(file, array, version=version)


def expect(name, columns, **said):
    expected[name] = {"names": list(columns), "columns": [texts(c) for c in columns.values()], **said}


def matrix(name, array, version=None):
    save(name, array, version)
    read = np.load(out / name)
    columns = read.reshape(len(read), -1).T
    expect(name, {f"column_{k + 1}": c for k, c in enumerate(columns)})


def refuse(name, array, message):
    np.save(out / name, array, allow_pickle=True)
    expected[name] = {"refused": message}


wave = rng.normal(size=(ROWS, 3)) * 10.0 ** rng.integers(-12, 12, size=(ROWS, 3))

# Every type in both byte orders, edges included.
for code in ["f2", "f4", "f8", "i1", "i2", "i4", "i8", "u1", "u2", "u4", "u8"]:
    kind = np.dtype(code)
    if kind.kind == "f":
        info = np.finfo(kind)
        edges = [0, -0.0, 1, -1.5, np.inf, -np.inf, np.nan, info.max, info.min, info.tiny, info.smallest_subnormal, 1 / 3]
    else:
        info = np.iinfo(kind)
        # Integers beyond 2**53 that f64 holds exactly.
        top = info.max if kind.itemsize < 8 else info.max // 2 + 1
        edges = [0, 1, 2, 3, 5, 7, top, top // 2, info.min, info.min // 2, info.min + info.min % 2, 100]
    values = np.array(edges).astype(kind).reshape(6, 2)
    for order, word in (("<", "little"), (">", "big")):
        if kind.itemsize > 1 or order == "<":
            matrix(f"{code}_{word}.npy", values.astype(order + code))
matrix("bool.npy", wave > 0)

# Shapes, orders, versions.
matrix("vector.npy", wave[:, 0].copy())
matrix("c_order.npy", wave)
matrix("fortran.npy", np.asfortranarray(wave))
matrix("fortran_big.npy", np.asfortranarray(wave.astype(">f4")))
matrix("version_2.npy", wave, (2, 0))
matrix("version_3.npy", wave, (3, 0))
matrix("one_row.npy", wave[:1])
matrix("wide.npy", wave.T.copy())

record = np.zeros(ROWS, dtype=[("t", "<f8"), ("label", "U3"), ("raw", ">i2"), ("acc", "<f4", (3,)), ("on", "?")])
record["t"] = np.arange(ROWS) / 50
record["raw"] = rng.integers(-32768, 32767, ROWS)
record["acc"] = wave
record["on"] = wave[:, 0] > 0
save("record.npy", record)
read = np.load(out / "record.npy")
columns = {"t": read["t"], "raw": read["raw"]}
columns |= {f"acc_{k + 1}": read["acc"][:, k] for k in range(3)}
expect("record.npy", columns | {"on": read["on"]})
aligned = np.zeros(ROWS, dtype=np.dtype([("a", "i1"), ("größe", "<f8")], align=True))
aligned["a"] = rng.integers(-128, 127, ROWS)
aligned["größe"] = wave[:, 1]
save("aligned.npy", aligned)
expect("aligned.npy", {"a": aligned["a"], "größe": aligned["größe"]})

refuse("objects.npy", np.array([1, "a", None], dtype=object), "Python objects")
refuse("complex.npy", wave + 1j, "complex")
refuse("dates.npy", np.array(["2024-01-01"], dtype="datetime64[s]"), "dates")
refuse("text.npy", np.array(["a", "b"]), "text")
refuse("cube.npy", np.zeros((2, 2, 2)), "3 dimensions")
refuse("scalar.npy", np.float64(1), "single value")
refuse("transposed.npy", np.zeros((1, 4097), dtype="u1"), "transpose")
refuse("inexact.npy", np.array([1, 2**53, 2**53 + 1]), "sample 2")

# NPZ: members carry the time of their writing, so they are written by hand with a fixed one, as numpy.savez does.
arrays = {
    "t": np.arange(ROWS) / 200,
    "u1": wave[:, 0].astype("<f4"),
    "counts": rng.integers(-1000, 1000, ROWS).astype(">i2"),
    "acc": wave,
    "gyro": np.asfortranarray(wave[:, ::-1]),
    "sample_rate_hz": np.float64(200),
    "title": np.array("drop, 3 µm"),
    "author": np.array(b"laboratory"),
    "gain": np.int16(12),
    "u1.unit": np.array("mV"),
    "stack": np.zeros((2, 2, 2)),
    "objects": np.array([None, 1], dtype=object),
}


def archive(name, arrays, compression, zip64=True):
    with zipfile.ZipFile(out / name, "w", compression) as file:
        for key, array in arrays.items():
            member = zipfile.ZipInfo(key + ".npy", (1980, 1, 1, 0, 0, 0))
            member.compress_type = compression
            with file.open(member, "w", force_zip64=zip64) as stream:
                npy.write_array(stream, np.asanyarray(array), allow_pickle=True)
    read = np.load(out / name)
    columns = {}
    for key in arrays:
        if key in ("stack", "objects") or read[key].ndim == 0:
            continue
        if read[key].ndim == 1:
            columns[key] = read[key]
        else:
            columns |= {f"{key}_{k + 1}": c for k, c in enumerate(read[key].T)}
    units = ["mV" if c == "u1" else None for c in columns]
    properties = {
        "sample_rate_hz": "200", "title": str(read["title"]), "author": read["author"].item().decode(), "gain": "12",
        "stack": "not read: an array of 3 dimensions", "objects": "not read: an array of Python objects",
    }
    expect(name, columns, units=units, rate=200.0, properties=properties)


archive("stored.npz", arrays, zipfile.ZIP_STORED)
archive("deflated.npz", arrays, zipfile.ZIP_DEFLATED)
archive("deflated_small.npz", arrays, zipfile.ZIP_DEFLATED, zip64=False)

(out / "expected.json").write_text(json.dumps(expected, sort_keys=True) + "\n")
