//! A validation run decoupled with a calibration, beside the simulator's state.

use glam::DVec3;
use sixaxis_calibration::calibrate::CalibratedSession;
use sixaxis_calibration::calibration::Calibration;
use sixaxis_calibration::prepare::VALIDATION_CORNER;
use sixaxis_core::decouple::rest_to_rest;
use sixaxis_core::decouple::uncertainty::{ChannelNoise, SampleUncertainty};
use sixaxis_core::dsp::butterworth::{self, Section};
use sixaxis_core::dsp::continued::zero_phase;
use sixaxis_core::{Decoupler, LIMBS, LimbSet, Parameters, Scheme, Sensor, Settings};
use sixaxis_recordings::session::LowPass;
use sixaxis_reference::laboratory::session::SimulatedSession;
use sixaxis_reference::motion::TrueMotion;

/// The run: 3 Hz, the middle one of Tables 4 to 6.
pub const RUN: &str = "compound-02";

/// [`RUN`], ready to be decoupled.
pub struct ValidationRun<'a> {
    /// The simulator's state at every sample.
    pub truth: &'a [TrueMotion],
    /// Gravity that acts, m/s^2, ground axes.
    pub gravity_m_s2: DVec3,
    calibration: &'a Calibration,
    sensor: Sensor,
    parameters: Parameters,
    settings: Settings,
    /// Conditioned voltages without cross-talk, V.
    rows: Vec<[f64; LIMBS]>,
    /// Voltages as recorded without cross-talk, V.
    recorded_v: Vec<[f64; LIMBS]>,
    /// The low-pass that the voltages have passed both ways.
    low_pass: Vec<Section>,
}

impl<'a> ValidationRun<'a> {
    /// Of what was judged; none where the run is missing or could not be conditioned.
    pub fn of(
        judged: &CalibratedSession,
        calibration: &'a Calibration,
        played: &'a SimulatedSession,
    ) -> Option<Self> {
        let (trial, conditioned) = judged
            .recordings
            .iter()
            .find(|(trial, _)| trial.name.starts_with(RUN))?;
        let recording = played.recordings.iter().find(|r| r.name == RUN)?;
        let sensor = trial.sensor(calibration.sensor().geometry);
        let cross_talk = calibration.cross_talk(&sensor).ok()?;
        let without = |rows: &[[f64; LIMBS]]| -> Vec<_> {
            let undone =
                |row: &[f64; LIMBS]| cross_talk.map_or(*row, |cross_talk| cross_talk.undo(row));
            rows.iter().map(undone).collect()
        };
        let corner_hz = VALIDATION_CORNER * trial.frequency_hz;
        let order = LowPass::default().order;
        Some(Self {
            truth: &recording.truth,
            gravity_m_s2: recording.true_gravity_ground_m_s2,
            calibration,
            parameters: calibration.parameters(),
            settings: Settings {
                rod_mass: calibration.limbs.map_or(0.0, |limbs| limbs.rod_mass),
                ..trial.settings(Scheme::HeunSubstepped)
            },
            sensor,
            rows: without(&conditioned.as_ref()?.voltage_v),
            recorded_v: without(&recording.voltage_v),
            low_pass: butterworth::low_pass(order, corner_hz, trial.sample_rate_hz).ok()?,
        })
    }

    /// Corrected from rest to rest: samples with the change of the specific force and the angular acceleration there, in sensor axes.
    pub fn corrected(&self) -> Option<Vec<(usize, [DVec3; 2])>> {
        let (sensor, parameters, settings) = (&self.sensor, &self.parameters, &self.settings);
        let (rows, _) = rest_to_rest::detrend(sensor, parameters, settings, &self.rows).ok()?;
        let mut decoupler = Decoupler::new(sensor, parameters, settings).ok()?;
        let stated_m_s2 = settings.gravity_ground_m_s2;
        let mut ours = Vec::with_capacity(rows.len());
        for row in &rows {
            let Some(out) = decoupler.push(row).ok()? else {
                continue;
            };
            let back = out.attitude.inverse();
            ours.push((
                out.sample as usize,
                [
                    back * (out.linear_ground_m_s2 - stated_m_s2) + stated_m_s2,
                    back * out.angular_ground_rad_s2,
                ],
            ));
        }
        Some(ours)
    }

    /// Open loop, in ground axes, of voltages as they were recorded: the error of each acceleration of each sample over the standard
    /// deviation that is stated for it.
    pub fn over_deviation(&self) -> Option<Vec<[f64; 6]>> {
        let propagated = self.calibration.covariance.propagated.as_ref()?;
        let (sensor, parameters, settings) = (&self.sensor, &self.parameters, &self.settings);
        let mut decoupler = Decoupler::new(sensor, parameters, settings).ok()?;
        let mut uncertainty = SampleUncertainty::new(
            sensor,
            parameters,
            settings,
            LimbSet::EMPTY,
            &propagated.total()?,
            &ChannelNoise::white(propagated.channel_noise_v),
        )
        .ok()?;
        let mut errors = Vec::with_capacity(self.recorded_v.len());
        for row in &self.recorded_v {
            let Some(out) = decoupler.push(row).ok()? else {
                continue;
            };
            let at = out.sample as usize;
            let stated = uncertainty.push(self.recorded_v.get(at)?, &out).ok()?;
            let truth = self.truth.get(at)?;
            let [linear, angular] = [
                out.linear_ground_m_s2 - truth.linear_ground_m_s2,
                out.angular_ground_rad_s2 - truth.angular_ground_rad_s2,
            ];
            let mut over = stated.accelerations();
            let off = linear.to_array().into_iter().chain(angular.to_array());
            for (over, off) in over.iter_mut().zip(off) {
                *over = off.abs() / *over;
            }
            errors.push(over);
        }
        Some(errors)
    }

    /// Accelerations without what the run's low-pass takes off the voltages.
    pub fn in_band(&self, accelerations: &[[DVec3; 2]]) -> Option<Vec<[DVec3; 2]>> {
        let mut band = accelerations.to_vec();
        for kind in 0..2 {
            for axis in 0..3 {
                let mut series: Vec<f64> = band.iter().map(|row| row[kind][axis]).collect();
                zero_phase(&self.low_pass, &mut series).ok()?;
                for (row, value) in band.iter_mut().zip(series) {
                    row[kind][axis] = value;
                }
            }
        }
        Some(band)
    }
}
