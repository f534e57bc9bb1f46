//! Channels that stand at one voltage at their crests: an amplifier at the end of its range, where no converter says so.

use sixaxis_core::LIMBS;
use sixaxis_recordings::inspect::listing::brief;

use super::voltages::Voltages;
use crate::diagnosis::flat_top::flat_top;
use crate::diagnosis::raw::step_of;
use crate::series::extent;

/// The pieces of a recording in which each channel went lowest and highest.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct FlatCrests([[Piece; 2]; LIMBS]);

/// A piece, with the largest of its voltages, or of these turned about.
#[derive(Debug, Clone, PartialEq, Default)]
struct Piece {
    crest_v: Option<f64>,
    voltage_v: Vec<f64>,
}

impl FlatCrests {
    /// Takes the next piece.
    pub fn look(&mut self, voltage_v: &Voltages) {
        for (column, [lowest, highest]) in voltage_v.columns.iter().zip(&mut self.0) {
            let (low_v, high_v) = extent(column.iter().copied());
            lowest.take(-low_v, column);
            highest.take(high_v, column);
        }
    }

    /// The channels whose crests are flat, with the voltage at which they stand, of those asked for.
    pub fn told(&self, names: &[String; LIMBS], asked: impl Fn(usize) -> bool) -> Vec<String> {
        let flat = |limb: usize| {
            let mut pieces = self.0[limb].iter().map(|piece| &piece.voltage_v);
            let at_v = pieces.find_map(|series| flat_top(series, step_of(series)))?;
            Some(format!("{} at {} V", names[limb], brief(at_v, 4)))
        };
        (0..LIMBS)
            .filter(|limb| asked(*limb))
            .filter_map(flat)
            .collect()
    }
}

impl Piece {
    /// Keeps one that goes further than any before.
    fn take(&mut self, crest_v: f64, voltage_v: &[f64]) {
        if crest_v.is_finite() && self.crest_v.is_none_or(|kept_v| crest_v > kept_v) {
            self.crest_v = Some(crest_v);
            self.voltage_v.clear();
            self.voltage_v.extend_from_slice(voltage_v);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn told(cut_v: f64) -> Vec<String> {
        let names = core::array::from_fn(|limb| format!("u{}", limb + 1));
        let mut crests = FlatCrests::default();
        // The one that goes furthest is neither the first nor the last.
        for (piece, amplitude_v) in [1.0, 3.0, 3.0, 2.0].into_iter().enumerate() {
            let mut voltage_v = Voltages::default();
            for (limb, column) in voltage_v.columns.iter_mut().enumerate() {
                let at = |sample: usize| {
                    let t = (500 * piece + sample) as f64 / 500.0;
                    let volts: f64 = amplitude_v * (9.0 * t + limb as f64).sin();
                    let volts = if limb == 4 { volts.max(-cut_v) } else { volts };
                    (volts / 3e-4).round() * 3e-4
                };
                column.extend((0..500).map(at));
            }
            crests.look(&voltage_v);
        }
        crests.told(&names, |_| true)
    }

    #[test]
    fn an_amplifier_at_its_end_is_told_and_none_else() {
        assert_eq!(told(2.1), ["u5 at -2.100 V"]);
        assert_eq!(told(3.5), [""; 0]);
    }
}
