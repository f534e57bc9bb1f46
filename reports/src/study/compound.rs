//! The compound runs of Tables 4 to 6, decoupled in several ways and compared.

use std::borrow::Cow;

use anyhow::{Context, Result};
use rayon::prelude::*;
use sixaxis_calibration::conditioning::Conditioned;
use sixaxis_calibration::steps::FourSteps;
use sixaxis_core::decouple::rest_to_rest;
use sixaxis_core::{LIMBS, Parameters, Scheme};
use sixaxis_props::truth;
use sixaxis_props::truth::InCore;
use sixaxis_recordings::session::Role;
use sixaxis_reference::laboratory::Laboratory;
use sixaxis_reference::laboratory::recording::SimulatedRecording;
use sixaxis_reference::motion::SimulatedRun;
use sixaxis_reference::paper;
use sixaxis_reference::rig::run::Mounting;

use super::decoupling::{
    SixSeries, decouple, difference, harmonic, largest_error, peaks, six_series, standards, truth,
};
use super::results::{Comparison, Compound, Correction, Gravity, ParameterSet, Standard};
use super::session::{self, Preset};
use super::simulations::Simulations;

/// Number of the first compound run in the laboratory's count of runs: its random streams do not depend on how many
/// trials the steps had.
const FIRST_RUN: usize = 1000;
/// Decimation of a compound run to the 10 kHz at which Tables 4 to 6 are compared without errors.
pub const COMPARED_DIVISOR: usize = 2;
/// With errors all 20 kHz are kept: at a given noise of one sample, a higher rate is a quieter channel.
pub const LABORATORY_DIVISOR: usize = 1;

/// Schemes whose own errors are judged.
pub const SCHEMES: [Scheme; 3] = [Scheme::Heun, Scheme::HeunSubstepped, Scheme::AdamsMoulton4];

/// Compares all runs of one mounting as a laboratory records them, every `divisor`-th sample of them.
///
/// # Errors
/// Those of recording and decoupling, with the run.
pub fn study(
    simulations: &Simulations,
    mounting: Mounting,
    divisor: usize,
    laboratory: &Laboratory,
    conditioning: Preset,
    ways: &[Way],
) -> Result<Vec<Compound>> {
    let (full, halved) = match mounting {
        Mounting::AxisVertical => (&simulations.compound, &simulations.compound_halved),
        Mounting::AxisLevel => (&simulations.axis_level, &simulations.axis_level_halved),
    };
    full.iter()
        .enumerate()
        .map(|(place, full)| {
            Case {
                run: full.decimated(divisor),
                halved: halved.get(place).map(|run| run.decimated(divisor)),
                index: table_index(full),
                mounting,
                laboratory,
                conditioning,
            }
            .compare(ways)
            .with_context(|| format!("compound run at {} Hz", full.motion.frequency_hz))
        })
        .collect()
}

/// Which of Tables 4 to 6 a compound run belongs to.
fn table_index(run: &SimulatedRun) -> usize {
    paper::COMPOUND_TABLES
        .iter()
        .position(|table| table.frequency_hz == run.motion.frequency_hz)
        .unwrap_or_default()
}

/// Parameter sets and schemes with which every compound run is decoupled.
///
/// The laboratory knows from its mounting whether gravity turns in the shell; where it does not, it leaves gravity
/// out, as the paper does: reckoning with it would only let errors of the attitude in.
pub fn ways(
    truth: &Parameters,
    found: &FourSteps,
    repeated: Option<&FourSteps>,
    gravity: Gravity,
) -> Vec<Way> {
    let design = truth::design_parameters();
    let way = |set, parameters, scheme| Way {
        set,
        parameters,
        scheme,
        gravity,
        correction: Correction::OpenLoop,
    };
    if gravity == Gravity::Neglected {
        // The laboratory: one scheme will do, its errors are larger than any scheme's. Before and after are treated alike.
        return [
            (ParameterSet::Design, design),
            (ParameterSet::Identified, found.used()),
            (ParameterSet::True, *truth),
        ]
        .into_iter()
        .flat_map(|(set, parameters)| {
            let open = way(set, parameters, Scheme::HeunSubstepped);
            let corrected = Way {
                correction: Correction::RestToRest,
                ..open
            };
            [open, corrected]
        })
        .collect();
    }
    let mut ways = vec![way(ParameterSet::Design, design, Scheme::Heun)];
    let mut sets = vec![
        (ParameterSet::Identified, found.used()),
        (ParameterSet::True, *truth),
    ];
    sets.extend(repeated.map(|r| (ParameterSet::Repeated, r.used())));
    for (set, parameters) in sets {
        for scheme in SCHEMES {
            ways.push(way(set, parameters, scheme));
        }
    }
    ways.push(Way {
        set: ParameterSet::True,
        parameters: *truth,
        scheme: Scheme::AdamsMoulton4,
        gravity: Gravity::Neglected,
        correction: Correction::OpenLoop,
    });
    ways
}

/// With the true parameters by every scheme: what is left is the scheme's own.
pub fn ways_of_schemes(truth: &Parameters) -> Vec<Way> {
    SCHEMES
        .map(|scheme| Way {
            set: ParameterSet::True,
            parameters: *truth,
            scheme,
            gravity: Gravity::Kept,
            correction: Correction::OpenLoop,
        })
        .to_vec()
}

