"""Writes small TDMS files and what npTDMS reads from them: python tdms.py OUTDIR

npTDMS itself writes little-endian contiguous segments only. All other files are put together here byte by byte, with their
values known beforehand; npTDMS must read just these, or nothing is written. Beside each `name.tdms` lies `name.expected`, a line
per numeric channel: name, unit, samples per second, offset in s, values, separated by tabs and the values by spaces; a dash
where there is none.
"""

import io
import math
import struct
import sys
from pathlib import Path

import numpy as np
from nptdms import ChannelObject, GroupObject, RootObject, TdmsFile, TdmsWriter
from nptdms.timestamp import TdmsTimestamp

META, NEW, RAW, INTERLEAVED, BIG, DAQMX = 2, 4, 8, 32, 64, 128
NONE, SAME = 0xFFFFFFFF, 0
CODES = {"b": 1, "h": 2, "i": 3, "q": 4, "B": 5, "H": 6, "I": 7, "Q": 8, "f": 9, "d": 10, "?": 0x21, "T": 0x44, "s": 0x20,
         "F": 0x19, "D": 0x1A}
FORMS = {"?": "B", "F": "f", "D": "d"}


class Segment:
    """Bytes of one segment. `objects`: (path, index, properties); the index is NONE, SAME, or (code, count), or DAQmx bytes."""

    def __init__(self, objects, raw=b"", flags=META | NEW | RAW, version=4713):
        self.order = ">" if flags & BIG else "<"
        metadata = b""
        if flags & META:
            metadata = self.pack("I", len(objects))
            for path, index, properties in objects:
                metadata += self.text(path) + self.index(index) + self.pack("I", len(properties))
                for name, (code, value) in properties.items():
                    metadata += self.text(name) + self.pack("I", CODES[code]) + self.value(code, value)
        self.head = b"TDSm" + struct.pack("<I", flags) + self.pack("I", version)
        self.metadata, self.raw = metadata, raw

    def pack(self, form, *values):
        return struct.pack(self.order + form, *values)

    def text(self, text):
        return self.pack("I", len(text.encode())) + text.encode()

    def value(self, code, value):
        if code == "s":
            return self.text(value)
        return encode(code, [value], self.order)

    def index(self, index):
        if isinstance(index, bytes):
            return index
        if isinstance(index, int):
            return self.pack("I", index)
        code, count = index[:2]
        if code == "s":
            return self.pack("IIIQQ", 28, CODES[code], 1, count, index[2])
        return self.pack("IIIQ", 20, CODES[code], 1, count)

    def bytes(self, length=None):
        length = len(self.metadata) + len(self.raw) if length is None else length
        return self.head + self.pack("QQ", length, len(self.metadata)) + self.metadata + self.raw


def encode(code, values, order="<"):
    if code == "T":  # (seconds, 2^-64 s)
        pairs = [(f, s) if order == "<" else (s, f) for s, f in values]
        return b"".join(struct.pack(order + ("Qq" if order == "<" else "qQ"), *pair) for pair in pairs)
    return struct.pack(f"{order}{len(values)}{FORMS.get(code, code)}", *values)


def interleave(columns, order="<"):
    return b"".join(encode(code, [v], order) for row in zip(*[[(c, v) for v in vs] for c, vs in columns]) for code, v in row)


def seconds(values):
    """Since the first, correctly rounded."""
    units = [s * 2**64 + f for s, f in values]
    return [(u - units[0]) / 2**64 for u in units]


def as_numbers(channel):
    data = channel[:]
    if len(data) and isinstance(data[0], TdmsTimestamp):
        return seconds([(int(t.seconds), int(t.second_fractions)) for t in data])
    return [float(value) for value in data]


def type_name(channel):
    return channel.data_type.__name__ if channel.data_type else None


def number(value):
    return "-" if value is None else repr(float(value))


def start(channel):
    """In units of 2^-64 s; 0 where there is none."""
    time = channel.properties.get("wf_start_time")
    return 0 if time is None else int(time.seconds) * 2**64 + int(time.second_fractions)


