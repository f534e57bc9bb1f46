//! The answer, before the reasons.

use crate::study::results::identifiability::{BandBound, Erring, Identifiability, Records};
use sixaxis_page::Block;
use sixaxis_page::number::{scientific, significant};

use super::bound::NOISE_60_DB;
use super::tolerance::first_undetermined;

/// The sentence that users need, and the numbers behind it.
pub fn block(study: &Identifiability) -> Block {
    let paper = study.bound.bands.first();
    let fast = study.bound.bands.iter().find(|band| band.to_hz == 500.0);
    let sd = |band: Option<&BandBound>| band.map_or(f64::NAN, |b| b.three_directions);
    let quiet = NOISE_60_DB / study.bound.noise_over_largest;
    let limit = |erring| {
        [Records::WholeRuns, Records::EvenTurns]
            .into_iter()
            .filter_map(|records| first_undetermined(study, records, erring))
            .fold(f64::INFINITY, f64::min)
    };
    Block::Note(format!(
        "**k/m cannot be had from this campaign; tap the shell.** Step 4 loses its minimum when scale factors are off by {} or \
         zero drifts by {} of full scale, and the instruments are of the 1 % class. Other methods would find little more: from \
         4 to 5 Hz no estimate of ln(k/m) has a standard deviation below about {} with noise of 1 %, or {} with 60 dB, and that \
         with a shell whose motion is known exactly. Up to {} it is {} and {}. Decoupling at the rig's frequencies does not \
         miss k/m; whoever needs it excites the modes.",
        scientific(limit(Erring::Scale), 1),
        scientific(limit(Erring::Drift), 1),
        significant(sd(paper), 2),
        significant(sd(paper) * quiet, 2),
        fast.map_or(String::new(), |b| format!("{} Hz", b.to_hz)),
        scientific(sd(fast), 1),
        scientific(sd(fast) * quiet, 1),
    ))
}