/// One way of decoupling a run.
#[derive(Debug, Clone, Copy)]
pub struct Way {
    /// Which parameters.
    pub set: ParameterSet,
    /// Their values.
    pub parameters: Parameters,
    /// Which scheme.
    pub scheme: Scheme,
    /// Whether gravity is reckoned with.
    pub gravity: Gravity,
    /// What is done about drift.
    pub correction: Correction,
}

/// One compound run with everything that is decoupled from it.
pub struct Case<'a> {
    /// The run at the sample rate of the comparison.
    pub run: SimulatedRun,
    /// The same with the simulator's step halved, if that was simulated.
    pub halved: Option<SimulatedRun>,
    /// Which run of the paper.
    pub index: usize,
    /// How it hangs.
    pub mounting: Mounting,
    /// The laboratory that records it.
    pub laboratory: &'a Laboratory,
    /// How it is conditioned.
    pub conditioning: Preset,
}

impl Case<'_> {
    /// Records and cleans the run.
    ///
    /// # Errors
    /// Those of the conditioning.
    pub fn record(&self, run: &SimulatedRun) -> Result<(SimulatedRecording, Conditioned)> {
        let recording = self.laboratory.record(run, FIRST_RUN + self.index);
        let run = [(recording.clone(), Role::Validation)];
        let mut trials = session::prepare(run, self.conditioning)?.campaign.trials;
        let (_, conditioned) = trials.pop().context("the run")?;
        Ok((recording, conditioned))
    }

    /// Voltages ready to be decoupled in this way.
    ///
    /// # Errors
    /// Those of the detrending.
    pub fn voltages<'v>(
        &self,
        recording: &SimulatedRecording,
        conditioned: &'v Conditioned,
        way: &Way,
    ) -> Result<Cow<'v, [[f64; LIMBS]]>> {
        if way.correction == Correction::OpenLoop {
            return Ok(Cow::Borrowed(&conditioned.voltage_v));
        }
        let (rows, _) = rest_to_rest::detrend(
            &recording.sensor(),
            &way.parameters,
            // Plain Heun finds the line as well as any: its error is a thousandth of the noise's.
            &recording.settings(Scheme::Heun),
            &conditioned.voltage_v,
        )?;
        Ok(Cow::Owned(rows))
    }

    /// Decouples with each parameter set and scheme and compares.
    ///
    /// # Errors
    /// Those of recording and decoupling.
    pub fn compare(&self, ways: &[Way]) -> Result<Compound> {
        let truth = truth(&self.run);
        let (recording, conditioned) = self.record(&self.run)?;
        let standards = standards(&conditioned);
        let comparisons = ways
            .par_iter()
            .map(|way| {
                let voltages = self.voltages(&recording, &conditioned, way)?;
                let samples = decouple(
                    &recording,
                    &voltages,
                    &way.parameters,
                    way.scheme,
                    way.gravity,
                )?;
                let ours = six_series(&samples);
                Ok([
                    (Standard::Truth, &truth),
                    (Standard::Instruments, &standards),
                ]
                .map(|(against, standard)| Comparison {
                    parameters: way.set,
                    scheme: way.scheme,
                    gravity: way.gravity,
                    correction: way.correction,
                    against,
                    error: largest_error(&ours, standard),
                }))
            })
            .collect::<Result<Vec<_>>>()?;
        let amplitude = core::array::from_fn(|i| {
            let (c, s) = harmonic(&truth[i], &self.run);
            c.hypot(s)
        });
        Ok(Compound {
            table: paper::COMPOUND_TABLES[self.index].number,
            frequency_hz: self.run.motion.frequency_hz,
            mounting: self.mounting,
            sample_rate_hz: self.run.sample_rate_hz,
            peak: peaks(&truth),
            amplitude,
            comparisons: comparisons.into_iter().flatten().collect(),
            reference_error: match &self.halved {
                Some(halved) => self.reference_error(halved)?,
                None => [f64::NAN; 6],
            },
        })
    }

    /// How much the difference between decoupled and true accelerations changes when the simulator's step is halved:
    /// with perfect recordings, true parameters and a scheme whose own error is far smaller.
    fn reference_error(&self, halved: &SimulatedRun) -> Result<[f64; 6]> {
        let perfect = Laboratory::noise_free(self.laboratory.sensor);
        let error = |run: &SimulatedRun| -> Result<(SixSeries, SixSeries)> {
            let recording = perfect.record(run, FIRST_RUN + self.index);
            let samples = decouple(
                &recording,
                &recording.voltage_v,
                &truth::parameters(&perfect.sensor),
                Scheme::AdamsMoulton4,
                Gravity::Kept,
            )?;
            let (ours, truth) = (six_series(&samples), truth(run));
            Ok((difference(&ours, &truth), truth))
        };
        let (full, truth) = error(&self.run)?;
        let (halved, _) = error(halved)?;
        let (change, peak) = (peaks(&difference(&full, &halved)), peaks(&truth));
        Ok(core::array::from_fn(|i| change[i] / peak[i]))
    }
}
