"""Hostile input for .ci/hostile: sound bytes and text, spoilt by a seeded generator."""

import gzip
import re

NUMBERS = ("0", "-1", "1e308", "-1e308", "1e-308", "nan", "inf", "-inf", "NaN", "1e400", "", "0x10", "1,5", "9" * 40, "18446744073709551615",
           "-9223372036854775808", "4294967296", "0.1.2", "1e", "\u0661", "\x1b[2J", "\u202e", "true", "'", "\"", "[]", "{}")


def bytes_of(draw, original):
    """Spoils bytes: ends, bits, lengths, chunks."""
    data = bytearray(original)
    for _ in range(draw.choice((1, 1, 1, 2, 4, 12))):
        size = len(data)
        if not size:
            break
        # Heads, and the tails of formats that have their directory there, are where lengths stand.
        near = draw.choice((size, size, 64, 600, 4096))
        at = draw.randrange(min(size, near))
        at = size - 1 - at if draw.random() < 0.3 else at
        length = draw.choice((1, 2, 4, 8, 100, 5000))
        kind = draw.randrange(8)
        if kind == 0:
            del data[at:]
        elif kind == 1:
            data[at] ^= 1 << draw.randrange(8)
        elif kind == 2:
            width = draw.choice((1, 2, 4, 8))
            old = int.from_bytes(data[at : at + width], "little")
            top = 1 << 8 * width
            new = draw.choice((0, 1, top - 1, top // 2, top // 2 - 1, old + 1, old - 1, old * 2, old * 1000, draw.randrange(top)))
            data[at : at + width] = (new % top).to_bytes(width, draw.choice(("little", "big")))
        elif kind == 3:
            del data[at : at + length]
        elif kind == 4:
            data[at:at] = data[at : at + length] * draw.choice((1, 2, 50))
        elif kind == 5:
            data[at:at] = draw.randbytes(length)
        elif kind == 6:
            data[at : at + length] = bytes(length)
        else:
            data += data[at : at + length]
    return bytes(data)


def text_of(draw, original):
    """Spoils text: numbers, words, lines."""
    text = original
    for _ in range(draw.choice((1, 1, 1, 2, 5))):
        lines = text.split("\n")
        at = draw.randrange(len(lines))
        kind = draw.randrange(7)
        found = list(re.finditer(r"-?\d[\d.eE+-]*", text))
        if kind <= 2 and found:
            number = draw.choice(found)
            text = text[: number.start()] + draw.choice(NUMBERS) + text[number.end() :]
        elif kind == 3:
            del lines[at]
            text = "\n".join(lines)
        elif kind == 4:
            lines.insert(draw.randrange(len(lines)), lines[at])
            text = "\n".join(lines)
        elif kind == 5:
            text = bytes_of(draw, text.encode("utf-8", "surrogateescape")).decode("utf-8", "surrogateescape")
        else:
            words = [m for m in re.finditer(r"[A-Za-z_]{2,}", lines[at])]
            if words:
                word = draw.choice(words)
                other = draw.choice(("\x1b[31m", "\u202eu1", "time", "u1", "a" * 5000, "null", "false", "static", word[0].upper()))
                lines[at] = lines[at][: word.start()] + other + lines[at][word.end() :]
            text = "\n".join(lines)
    return text.encode("utf-8", "surrogateescape")


def bomb(draw):
    """A little gzip that is much: one endless line, endless rows, or members by the thousand."""
    kind = draw.randrange(4)
    if kind == 0:
        return gzip.compress(b"0" * draw.choice((1 << 20, 1 << 27)), 9)
    if kind == 1:
        return gzip.compress(b"u1,u2\n" + b"0,0\n" * draw.choice((1 << 18, 1 << 22)), 9)
    if kind == 2:
        return gzip.compress(b"time,u1\ns,V\n0,1\n", 9) * draw.choice((10, 3000))
    return gzip.compress(b",".join([b"u1"] * draw.choice((1000, 200_000))) + b"\n", 9)


OPTIONS = {
    "simulate": ("--seed", "--format", "--sensor", "--engine", "--defect", "--trials", "--rate", "--taps", "--tumble", "--drift-limb", "--plan"),
    "inspect": ("--session", "--channels", "--unit", "--json", "--strict", "--picture"),
    "calibrate": ("--out", "--report", "--estimator", "--format", "--json"),
    "decouple": ("--session", "--gain", "--rate", "--down", "--channels", "--unit", "--scheme", "--low-pass", "--excluded", "--watch",
                 "--false-alarms-per-hour", "--rest-to-rest", "--uncertainty", "--accelerations", "--json", "--out"),
    "self-calibrate": ("--since", "--gain", "--rate", "--down", "--known-change", "--rests", "--json"),
    "compare": ("--out", "--json"),
    "campaign run": ("--plan", "--count", "--shard", "--first-seed", "--threads"),
    "campaign summary": ("--json",),
    "man": ("--out",), "completions": (), "model": ("--design",),
}
WORDS = (*(word for word in NUMBERS if "\x00" not in word), "1,2,3", "0,0,0", "0,0,-1", "4=0.3%", "0=1%", "x" * 100_000, "/dev/null", "/dev/full",
         "..", "/", "random", "V", "1/2", "0/0", "5 ,6", "1,1", "u1,u2", "\udcff\udcfe", "out.npz", "no/such/folder/out.csv", "-", "--", "--help")
