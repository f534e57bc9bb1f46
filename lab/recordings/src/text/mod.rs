//! Text: columns of numbers as LabVIEW, MATLAB, pandas, NumPy, R and Excel of any country write them, plain or gzip.
//!
//! # What is read
//! * UTF-8 with or without byte order mark (headings may be Latin-1); lines end with LF, CRLF or CR; blank lines are skipped.
//! * Lines that begin with `#` or `%` are comments, wherever they stand; one between rows that has a row's numbers behind its first cell
//!   is refused. Before the numbers, `# key: value` and
//!   `# key = value` become properties; `sample_rate_hz` (or `fs`, `fs_hz`) is the rate of all channels.
//! * One line of headings or none (then `column_1` ...), with units in brackets or in a second line of units (`s;V;V`).
//!   Without a line of headings, a last comment with as many names as there are columns is one (`numpy.savetxt`).
//! * Time stamps of a calendar, ISO 8601 or `31.05.2024 14:03:07,25`, in one column or in two for date and time of day, and times since a
//!   start (`00:07.25`, `25:00:00`, `0 days 00:00:07`) are one channel: seconds since the first row, whose stamp is the property
//!   `NAME/first_timestamp`. It is the clock if no channel has the name of one. A time of day without a date may pass midnight.
//! * LabVIEW Measurement files (`.lvm`) with one header and at most one X column.
//! * gzip by content, of any number of members. A damaged or shortened stream is an error.
//!
//! # How the dialect is decided
//! From the first lines (at most 100, at most 1 MiB). The separator is the one among tab, semicolon, comma and runs of blanks
//! with which the largest share of the cells are numbers; in a tie the first of this order. A first line `sep=;` (Excel)
//! decides it outright. If the lines are separated by
//! * **commas**, the decimal sign is the point, always. `1,5` without another separator is two columns; where the headings
//!   then count otherwise, the file is refused with advice.
//! * **anything else**, the decimal sign is the one in the majority of the cells; if these are all whole numbers, the first
//!   sign met while reading decides. A file that has both is refused at the first cell that does not fit, thus also
//!   thousands separators (`1.234,5`). `1.234` alone is 1.234, never 1234.
//!
//! A first line that is all numbers is a row of numbers, not of headings; names that count up (`,0,1,2` of pandas) are
//! headings if some other cell of the line is text.
//!
//! # What is refused, with line and column
//! Empty cells (missing values are to be written `nan`), text in a channel that is read (one that is not selected may be
//! text), a footer, rows with more or fewer cells than the others, more than 4096 columns, lines over 1 MiB, quotes that
//! span lines, UTF-16, and anything with zero bytes. `nan` and `inf` are numbers here.
//!
//! A last line that breaks off, with fewer cells than the others and no line's end, is left out, and the layout says so.

mod detect;
mod dialect;
mod gzip;
mod head;
mod lines;
mod lvm;
mod sink;
mod source;
mod stamp;

pub(crate) use sink::create;
pub(crate) use source::open;
pub use stamp::calendar_ns;
pub(crate) use stamp::{is_universal, seconds, whole as date_and_time_ns};
