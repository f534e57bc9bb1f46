"""Parquet files by pyarrow and pandas, and what pyarrow reads from them.

    python parquet.py OUTDIR

For each file.parquet a file.csv holds the expected channels: headings, then one row per sample with all digits.
Files without a .csv are to be refused.
"""

import sys
from pathlib import Path

import numpy as np
import pandas as pd
import pyarrow as pa
import pyarrow.parquet as pq

ROWS = 300


def expect(path, columns=None):
    """Writes what pyarrow's reader returns: time stamps in seconds since the first, booleans as 0 and 1."""
    table = pq.read_table(path)
    names = columns or table.column_names
    values = []
    for name in names:
        column = table.column(name).combine_chunks()
        kind = column.type
        if pa.types.is_timestamp(kind):
            ns = column.cast(pa.timestamp("ns", kind.tz)).cast(pa.int64()).to_pylist()
            values.append([(n - ns[0]) / 1e9 for n in ns])
        elif pa.types.is_duration(kind):
            per_second = {"s": 1e0, "ms": 1e3, "us": 1e6, "ns": 1e9}[kind.unit]
            values.append([n / per_second for n in column.cast(pa.int64()).to_pylist()])
        elif pa.types.is_time(kind):
            per_second = {"ms": 1e3, "us": 1e6, "ns": 1e9}[kind.unit]
            integer = pa.int32() if kind.unit == "ms" else pa.int64()
            values.append([n / per_second for n in column.cast(integer).to_pylist()])
        else:
            values.append([float(v) for v in column.to_pylist()])
    with open(path.with_suffix(".csv"), "w", newline="\n") as out:
        out.write(",".join(names) + "\n")
        for row in zip(*values):
            out.write(",".join(repr(v) for v in row) + "\n")


