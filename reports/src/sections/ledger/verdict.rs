//! What became of each claim: by a measured number wherever one can decide, by an argument where none can.

use sixaxis_page::{Basis, Verdict};
use sixaxis_reference::paper;

use super::Found;

/// Half a unit of the last digit that Fig. 7 is read to, Hz.
const READING_HZ: f64 = 0.05;
/// Printed errors follow from printed parameters if each is met within this.
const FOLLOWS: f64 = 0.05;
/// "One order of magnitude" holds for factors from this to this, which are as far from ten on either side.
const ONE_ORDER: (f64, f64) = (3.2, 32.0);
/// A scheme that adds less than this to the paper's largest error integrates well enough.
const INVISIBLE: f64 = 1e-3;
/// An effect of this share of what it acts on wants a correction, and is corrected once a tenth of it is left at most.
const WANTS_CORRECTION: f64 = 0.01;
/// Upper end of the band of steps 2 and 3, Hz.
const LOW_BAND_HZ: f64 = 2.0;
/// Largest sizes that a laboratory may have: lateral over axial stiffness of a limb, noise over a full-scale sine (40 dB).
const ENOUGH: [(&str, f64); 2] = [
    ("flexures that bend", 1e-3),
    ("noise of the channels", 1e-2),
];
/// Output of a common data-acquisition card, V.
const CARD_V: f64 = 10.0;

impl Found {
    /// What became of a claim, and what decides it.
    pub(super) fn verdict(&self, id: &str) -> Option<(Verdict, Basis)> {
        self.measured(id)
            .map(|verdict| (verdict, Basis::Measured))
            .or_else(|| judged(id).map(|verdict| (verdict, Basis::Judged)))
    }

