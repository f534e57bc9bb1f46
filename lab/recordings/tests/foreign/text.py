"""Files of text as other software writes them, and the numbers that its own readers find in them.

Usage: python text.py OUTDIR. Writes the files and expected.json: per file the names, the columns (floats as their repr)
and, where the file says so, units and sample rate.
"""

import gzip
import io
import json
import sys
import warnings
from pathlib import Path

import lvm_read
import numpy as np
import pandas as pd

out = Path(sys.argv[1])
out.mkdir(parents=True, exist_ok=True)
expected = {}
rng = np.random.default_rng(20)
ROWS = 12


def numbers(columns, rows=ROWS):
    """Values of many magnitudes, so that every digit is tested."""
    return rng.normal(size=(rows, columns)) * 10.0 ** rng.integers(-12, 12, size=(rows, columns))


def expect(name, frame, **said):
    expected[name] = {
        "names": [str(c) for c in frame.columns],
        "columns": [[repr(float(v)) for v in frame[c]] for c in frame.columns],
        **said,
    }


def by_pandas(name, text, names=None, **options):
    """Writes the text and expects what pandas reads from it."""
    data = text if isinstance(text, bytes) else text.encode()
    (out / name).write_bytes(data)
    said = {key: options.pop(key) for key in ("units", "rate") if key in options}
    plain = gzip.decompress(data) if name.endswith(".gz") else data
    frame = pd.read_csv(
        io.BytesIO(plain), encoding=options.pop("encoding", "utf-8-sig"), **options
    )
    if names:
        frame.columns = names
    expect(name, frame, **said)


def frame(columns, rows=ROWS):
    names = ["t"] + [f"u{k}" for k in range(1, columns)]
    table = pd.DataFrame(numbers(columns, rows), columns=names)
    table["t"] = np.arange(rows) / 1000.0
    return table


# pandas: its defaults, with its index, national variants, tabs, compressed.
by_pandas("pandas.csv", frame(4).to_csv(index=False))
by_pandas("pandas_index.csv", frame(3).to_csv(), names=["column_1", "t", "u1", "u2"])
counted = pd.DataFrame(numbers(3))
by_pandas("pandas_numbered.csv", counted.to_csv(), names=["column_1", "0", "1", "2"])
by_pandas("pandas_german.csv", frame(4).to_csv(index=False, sep=";", decimal=","), sep=";", decimal=",")
by_pandas("pandas_tab_comma.tsv", frame(3).to_csv(index=False, sep="\t", decimal=","), sep="\t", decimal=",")
special = frame(3)
special.loc[0, "u1"] = np.nan
special.loc[3, "u2"] = np.inf
special.loc[4, "u2"] = -np.inf
by_pandas("pandas_nan.csv", special.to_csv(index=False, na_rep="nan"))
by_pandas("pandas_integers.csv", pd.DataFrame(rng.integers(-9, 9, (ROWS, 3)), columns=list("abc")).to_csv(index=False))
by_pandas("pandas.csv.gz", gzip.compress(frame(4).to_csv(index=False).encode(), mtime=0))
text = frame(3).to_csv(index=False).encode()
members = gzip.compress(text[:1000], mtime=0) + gzip.compress(text[1000:], mtime=0)
by_pandas("members.csv.gz", members)

# Excel: byte order mark, CRLF, quotes around everything, its first line, Latin-1.
german = frame(3).to_csv(index=False, sep=";", decimal=",", lineterminator="\r\n")
by_pandas("excel_utf8.csv", b"\xef\xbb\xbf" + german.encode(), sep=";", decimal=",")
by_pandas("excel_sep.csv", "sep=;\r\n" + german, sep=";", decimal=",", skiprows=1)
by_pandas("quoted.csv", frame(3).to_csv(index=False, quoting=1))
latin = german.replace("t;u1;u2", "Zeit [s];Kanal µ [µV];u2 [°]")
by_pandas(
    "excel_latin1.csv", latin.encode("latin-1"), sep=";", decimal=",", encoding="latin-1",
    names=["Zeit", "Kanal µ", "u2"], units=["s", "µV", "°"],
)
by_pandas("macintosh.csv", frame(3).to_csv(index=False, lineterminator="\r"))

# LabVIEW's "Write To Spreadsheet File": tabs, six digits, no headings; with a decimal comma as well.
plain = "\r\n".join("\t".join(f"{v:.6f}" for v in row) for row in rng.normal(size=(ROWS, 3))) + "\r\n"
by_pandas("labview_sheet.txt", plain, sep="\t", header=None, names=["column_1", "column_2", "column_3"])
by_pandas(
    "labview_sheet_comma.txt", plain.replace(".", ","), sep="\t", decimal=",", header=None,
    names=["column_1", "column_2", "column_3"],
)