def main(folder):
    folder.mkdir(parents=True, exist_ok=True)
    random = np.random.default_rng(6)
    time = np.arange(ROWS) / 1000.0
    wave = np.sin(2 * np.pi * 37 * time) * 5 + random.normal(0, 1e-3, ROWS)
    whole = random.integers(-(2**31), 2**31, ROWS)
    rounded = np.round(wave, 2)

    signals = pa.table({"time": time, "u1 [mV]": wave, "u2 (V)": rounded, "n": pa.array(whole % 1000, pa.int32())})
    for codec in ["none", "snappy", "gzip", "lz4", "zstd", "brotli"]:
        path = folder / f"codec_{codec}.parquet"
        pq.write_table(signals.slice(0, 22), path, compression=codec, row_group_size=10)
        if codec != "brotli":
            expect(path)
    for codec in ["zstd"]:
        path = folder / f"pages_v2_{codec}.parquet"
        pq.write_table(
            signals.slice(0, 100), path, compression=codec, data_page_version="2.0", use_dictionary=False, row_group_size=300
        )
        expect(path)

    numbers = {
        "f16": pa.array(np.concatenate([[0.0, -0.0, 1.0, -2.5, 6.0e-8, 65504.0, np.inf, np.nan], wave[:10]]).astype(np.float16)),
        "f32": pa.array(wave[:18].astype(np.float32)),
        "f64": pa.array(np.concatenate([[np.nan, np.inf, -np.inf, 5e-324, 1.7976931348623157e308], wave[:13]])),
        "i8": pa.array((whole[:18] % 256 - 128).astype(np.int8)),
        "i16": pa.array((whole[:18] % 65536 - 32768).astype(np.int16)),
        "i32": pa.array(whole[:18].astype(np.int32)),
        "i64": pa.array(whole[:18] * 1000),
        "u8": pa.array((whole[:18] % 256).astype(np.uint8)),
        "u16": pa.array((whole[:18] % 65536).astype(np.uint16)),
        "u32": pa.array((whole[:18] % 2**32).astype(np.uint32)),
        "u64": pa.array(np.uint64(2**63) + ((whole[:18] % 2**20) * 2**11).astype(np.uint64)),
        "b": pa.array(wave[:18] > 0),
    }
    path = folder / "numbers.parquet"
    pq.write_table(pa.table(numbers), path, compression="snappy")
    expect(path)
    required = pa.schema([pa.field(name, array.type, nullable=False) for name, array in numbers.items()])
    path = folder / "numbers_required.parquet"
    pq.write_table(pa.table(list(numbers.values()), schema=required), path, use_dictionary=False, compression="snappy")
    expect(path)

    path = folder / "encodings.parquet"
    pq.write_table(
        pa.table(
            {
                "delta32": pa.array(whole[:18].astype(np.int32)),
                "delta64": pa.array(whole[:18] * 4096),
                "split32": pa.array(wave[:18].astype(np.float32)),
                "split64": wave[:18],
                "plain": wave[:18],
                "rle": pa.array(np.arange(18) % 7 < 3),
            }
        ),
        path,
        use_dictionary=False,
        compression="snappy",
        column_encoding={
            "delta32": "DELTA_BINARY_PACKED",
            "delta64": "DELTA_BINARY_PACKED",
            "split32": "BYTE_STREAM_SPLIT",
            "split64": "BYTE_STREAM_SPLIT",
            "plain": "PLAIN",
            "rle": "RLE",
        },
    )
    expect(path)

    start = np.datetime64("2026-03-01T12:00:00", "ns")
    steps = (np.arange(24) * 100_000).astype("timedelta64[ns]")
    stamps = {
        f"stamp_{unit}": pa.array((start + (steps if unit in ("ns", "us") else steps * 1000)).astype(f"datetime64[{unit}]"))
        for unit in ["ms", "us", "ns"]
    }
    stamps["stamp_utc"] = stamps["stamp_us"].cast(pa.timestamp("us", "UTC"))
    stamps["clock_ms"] = pa.array(np.arange(24), pa.int32()).cast(pa.time32("ms"))
    stamps["clock_us"] = pa.array(np.arange(24) * 10_001, pa.int64()).cast(pa.time64("us"))
    path = folder / "stamps.parquet"
    pq.write_table(pa.table(stamps), path, row_group_size=10)
    expect(path)
    path = folder / "stamps_int96.parquet"
    pq.write_table(pa.table({"stamp": stamps["stamp_ns"]}), path, use_deprecated_int96_timestamps=True)
    expect(path)

    # A measurement as pandas leaves it: named index of time stamps, text beside the numbers.
    frame = pd.DataFrame(
        {"u1 [mV]": wave[:30], "note": [f"n{i % 3}" for i in range(30)], "n": np.arange(30)},
        index=pd.date_range("2026-03-01", periods=30, freq="1ms", name="time"),
    )
    frame.to_parquet(folder / "pandas.parquet")
    expect(folder / "pandas.parquet", ["u1 [mV]", "n", "time"])

    described = signals.slice(0, 9).replace_schema_metadata({"sample_rate_hz": "1000", "sample_rate_hz:n": "500", "title": "Näherung"})
    pq.write_table(described, folder / "described.parquet")
    expect(folder / "described.parquet")

    mixed = pa.table(
        {
            "list": pa.array([[1.0], [2.0, 3.0], []]),
            "point": pa.array([{"x": 1.0}, {"x": 2.0}, {"x": 3.0}]),
            "text": ["a", "b", "c"],
            "price": pa.array([1, 2, 3]).cast(pa.decimal128(19, 0)),
            "day": pa.array([1, 2, 3], pa.int32()).cast(pa.date32()),
            "u": [0.5, 0.25, 0.125],
        }
    )
    pq.write_table(mixed, folder / "mixed.parquet")
    expect(folder / "mixed.parquet", ["u"])
    pq.write_table(mixed.select(["text", "day"]), folder / "no_numbers.parquet")
    pq.write_table(signals.slice(0, 0), folder / "empty.parquet")
    expect(folder / "empty.parquet")

    holes = pa.array([None if i == 73 else float(i) for i in range(100)])
    pq.write_table(pa.table({"u1": wave[:100], "u2": holes}), folder / "holes.parquet", row_group_size=40)
    units = {unit: pa.array(np.arange(12) * 1001, pa.duration(unit)) for unit in ["s", "ms", "us", "ns"]}
    units["stamp [ms]"] = stamps["stamp_ms"][:12]
    units["force"] = wave[:12]
    table = pa.table(units)
    field = table.schema.field("force").with_metadata({"note": "x", "unit": "N"})
    path = folder / "durations.parquet"
    pq.write_table(table.cast(table.schema.set(5, field)), path)
    expect(path)


if __name__ == "__main__":
    main(Path(sys.argv[1]))