    /// Verdicts that a number decides.
    fn measured(&self, id: &str) -> Option<Verdict> {
        use Verdict::{
            Compatible, Inconsistent, NotReproducible, Reproduced, ReproducedWithCorrection,
        };
        let near = |found: f64, printed: f64| (found - printed).abs() <= READING_HZ;
        let close = |found: f64, printed: f64| (found / printed - 1.0).abs() < 1e-3;
        let mended = |left_alone: f64, undone: f64| {
            left_alone > WANTS_CORRECTION && undone < 0.1 * left_alone
        };
        let (defects, of_axes) = (&self.defects, self.arithmetic.inertia_rank);
        // What it is if the numbers say yes, and what if they say no.
        let (holds, yes, no) = match id {
            // One convention for the slider's amplitude and another for the pinion's.
            "fig7-linear" => {
                let holds = near(self.crossing_hz.linear, self.printed_hz.0);
                (holds, Compatible, NotReproducible)
            }
            "fig7-angular" => {
                let holds = near(self.crossing_hz.angular, self.printed_hz.1);
                (holds, Compatible, NotReproducible)
            }
            // Along the one direction, which the text does not state; the angular one at the true amplitude, which Fig. 7 is not read at.
            "linear-at-2-hz" => {
                let holds = self.linear_m_s2[0] < paper::LINEAR_THRESHOLD_M_S2;
                (holds, Compatible, NotReproducible)
            }
            "angular-at-2-hz" => {
                let holds = self.angular_rad_s2[0] < paper::ANGULAR_THRESHOLD_RAD_S2;
                (holds, Compatible, NotReproducible)
            }
            "linear-at-4-hz" => {
                let holds = self.linear_m_s2[1] > paper::LINEAR_THRESHOLD_M_S2;
                (holds, Reproduced, NotReproducible)
            }
            "fourth-power" => {
                let holds = self.slopes.iter().all(|slope| (slope - 4.0).abs() < 0.05);
                (holds, Reproduced, NotReproducible)
            }
            // For the sensor that was found, at the slider's true amplitude: Fig. 7 is read at twice that.
            "bands" => {
                let mut first = self.arithmetic.thresholds.identified_first.iter();
                let below = first.all(|crossing_hz| *crossing_hz > LOW_BAND_HZ);
                let above = self.linear_m_s2[1] > paper::LINEAR_THRESHOLD_M_S2
                    && self.angular_rad_s2[1] > paper::ANGULAR_THRESHOLD_RAD_S2;
                (below && above, Compatible, Inconsistent)
            }
            "sign" if self.printed_sign_has_minimum => (true, Reproduced, Inconsistent),
            "sign" => {
                let holds = self.other_sign_finds_truth;
                (holds, ReproducedWithCorrection, Inconsistent)
            }
            "three-accelerations" => {
                let holds = self.arithmetic.scale_rank == [6, 9];
                (holds, Reproduced, NotReproducible)
            }
            "two-rotations" => (of_axes[0] == 6, Reproduced, Inconsistent),
            "step-2" => (self.largest_scale_error < 5e-6, Reproduced, NotReproducible),
            "step-3" => {
                let (left_alone, undone) = (
                    defects.gyroscope_lag_left_alone,
                    defects.gyroscope_lag_undone,
                );
                match left_alone > WANTS_CORRECTION {
                    true => (
                        mended(left_alone, undone),
                        ReproducedWithCorrection,
                        NotReproducible,
                    ),
                    false => (true, Reproduced, NotReproducible),
                }
            }
            "step-4" => (self.stiffness_is_determined, Reproduced, NotReproducible),
            "targets" => {
                let holds = self.worst_target < 0.025;
                (holds, ReproducedWithCorrection, NotReproducible)
            }
            "order-of-magnitude" => {
                let once = |t: [f64; 2]| (ONE_ORDER.0..=ONE_ORDER.1).contains(&(t[0] / t[1]));
                let (before, after) = (&self.before, &self.after);
                let holds = once([before.open_loop, after.open_loop])
                    && once([before.corrected, after.corrected]);
                (holds, Reproduced, NotReproducible)
            }
            "before-without-drift" => {
                let holds = self.arithmetic.before_departs <= FOLLOWS;
                (holds, Reproduced, NotReproducible)
            }
            // Noise and hinges, each of a size that a laboratory may have, are enough; which sizes they had is not printed.
            "remaining-errors" => {
                let holds = self.enough(&ENOUGH);
                (holds, Compatible, NotReproducible)
            }
            "improved-euler" => (self.heun < INVISIBLE, Reproduced, NotReproducible),
            // Two of the maxima set the amplitudes.
            "rig" => {
                let holds = close(self.rig.acceleration_g, 9.36)
                    && close(self.rig.rate_deg_s, 3142.86)
                    && close(self.rig.angular_deg_s2, 98_735.80);
                (holds, Compatible, NotReproducible)
            }
            "gyroscope" => {
                let beyond = defects.gyroscope_output_v > CARD_V;
                (beyond, Inconsistent, Compatible)
            }
            "gravity" if defects.gravity_neglected <= WANTS_CORRECTION => {
                (true, Reproduced, NotReproducible)
            }
            "gravity" => {
                let holds = mended(defects.gravity_neglected, defects.gravity_kept);
                (holds, ReproducedWithCorrection, NotReproducible)
            }
            "amplifier" => {
                let holds = mended(defects.amplifier_left_alone, defects.amplifier_undone);
                (holds, ReproducedWithCorrection, NotReproducible)
            }
            _ => return None,
        };
        Some(if holds { yes } else { no })
    }
}

/// Verdicts that an argument decides, which is the claim's reason.
fn judged(id: &str) -> Option<Verdict> {
    Some(match id {
        "largest-error" | "before" | "other-sensors" | "standing-voltages" => {
            Verdict::NotReproducible
        }
        "steps-in-order" => Verdict::ReproducedWithCorrection,
        "slider-sine" | "angular-alone" | "design-lengths" | "one-stiffness"
        | "felt-as-measured" => Verdict::Compatible,
        "parallel" | "order-wording" | "gyroscope-unit" => Verdict::Inconsistent,
        _ => return None,
    })
}