# MATLAB: writetable and writematrix (15 digits, NaN and Inf).
matlab = "Time,Var_1,Var_2\n" + "".join(
    f"{k / 500:.15g},{a:.15g},{b:.15g}\n" for k, (a, b) in enumerate(rng.normal(size=(ROWS, 2)))
) + "0.5,NaN,Inf\n0.51,-Inf,NaN\n"
by_pandas("matlab_table.csv", matlab)
by_pandas("matlab_matrix.txt", matlab.split("\n", 1)[1], header=None, names=["column_1", "column_2", "column_3"])

# A line of units, comments with properties, blank lines.
rows = "".join(f"{k / 100:g};{a:g};{b:g}\n" for k, (a, b) in enumerate(rng.normal(size=(ROWS, 2))))
by_pandas(
    "units.csv", "s;u1;u2\n[s];mV;\n" + rows, sep=";", skiprows=[1],
    names=["s", "u1", "u2"], units=["s", "mV", None],
)
commented = "# sample_rate_hz = 250.5\n# title: drop test: 3\n\nu1 [V],u2 (m/s^2)\n1.5,2\n\n# a knock\n-3e-5,4\n+.25,7.\n"
by_pandas("comments.csv", commented, comment="#", names=["u1", "u2"], units=["V", "m/s^2"], rate=250.5)

# NumPy: savetxt with its defaults and with a header.
table = numbers(3)
for name, options in {
    "savetxt.txt": {},
    "savetxt_header.txt": {"header": "t ax ay"},
    "savetxt_comma.csv": {"header": "t,ax,ay", "delimiter": ",", "fmt": "%.17g"},
}.items():
    np.savetxt(out / name, table, **options)
    names = ["t", "ax", "ay"] if "header" in options else ["column_1", "column_2", "column_3"]
    read = np.loadtxt(out / name, delimiter=options.get("delimiter"))
    expect(name, pd.DataFrame(read, columns=names))

# R: write.table with quotes and without row names; blanks as padding of a fixed width.
r = '"a" "b c"\n' + "".join(f"{a:.15g} {b:.15g}\n" for a, b in rng.normal(size=(ROWS, 2)))
by_pandas("r_table.txt", r, sep=" ")
fixed = "".join("".join(f"{v:14.6e}" for v in row) + "\n" for row in rng.normal(size=(ROWS, 3)))
by_pandas("fixed.dat", fixed, sep=r"\s+", header=None, names=["column_1", "column_2", "column_3"])
by_pandas("one_column.csv", "acc [g]\n" + "".join(f"{v:g}\n" for v in rng.normal(size=ROWS)), names=["acc"], units=["g"])


# LabVIEW Measurement files, after the description of the format; read by lvm_read.
def lvm(name, x_columns, separator, decimal, comment):
    word = {"\t": "Tab", ",": "Comma"}[separator]
    head = [
        "LabVIEW Measurement", "Writer_Version{s}2", "Reader_Version{s}2", "Separator{s}" + word,
        "Decimal_Separator{s}" + decimal, "Multi_Headings{s}Yes", "X_Columns{s}" + x_columns, "Time_Pref{s}Relative",
        "Operator{s}Laboratory", "Date{s}2024/05/06", "Time{s}10:11:12.5", "***End_of_Header***{s}", "{s}",
        "Channels{s}2{s}{s}", "Samples{s}12{s}12{s}", "Y_Unit_Label{s}Volts{s}g{s}", "X_Dimension{s}Time{s}Time{s}",
        "X0{s}0" + decimal + "25{s}0" + decimal + "25{s}", "Delta_X{s}0" + decimal + "002{s}0" + decimal + "002{s}",
        "***End_of_Header***{s}{s}{s}", "X_Value{s}Voltage{s}Acceleration{s}Comment",
    ]
    lines = [line.format(s=separator) for line in head]
    for k, (a, b) in enumerate(rng.normal(size=(ROWS, 2))):
        x = f"{0.25 + k * 0.002:.6f}" if x_columns == "One" else ""
        row = separator.join([x, f"{a:.6f}", f"{b:.6f}"])
        lines.append(row.replace(".", decimal) + (separator if comment else ""))
    (out / name).write_bytes(("\r\n".join(lines) + "\r\n").encode())
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        read = lvm_read.read(str(out / name), read_from_pickle=False, dump_file=False)[0]
    data = np.array(read["data"])
    first = 0 if x_columns == "One" else 1
    names = ["X_Value", "Voltage", "Acceleration"][first:]
    data = data[:, : len(names)]
    units = ["s", "Volts", "g"][first:]
    expect(name, pd.DataFrame(data, columns=names), units=units, rate=500.0)


lvm("one.lvm", "One", "\t", ".", False)
lvm("none.lvm", "No", "\t", ".", True)
lvm("comma.lvm", "One", "\t", ",", True)

(out / "expected.json").write_text(json.dumps(expected, sort_keys=True) + "\n")