def emit(out, name, data, known, tolerance=0.0, common=False):
    """Writes a file once npTDMS agrees with `known` (channel name to values)."""
    file = TdmsFile.read(io.BytesIO(data), raw_timestamps=True)
    read = {}
    for group in file.groups():
        for channel in group.channels():
            if type_name(channel) != "String":
                read[f"{group.name}/{channel.name}"] = (channel, as_numbers(channel))
    if common:  # the last chunk is cut: as far as all channels reach
        shortest = min(len(values) for _, values in read.values())
        read = {key: (channel, values[:shortest]) for key, (channel, values) in read.items()}
    assert sorted(read) == sorted(known), (name, sorted(read), sorted(known))
    lines = []
    starts = [time for time in (start(channel) for channel, _ in read.values()) if time]
    for key, (channel, values) in read.items():
        expected = known[key]
        assert len(values) == len(expected), (name, key, len(values), len(expected))
        for got, want in zip(values, expected):
            same = got == want or (math.isnan(got) and math.isnan(want)) or abs(got - want) <= tolerance * abs(want)
            assert same, (name, key, got, want)
        step = channel.properties.get("wf_increment")
        unit = "s" if type_name(channel) == "TimeStamp" else channel.properties.get("unit_string", "-")
        rate = None if step is None else 1 / step
        late = (start(channel) - min(starts)) / 2**64 if start(channel) else 0.0
        offset = channel.properties.get("wf_start_offset", 0.0) + late
        lines.append("\t".join([key, unit, number(rate), number(offset), " ".join(number(v) for v in values) or "-"]))
    assert len(data) < 20_000, name
    (out / f"{name}.tdms").write_bytes(data)
    (out / f"{name}.expected").write_text("\n".join(lines) + "\n", newline="\n")


def wave(count, scale=1.0, phase=0.0):
    return [scale * math.sin(0.37 * i + phase) for i in range(count)]


def written_by_nptdms(out):
    known = {}
    buffer = io.BytesIO()
    with TdmsWriter(buffer, version=4713) as writer:
        for part, count in enumerate([50, 50, 50, 13]):
            objects = []
            if part == 0:
                objects.append(RootObject({"title": "Bench 2, slow", "author": "npTDMS", "serial": 17, "gain": 0.1}))
                objects.append(GroupObject("it's a 'group'", {"room": "B 12"}))
            for i, unit in enumerate(["V", "mV", "m/s^2"]):
                values = wave(count, 10.0**i, part + 0.1 * i)
                key = f"it's a 'group'/u{i} 'quoted'"
                known.setdefault(key, []).extend(values)
                properties = {"unit_string": unit, "wf_increment": 0.001, "wf_start_offset": 0.25 * i,
                              "wf_start_time": np.datetime64("2024-02-29T12:34:56.789012", "us"), "wf_samples": 50}
                objects.append(ChannelObject("it's a 'group'", f"u{i} 'quoted'", np.array(values), properties if part == 0 else {}))
            counts = np.arange(count, dtype=np.int16) * (-1) ** part
            known.setdefault("counts/n", []).extend(float(c) for c in counts)
            objects.append(ChannelObject("counts", "n", counts))
            objects.append(ChannelObject("notes", "texts", [f"note {part}.{i} ä" for i in range(3)]))
            writer.write_segment(objects)
    emit(out, "written_by_nptdms", buffer.getvalue(), known)


