"""Writes HDF5 files as h5py writes them, and what h5py reads from them."""

import json
import sys
from pathlib import Path

import h5py
import numpy as np

ROWS = 90
out = Path(sys.argv[1])
out.mkdir(parents=True, exist_ok=True)
rng = np.random.default_rng(11)
expected = {}
wave = (rng.normal(0, 1, (ROWS, 3)) * 10.0 ** rng.integers(-9, 9, (ROWS, 3))).astype(">f8")


def expect(name, columns, **more):
    columns = {key: [repr(float(v)) for v in values] for key, values in columns.items()}
    expected[name] = {"names": list(columns), "columns": list(columns.values()), **more}


# The oldest and the newest layout: groups, chunk indices and checksums differ.
for version in ("earliest", "latest"):
    path = out / f"{version}.h5"
    with h5py.File(path, "w", libver=version) as file:
        file.attrs["title"] = "drop, 3 µm"
        file.attrs["fs"] = 200.0
        file.attrs["list"] = [1, 2]
        shell = file.create_group("shell")
        for k in range(12):
            limit = {"maxshape": (None,)} if k % 2 else {}
            options = {"chunks": (13,), "compression": "gzip", "shuffle": True, "fletcher32": k > 5, **limit}
            shell.create_dataset(f"u{k}", data=wave[:, k % 3] * (k + 1), **options).attrs["units"] = "mV"
        file.create_dataset("counts", data=rng.integers(-1000, 1000, (ROWS, 3)).astype(">i2"), chunks=(7, 2), maxshape=(None, None))
        file.create_dataset("wide", data=rng.normal(0, 1, (2, ROWS)).astype("<f4"))
        file.create_dataset("on", data=wave[:, 0] > 0)
        file.create_dataset("note", data="Näherung")
        # Not plain numbers, or numbers that need more than reading.
        file.create_dataset("packed", data=np.arange(ROWS), dtype="<i2").attrs["scale_factor"] = 0.5
        file.create_dataset("pair", data=np.zeros(4, [("a", "f8"), ("b", "i4")]))
        file.create_dataset("half", data=np.arange(ROWS, dtype="<f2"))
        file.create_dataset("square", data=np.eye(4))
        file.create_dataset("cube", data=np.zeros((2, 3, 4)))
    with h5py.File(path) as file:
        columns = {}
        for name in ("counts", "on", "wide"):
            data = file[name][()]
            if data.ndim == 1:
                columns[name] = data
            else:
                columns |= {f"{name}_{k + 1}": c for k, c in enumerate(data.T if len(data) == ROWS else data)}
        at = list(columns).index("wide_1")
        shell = {f"shell/{name}": file["shell"][name][()] for name in file["shell"]}
        columns = dict(list(columns.items())[:at]) | shell | dict(list(columns.items())[at:])
    left_out = (
        "cube (of more than two dimensions), half (of unusual floats), packed (scaled by attributes), "
        "pair (complex or compound), square (4 x 4, square)"
    )
    expect(
        path.name,
        columns,
        units=["mV" if key in shell else None for key in columns],
        rate=200.0,
        properties={"fs": "200", "note": "Näherung", "title": "drop, 3 µm", "channels_left_out": left_out},
    )

# Samples that were never written are the fill value.
with h5py.File(out / "holes.h5", "w") as file:
    data = file.create_dataset("u", (ROWS,), "<f8", chunks=(10,), fillvalue=-1.5)
    data[20:45] = wave[20:45, 0]
    expect("holes.h5", {"u": data[()]})

with h5py.File(out / "lzf.h5", "w") as file:
    file.create_dataset("u", data=np.arange(400.0), compression="lzf")
expected["lzf.h5"] = {"refused": "lzf"}
# A type of 12 bits in 16, as converters have it, is not read as if it had 16.
with h5py.File(out / "twelve_bits.h5", "w") as file:
    kind = h5py.h5t.NATIVE_UINT16.copy()
    kind.set_precision(12)
    space = h5py.h5s.create_simple((8,))
    h5py.h5d.create(file.id, b"u", kind, space)
expected["twelve_bits.h5"] = {"refused": "u (of padded integers"}

(out / "expected.json").write_text(json.dumps(expected, sort_keys=True) + "\n")
