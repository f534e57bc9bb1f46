//! Time stamps, one after the other.

/// Steps from which a distance between two stamps is a gap: it would be filled with invention.
const GAP_STEPS: f64 = 2.5;
/// Departure of a step from the even one, relative, from which it counts as uneven.
const UNEVEN: f64 = sixaxis_core::recording::STEP_TOLERANCE;

/// Stamps after which the mean step is held against the stated one.
const STEPS_FOR_A_RATE: u64 = 1000;
/// Relative difference of the two that is put up with: two clocks of a part in a thousand are two statements.
const RATE_TOLERANCE: f64 = 1e-3;

/// What the stamps have said so far.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Stamps {
    /// Stamps taken.
    pub count: u64,
    /// The first, s.
    pub first_s: f64,
    /// The last, s.
    pub last_s: f64,
    /// Steps that depart from the even one by more than a hundredth of it.
    pub uneven: u64,
    /// Largest departure of a stamp from an even clock that starts with the first, s.
    pub largest_departure_s: f64,
}

impl Stamps {
    /// Takes the next stamp, s, where samples are `step_s` apart; an infinite step lets anything pass that advances.
    ///
    /// # Errors
    /// A sentence, to which the caller adds the file: a stamp that is not a finite number or does not advance, a gap, and, after
    /// a thousand, a mean step that is not the one stated.
    pub fn take(&mut self, stamp_s: f64, step_s: f64) -> Result<(), String> {
        let sample = self.count;
        if !stamp_s.is_finite() {
            return Err(format!(
                "sample {sample}: the time stamp {stamp_s} is not a finite number"
            ));
        }
        if sample == 0 {
            self.first_s = stamp_s;
        } else {
            let step = stamp_s - self.last_s;
            if step <= 0.0 {
                return Err(format!(
                    "sample {sample}: the time stamp {stamp_s} s does not come after {} s",
                    self.last_s
                ));
            }
            if step_s.is_finite() {
                if step > GAP_STEPS * step_s {
                    return Err(format!(
                        "sample {sample}: a gap of {step:.6} s, where samples are {step_s:.6} s apart; decouple the parts before and after it by themselves"
                    ));
                }
                if (step - step_s).abs() > UNEVEN * step_s {
                    self.uneven += 1;
                }
                let even = self.first_s + sample as f64 * step_s;
                self.largest_departure_s = self.largest_departure_s.max((stamp_s - even).abs());
            }
        }
        self.count += 1;
        self.last_s = stamp_s;
        // Jitter cancels over a thousand steps; another rate does not.
        if step_s.is_finite() && self.count == STEPS_FOR_A_RATE {
            let mean_s = (self.last_s - self.first_s) / (self.count - 1) as f64;
            if (mean_s / step_s - 1.0).abs() > RATE_TOLERANCE {
                return Err(format!(
                    "by its time stamps it has {:.3} samples per second, not {:.3}; state the rate that is right",
                    1.0 / mean_s,
                    1.0 / step_s
                ));
            }
        }
        Ok(())
    }

    /// Samples per second on the average.
    #[must_use]
    pub fn mean_rate_hz(&self) -> Option<f64> {
        (self.count > 1).then(|| (self.count - 1) as f64 / (self.last_s - self.first_s))
    }
}

#[cfg(test)]
mod tests {
    use super::Stamps;

    #[test]
    fn another_rate_is_refused() {
        let stamps: Vec<f64> = (0..1200).map(|k| f64::from(k) * 1.002e-3).collect();
        assert!(all(&stamps, 1e-3).is_err());
        assert!(all(&stamps, 1.002e-3).is_ok());
    }

    fn all(stamps: &[f64], step_s: f64) -> Result<Stamps, String> {
        let mut seen = Stamps::default();
        for stamp in stamps {
            seen.take(*stamp, step_s)?;
        }
        Ok(seen)
    }

    #[test]
    fn even_uneven_and_broken() {
        let even = all(&[5.0, 5.1, 5.2, 5.3], 0.1).expect("even");
        assert_eq!(even.uneven, 0);
        assert!((even.mean_rate_hz().expect("a rate") - 10.0).abs() < 1e-9);
        let jitter = all(&[0.0, 0.1, 0.21, 0.3], 0.1).expect("jitter is no gap");
        assert_eq!(jitter.uneven, 2);
        assert!((jitter.largest_departure_s - 0.01).abs() < 1e-12);
        for broken in [[0.0, 0.1, 0.4], [0.0, 0.1, 0.1], [0.0, f64::NAN, 0.2]] {
            assert!(all(&broken, 0.1).is_err(), "{broken:?}");
        }
    }
}