def interleaved(out):
    count = 12
    codes = "hfdBq"
    known = {f"g/{c}": [] for c in codes}
    data = b""
    for part in range(3):
        # Three chunks in the second segment; the third has no metadata.
        chunks = [1, 3, 2][part]
        columns = []
        for c in codes:
            rows = count * chunks
            if c in "fd":
                values = [struct.unpack(c, struct.pack(c, v))[0] for v in wave(rows, 3.0, part)]
            else:
                values = [(part * 40 + i * 7) % 120 for i in range(rows)]
            known[f"g/{c}"] += [float(v) for v in values]
            columns.append((c, values))
        objects = [("/", NONE, {})] + [(f"/'g'/'{c}'", (c, count) if part == 0 else SAME, {}) for c in codes]
        flags = RAW | INTERLEAVED | (META | NEW if part < 2 else 0)
        data += Segment(objects, interleave(columns), flags, 4712).bytes()
    emit(out, "interleaved", data, known)
    cut = data[:-37]
    row = 2 + 4 + 8 + 1 + 8
    emit(out, "interleaved_cut", cut, {k: v[: len(v) - (37 + row - 1) // row] for k, v in known.items()})


EXTREMES = {
    "b": [-128, 127, 0, -1], "h": [-32768, 32767, 5, -1], "i": [-(2**31), 2**31 - 1, 6, -1],
    "q": [-(2**63), 2**63 - 1, 2**53 + 1, -1], "B": [0, 255, 7, 128], "H": [0, 65535, 8, 32768],
    "I": [0, 2**32 - 1, 9, 2**31], "Q": [0, 2**64 - 1, 2**53 + 1, 2**63], "f": [0.5, -3.25, math.inf, math.nan],
    "d": [0.1, -1e-300, 1.7976931348623157e308, 5e-324], "F": [0.5, 1.5, -2.5, 0.0], "D": [0.3, -0.0, 1e10, -math.inf],
    "?": [0, 1, 1, 0], "T": [(3_800_000_000, 2**63), (3_800_000_000, 2**63 + 2**40 + 3), (3_800_000_001, 1), (3_799_999_999, 2**62)],
}


def types(out, name, extra):
    order = ">" if extra & BIG else "<"
    objects = [("/", NONE, {"start": ("T", (3_800_000_000, 2**63)), "n": ("h", -2), "x": ("d", 0.1), "ok": ("?", 1)})]
    objects += [(f"/'types'/'{ord(c)}'", (c, 2), {"wf_increment": ("d", 0.02), "unit_string": ("s", "g")}) for c in EXTREMES]
    # Two chunks of two samples.
    if extra & INTERLEAVED:
        raw = interleave(list(EXTREMES.items()), order)
    else:
        raw = b"".join(encode(c, v[at : at + 2], order) for at in (0, 2) for c, v in EXTREMES.items())
    data = Segment(objects, raw, META | NEW | RAW | extra).bytes()
    known = {f"types/{ord(c)}": seconds(v) if c == "T" else [float(x) for x in v] for c, v in EXTREMES.items()}
    emit(out, name, data, known)


def object_lists(out):
    """Lists that are extended, repeated, changed; a channel that pauses; a text channel between others; properties alone."""
    known = {"g/a": [], "g/b": [], "g/c": []}
    data = b""
    clock = iter(range(10_000))

    def values(key, code, count):
        new = [next(clock) for _ in range(count)]
        known[key] += [float(v) for v in new]
        return encode(code, new)

    a, b, c, text = "/'g'/'a'", "/'g'/'b'", "/'g'/'c'", "/'g'/'text'"
    raw = values("g/a", "d", 3) + values("g/b", "h", 4)
    data += Segment([("/", NONE, {}), ("/'g'", NONE, {}), (a, ("d", 3), {}), (b, ("h", 4), {})], raw).bytes()
    raw = values("g/a", "d", 3) + values("g/b", "h", 4)
    data += Segment([], raw, RAW).bytes()
    # b has other samples, c comes last, with a text between them; two chunks.
    words = encode("I", [2, 5]) + b"hello"
    raw = b"".join(values("g/a", "d", 3) + values("g/b", "h", 1) + words + values("g/c", "f", 2) for _ in range(2))
    data += Segment([(b, ("h", 1), {}), (text, ("s", 2, len(words)), {}), (c, ("f", 2), {})], raw, META | RAW).bytes()
    # Only properties.
    data += Segment([(a, NONE, {"unit_string": ("s", "V")}), (b, NONE, {}), (text, NONE, {}), (c, NONE, {"unit_string": ("s", "old")})], b"", META).bytes()
    # a again as before, the others pause.
    data += Segment([(a, SAME, {})], values("g/a", "d", 3), META | RAW).bytes()
    # A new list in another order.
    raw = values("g/c", "f", 2) + values("g/a", "d", 5)
    data += Segment([(c, SAME, {"unit_string": ("s", "new")}), (a, ("d", 5), {})], raw).bytes()
    # The list is empty.
    data += Segment([], b"", META | NEW).bytes()
    data += Segment([("/'g'/'empty'", NONE, {})], b"", META | NEW).bytes()
    known["g/empty"] = []
    emit(out, "object_lists", data, known)


def cut_off(out):
    a, b = wave(20), wave(20, 2.0, 1.0)
    objects = [("/'g'/'a'", ("d", 10), {}), ("/'g'/'b'", ("d", 10), {})]
    first = Segment(objects, encode("d", a[:10]) + encode("d", b[:10])).bytes()
    raw = encode("d", a[10:]) + encode("d", b[10:])
    second = Segment([], raw, RAW)
    both = first + second.bytes()
    # Within the samples of b, within those of a, within the lead-in.
    emit(out, "cut_in_last_channel", both[:-29], {"g/a": a[:16], "g/b": b[:16]}, common=True)
    emit(out, "cut_in_first_channel", both[:-101], {"g/a": a[:10], "g/b": b[:10]}, common=True)
    emit(out, "cut_in_lead_in", both[: len(first) + 20], {"g/a": a[:10], "g/b": b[:10]})
    emit(out, "length_unknown", first + second.bytes(2**64 - 1)[:-20], {"g/a": a[:17], "g/b": b[:17]}, common=True)
    again = Segment(objects, raw).bytes()
    emit(out, "cut_in_metadata", first + again[:60], {"g/a": a[:10], "g/b": b[:10]})


def short_last_chunk(out):
    """A whole segment whose last chunk has fewer samples of all channels."""
    a, b = [float(i) for i in range(14)], list(range(100, 114))
    objects = [("/'g'/'a'", ("d", 10), {}), ("/'g'/'b'", ("h", 10), {})]
    raw = encode("d", a[:10]) + encode("h", b[:10]) + encode("d", a[10:]) + encode("h", b[10:])
    data = Segment(objects, raw).bytes() + Segment([("/'g'/'a'", NONE, {"late": ("i", 1)})], b"", META | NEW).bytes()
    emit(out, "short_last_chunk", data, {"g/a": a, "g/b": [float(v) for v in b]})


def scale_properties(*scales, status=None, count=True):
    properties = {"NI_Number_Of_Scales": ("I", len(scales))} if count else {}
    if status:
        properties["NI_Scaling_Status"] = ("s", status)
    for at, scale in enumerate(scales):
        if scale is None:
            continue
        kind, rest = scale
        properties[f"NI_Scale[{at}]_Scale_Type"] = ("s", kind)
        for name, value in rest.items():
            if isinstance(value, list):
                properties[f"NI_Scale[{at}]_{kind}_{name}_Size"] = ("I", len(value))
                for i, v in enumerate(value):
                    properties[f"NI_Scale[{at}]_{kind}_{name}[{i}]"] = ("d", v)
            else:
                properties[f"NI_Scale[{at}]_{kind}_{name}"] = ("I" if name.endswith("Source") else "d", value)
    return properties


def linear(slope, intercept, source=NONE):
    return ("Linear", {"Slope": slope, "Y_Intercept": intercept, "Input_Source": source})


def polynomial(coefficients, source=NONE):
    return ("Polynomial", {"Coefficients": coefficients, "Input_Source": source})


def table(inputs, outputs, source=NONE):
    return ("Table", {"Pre_Scaled_Values": inputs, "Scaled_Values": outputs, "Input_Source": source})


def two(kind, left, right):
    return (kind, {"Left_Operand_Input_Source": left, "Right_Operand_Input_Source": right})


def poly(coefficients, x):
    return sum(c * x**i for i, c in enumerate(coefficients))


def lookup(inputs, outputs, x):
    points = sorted(zip(inputs, outputs))
    if x <= points[0][0]:
        return points[0][1]
    for (x0, y0), (x1, y1) in zip(points, points[1:]):
        if x <= x1:
            return y0 + (y1 - y0) * (x - x0) / (x1 - x0)
    return points[-1][1]


COEFFICIENTS = [0.25, -3.05e-4, 1e-9, -2e-15, 3e-20]


def scales(out):
    raw = [-32768, -20001, -7, 0, 1, 300, 12345, 32767]
    xs, ys = [-20000.0, -100.0, 0.0, 400.0, 20000.0], [5.0, 2.0, 2.5, -1.0, -8.0]
    cases = {
        "linear": (scale_properties(linear(0.0003, -1.7)), lambda x: 0.0003 * x - 1.7),
        "no_count": (scale_properties(linear(2.0, 1.0), linear(0.1, 0.0, 0), count=False), lambda x: 0.1 * (2 * x + 1)),
        "polynomial": (scale_properties(polynomial(COEFFICIENTS)), lambda x: poly(COEFFICIENTS, x)),
        "constant": (scale_properties(polynomial([])), lambda x: 0.0),
        "table": (scale_properties(table(xs, ys)), lambda x: lookup(xs, ys, x)),
        "table_down": (scale_properties(table(xs[::-1], ys[::-1])), lambda x: lookup(xs, ys, x)),
        "chain": (scale_properties(linear(0.5, 1.0), polynomial([1.0, 2.0, 3.0], 0), linear(-1.0, 0.125, 1)),
                  lambda x: 0.125 - poly([1, 2, 3], 0.5 * x + 1)),
        "sum": (scale_properties(linear(0.5, 1.0), linear(0.25, 0.0), two("Add", 0, 1)), lambda x: 0.75 * x + 1),
        "difference": (scale_properties(linear(0.5, 1.0), linear(0.25, 0.0), two("Subtract", 0, 1)), lambda x: -0.25 * x - 1),
        "already": (scale_properties(linear(0.0003, -1.7), status="scaled"), float),
        "not_yet": (scale_properties(linear(0.0003, -1.7), status="unscaled"), lambda x: 0.0003 * x - 1.7),
        "none": (scale_properties(), float),
    }
    objects = [("/", NONE, {}), ("/'g'", NONE, {}), ("/'of group'", NONE, scale_properties(linear(3.0, 4.0)))]
    known, data = {}, b""
    for name, (properties, function) in cases.items():
        objects.append((f"/'g'/'{name}'", ("h", len(raw)), properties))
        data += encode("h", raw)
        known[f"g/{name}"] = [function(x) for x in raw]
    objects.append(("/'of group'/'x'", ("d", 8), {}))
    data += encode("d", [0.5 * x for x in raw])
    known["of group/x"] = [1.5 * x + 4 for x in raw]
    emit(out, "scales", Segment(objects, data).bytes(), known, tolerance=1e-9)


def refused(out):
    """One channel to be read, others whose scales or types are not."""
    rtd = {"Current_Excitation": 1e-3, "R0_Nominal_Resistance": 100.0, "A": 3.9083e-3, "B": -5.775e-7, "C": -4.183e-12,
           "Lead_Wire_Resistance": 0.0, "Input_Source": NONE}
    rtd = scale_properties(("RTD", rtd))
    rtd["NI_Scale[0]_RTD_Resistance_Configuration"] = ("I", 4)
    circle = scale_properties(linear(1.0, 0.0, 1), linear(1.0, 0.0, 0))
    blank = scale_properties(("Linear", {"Slope": 2.0}))
    cases = {"temperature": rtd, "circle": circle, "no_intercept": blank, "unknown": scale_properties(("Novel", {}))}
    objects = [("/'g'/'fine'", ("d", 3), {})]
    objects += [(f"/'g'/'{name}'", ("d", 3), properties) for name, properties in cases.items()]
    data = Segment(objects, encode("d", [0.1, 0.2, 0.3]) * 5).bytes()
    reduced = Segment(objects[:1], encode("d", [0.1, 0.2, 0.3])).bytes()
    emit(out, "refused", reduced, {"g/fine": [0.1, 0.2, 0.3]})
    (out / "refused.tdms").write_bytes(data)


def daqmx_index(count, scalers, widths, code=0xFFFFFFFF, line=False):
    data = struct.pack("<IIIQI", 0x126A if line else 0x1269, code, 1, count, len(scalers))
    for kind, buffer, offset, scale in scalers:
        data += struct.pack("<IIIBI" if line else "<IIIII", kind, buffer, offset, 0, scale)
    return data + struct.pack("<I", len(widths)) + struct.pack(f"<{len(widths)}I", *widths)


def daqmx(out):
    flags = META | NEW | RAW | DAQMX
    raw = [[(37 * i + 1000 * j) % 60000 - 30000 for i in range(24)] for j in range(2)]
    # One device, two channels of 16 bits in rows of 5 bytes, two chunks of 10 rows and one that is short.
    rows = b"".join(struct.pack("<hBh", x, 0xEE, y) for x, y in zip(*raw))
    objects = [
        ("/'d'/'linear'", daqmx_index(10, [(3, 0, 0, 0)], [5]), scale_properties(None, linear(2e-4, 0.5, 0))),
        ("/'d'/'poly'", daqmx_index(10, [(3, 0, 3, 0)], [5]), scale_properties(None, polynomial(COEFFICIENTS, 0), linear(10.0, 0.0, 1), status="unscaled")),
    ]
    known = {"d/linear": [x * 2e-4 + 0.5 for x in raw[0]], "d/poly": [10 * poly(COEFFICIENTS, y) for y in raw[1]]}
    emit(out, "daqmx", Segment(objects, rows, flags).bytes(), known, tolerance=1e-9)
    # Two devices, each with a buffer of its own, and as many rows in each of two chunks.
    data = b""
    for at in (0, 10):
        data += b"".join(struct.pack("<hB", v, 1) for v in raw[0][at : at + 10])
        data += b"".join(struct.pack("<Bi", 2, v) for v in raw[1][at : at + 10])
    objects = [
        ("/'d'/'first'", daqmx_index(10, [(3, 0, 0, 0)], [3, 5]), scale_properties(None, linear(0.25, 1.0, 0))),
        ("/'d'/'second'", daqmx_index(10, [(5, 1, 1, 2)], [3, 5]), scale_properties(linear(9.0, 9.0), linear(0.5, -1.0, 2), None, linear(1.0, 0.5, 1))),
    ]
    known = {"d/first": [0.25 * v + 1 for v in raw[0][:20]], "d/second": [0.5 * v - 0.5 for v in raw[1][:20]]}
    emit(out, "daqmx_two_devices", Segment(objects, data, flags).bytes(), known)
    # Lines of a digital port, and the port as a number.
    port = [(i * 73) % 256 for i in range(16)]
    objects = [(f"/'d'/'line{bit}'", daqmx_index(16, [(0, 0, bit, 0)], [1], line=True), scale_properties(None)) for bit in (0, 3, 7)]
    known = {f"d/line{bit}": [float(p >> bit & 1) for p in port] for bit in (0, 3, 7)}
    emit(out, "daqmx_lines", Segment(objects, bytes(port), flags).bytes(), known)


def waveforms(out):
    """Waveforms that begin at different times."""
    objects, data, known = [], b"", {}
    for i, late in enumerate([2**63, 0, 2**62]):
        properties = {"wf_start_time": ("T", (3_800_000_000, late)), "wf_increment": ("d", 1 / 49), "wf_start_offset": ("d", 0.5 * i)}
        objects.append((f"/'g'/'w{i}'", ("f", 4), properties))
        data += encode("f", [i, i + 1, i + 2, i + 3])
        known[f"g/w{i}"] = [float(i + j) for j in range(4)]
    emit(out, "waveforms", Segment(objects, data).bytes(), known)


def main():
    out = Path(sys.argv[1])
    out.mkdir(parents=True, exist_ok=True)
    written_by_nptdms(out)
    interleaved(out)
    types(out, "types", 0)
    types(out, "types_big_endian", BIG)
    types(out, "types_interleaved", INTERLEAVED)
    types(out, "types_big_endian_interleaved", BIG | INTERLEAVED)
    object_lists(out)
    cut_off(out)
    short_last_chunk(out)
    scales(out)
    refused(out)
    daqmx(out)
    waveforms(out)


if __name__ == "__main__":
    main()
