//! The time stamps of a stream of text, held against the rate that it is said to have.

use sixaxis_recordings::calendar_ns;

/// Share of a step by which a time stamp may be beside the rate's.
const BESIDE: f64 = 0.5;

/// The stamps of a stream, held against its rate.
#[derive(Default)]
pub struct StreamClock {
    /// The first stamp of a calendar, ns.
    first: Option<i128>,
    before_s: Option<f64>,
    /// Stamps that were not a step behind the one before them.
    pub odd: u64,
}

impl StreamClock {
    /// Takes the next stamp; what is to be said of the first one that is not a step behind the one before it.
    pub fn look(&mut self, stamp_s: f64, sample_rate_hz: f64) -> Option<String> {
        let step_s = stamp_s - self.before_s.replace(stamp_s)?;
        if (step_s * sample_rate_hz - 1.0).abs() <= BESIDE {
            return None;
        }
        self.odd += 1;
        (self.odd == 1).then(|| {
            format!(
                "the time stamp is {step_s:.6} s behind the one before, and at --rate {sample_rate_hz} it is {:.6} s: are rows missing, or is the rate another? Samples are taken as evenly spaced",
                1.0 / sample_rate_hz
            )
        })
    }

    /// A stamp as it stands in a line: a number, or a time of a calendar, of which seconds since the first are taken.
    pub fn read(&mut self, cell: &str, size_si: f64) -> Option<f64> {
        if let Ok(number) = cell.parse::<f64>() {
            return number.is_finite().then_some(number * size_si);
        }
        let now = calendar_ns(cell)?;
        Some((now - *self.first.get_or_insert(now)) as f64 * 1e-9)
    }
}
