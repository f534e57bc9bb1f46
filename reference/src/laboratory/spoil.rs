//! How each kind of defect acts: on the rig and its instruments as another plan that the session does not know, on the limbs'
//! forces, on the voltages, on the readings, on what is written down. Options of a healthy room act here, too.

use core::f64::consts::TAU;

use glam::{DQuat, DVec3};
use rand::{RngExt, SeedableRng};
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64;
use sixaxis_recordings::session::Role;

use super::Laboratory;
use super::continuous::{at, on_other_clock};
use super::defect::{Defect, Kind};
use super::mount::{Mount, Tilt};
use super::plan::SessionPlan;
use super::recording::SimulatedRecording;
use super::schedule::{PlannedTrial, blended, foreign_sensor, trial_count};
use super::trial::Recorder;
use crate::geometry::LIMBS;
use crate::rig::run::WEDGES;
use crate::sensor::TrueSensor;

/// Random stream of each recording's zeros, from here on.
const ZERO_STREAM: u128 = 1 << 21;
/// Mains, Hz.
const MAINS_HZ: f64 = 50.0;
/// Channels of one card.
const CARD: usize = 3;
/// Play of a hysteresis over the trial's largest force.
const PLAY: f64 = 0.5;

/// The plan that is played, where what is wrong is the rig's, the instruments' or the amplifiers' and the session file has
/// another.
pub(super) fn played(plan: &SessionPlan, defect: Option<&Defect>) -> SessionPlan {
    let mut played = plan.clone();
    let Some(&Defect {
        kind, magnitude, ..
    }) = defect
    else {
        return played;
    };
    match kind {
        Kind::TiltedAxis => played.rig.axis_tilt_deg += magnitude,
        Kind::CentreOffset => played.rig.centre_offset_mm += magnitude,
        Kind::ConnectingRod => played.rig.crank_over_rod += magnitude,
        Kind::AmplifierHighPass => played.chain.amplifier_high_pass_hz += magnitude,
        Kind::MainsHum => played.chain.hum_v += magnitude,
        Kind::GyroscopeLag => {
            played.instruments.gyroscope_bandwidth_hz = if magnitude > 0.0 {
                1.0 / (TAU * magnitude)
            } else {
                0.0
            };
        }
        _ => {}
    }
    played
}

impl Defect {
    /// The magnitude, if it is of this kind; 0 otherwise.
    fn of(&self, kind: Kind) -> f64 {
        if self.kind == kind {
            self.magnitude
        } else {
            0.0
        }
    }

    /// An angle about a direction, rad.
    fn azimuth_rad(&self) -> f64 {
        TAU * f64::from(self.seed) / f64::from(u32::MAX)
    }

    /// The tilt of this many degrees.
    fn tilt(&self) -> Tilt {
        Tilt {
            angle_rad: self.magnitude.to_radians(),
            azimuth_rad: self.azimuth_rad(),
        }
    }

    /// The two channels that are exchanged.
    fn exchanged(&self) -> [usize; 2] {
        [
            self.channel,
            (self.channel + 1 + self.seed as usize % (LIMBS - 1)) % LIMBS,
        ]
    }
}

/// A defect of a kind, or none.
pub(super) fn size_of(defect: Option<&Defect>, kind: Kind) -> f64 {
    defect.map_or(0.0, |defect| defect.of(kind))
}

impl Recorder<'_> {
    /// The defect, if it concerns this recording; a tap and the static record have no number.
    fn here(&self, index: Option<usize>) -> Option<&Defect> {
        let trials = trial_count(self.plan.trials_per_step);
        self.defect
            .filter(|defect| defect.place(trials).holds(index))
    }

    /// The sensor of a recording: another one, partly, or with its zeros elsewhere.
    pub(super) fn sensor_of(&self, index: Option<usize>) -> TrueSensor {
        let mut sensor = self.laboratory.sensor;
        if let Some(defect) = self.here(index)
            && defect.kind == Kind::ForeignTrial
        {
            sensor = blended(&sensor, &foreign_sensor(defect.seed), defect.magnitude);
        }
        let spread_v = self.plan.chain.zero_spread_v;
        if let (true, Some(index)) = (spread_v > 0.0, index) {
            let mut rng = Pcg64::new(u128::from(self.plan.seed), ZERO_STREAM + index as u128);
            for zero in &mut sensor.zero_drift_v {
                let unit: f64 = StandardNormal.sample(&mut rng);
                *zero += spread_v * unit;
            }
        }
        if let Some(defect) = self.defect {
            sensor.zero_drift_v[defect.channel] += defect.of(Kind::ZeroMoved);
        }
        sensor
    }

    /// Exchanges the plugs of two limbs: limb and piezo come along, the amplifier stays.
    pub(super) fn exchange(
        &self,
        index: Option<usize>,
        forces: &mut [[f64; LIMBS]],
        sensor: &mut TrueSensor,
    ) {
        let Some(defect) = self.here(index) else {
            return;
        };
        if defect.kind == Kind::SwappedChannels {
            let [a, b] = defect.exchanged();
            for force in forces {
                force.swap(a, b);
            }
            sensor.scale_per_mass_per_kg.swap(a, b);
            sensor.zero_drift_v.swap(a, b);
        }
    }

    /// Forces per mass, m/s^2, as the channels sense them: changes since the first sample fade, cross over, bend, lag.
    pub(super) fn sensed(
        &self,
        index: Option<usize>,
        forces: &[[f64; LIMBS]],
        sample_rate_hz: f64,
        sensor: &TrueSensor,
    ) -> Vec<[f64; LIMBS]> {
        let Some(&rest) = forces.first() else {
            return Vec::new();
        };
        let defect = self.here(index);
        let size = |kind| size_of(defect, kind);
        let trials = trial_count(self.plan.trials_per_step);
        let hour = index.map_or(1.0, |i| i as f64 / (trials - 1) as f64);
        let mut channels = self.plan.true_channels(hour);
        for share in &mut channels.of_next {
            *share += size(Kind::CrossTalk);
        }
        if let Some(defect) = defect {
            channels.sensitivity[defect.channel] *=
                (1.0 - size(Kind::DeadLimb)) * (1.0 + hour * size(Kind::FadingSensitivity));
        }
        let mut sensed: Vec<[f64; LIMBS]> = forces
            .iter()
            .map(|force| channels.shown(force, &rest, sensor))
            .collect();
        let largest = sensed.iter().flatten().fold(0.0_f64, |a, f| a.max(f.abs()));
        let cubic = size(Kind::CubicNonlinearity);
        if cubic != 0.0 && largest > 0.0 {
            for f in sensed.iter_mut().flatten() {
                *f *= 1.0 - cubic * (*f / largest).powi(2);
            }
        }
        let friction = size(Kind::Hysteresis);
        if friction != 0.0 {
            let play = PLAY * largest;
            let mut follower = [0.0_f64; LIMBS];
            for row in &mut sensed {
                for (f, behind) in row.iter_mut().zip(&mut follower) {
                    *behind = behind.clamp(*f - play, *f + play);
                    *f += friction * (*behind - *f);
                }
            }
        }
        if let Some(defect) = defect
            && defect.kind == Kind::LateCard
        {
            let first = defect.channel / CARD * CARD;
            for limb in first..first + CARD {
                let whole: Vec<f64> = sensed.iter().map(|row| row[limb]).collect();
                for (sample, row) in sensed.iter_mut().enumerate() {
                    row[limb] = at(&whole, sample as f64 - defect.magnitude * sample_rate_hz);
                }
            }
        }
        for row in &mut sensed {
            *row = core::array::from_fn(|i| row[i] + rest[i]);
        }
        sensed
    }

    /// The direction that wedge, flange and workshop make of the stated one.
    pub(super) fn true_direction(&self, trial: &PlannedTrial, mount: &Mount) -> DVec3 {
        let direction = mount.wedge.of(trial.run.direction_ground);
        match (self.defect, trial.wedge) {
            (Some(defect), Some(wedge))
                if defect.kind == Kind::LooseWedge
                    && wedge == defect.channel % WEDGES.len()
                    && trial.role != Role::Validation =>
            {
                defect.tilt().of(direction)
            }
            (Some(defect), _) if defect.kind == Kind::TurnedFlange => {
                let axis = DVec3::AXES[defect.seed as usize % 3];
                DQuat::from_axis_angle(axis, defect.magnitude.to_radians()) * direction
            }
            _ => direction,
        }
    }

    /// What is done to the voltages and to what is written down of them.
    pub(super) fn spoil_voltages(
        &self,
        index: Option<usize>,
        recording: &mut SimulatedRecording,
        laboratory: &Laboratory,
    ) {
        let Laboratory { sensor, chain, .. } = laboratory;
        let rate = recording.sample_rate_hz;
        let gains = &mut recording.gain_n_per_v;
        let voltage_v = &mut recording.voltage_v;
        let limit_v = chain.full_scale_v;
        if self.plan.chain.hum_v > 0.0 {
            let number = index.unwrap_or_default() as u64;
            let phase = TAU * Pcg64::seed_from_u64(self.plan.seed ^ (number << 32)).random::<f64>();
            for (sample, row) in voltage_v.iter_mut().enumerate() {
                let angle = TAU * MAINS_HZ * sample as f64 / rate + phase;
                let hum_v = self.plan.chain.hum_v * angle.sin();
                *row = row.map(|u| (u + hum_v).clamp(-limit_v, limit_v));
            }
        }
        let Some(defect) = self.here(index) else {
            return;
        };
        let (channel, magnitude) = (defect.channel, defect.magnitude);
        // Force per mass in the sensor's terms.
        let signal = |voltage_v: &[[f64; LIMBS]], gains: &[f64; LIMBS], i: usize| {
            let zero = sensor.zero_drift_v[i];
            let peak_v = voltage_v.iter().map(|row| (row[i] - zero).abs());
            peak_v.fold(0.0, f64::max) * gains[i] * sensor.scale_per_mass_per_kg[i]
        };
        match defect.kind {
            // With a share of 0 no recording is concerned.
            Kind::InvertedChannel => voltage_v
                .iter_mut()
                .for_each(|row| row[channel] = -row[channel]),
            Kind::InvertedSmall if magnitude > 0.0 => {
                let signals: [f64; LIMBS] = core::array::from_fn(|i| signal(voltage_v, gains, i));
                let strongest = signals.into_iter().fold(f64::MIN_POSITIVE, f64::max);
                let away = |i: usize| {
                    (signals[i].max(1e-12 * strongest) / strongest / magnitude)
                        .ln()
                        .abs()
                };
                let nearest = (0..LIMBS).min_by(|a, b| away(*a).total_cmp(&away(*b)));
                let i = nearest.unwrap_or(channel);
                // The plug between piezo and amplifier: the amplifier's zero stays.
                voltage_v
                    .iter_mut()
                    .for_each(|row| row[i] = 2.0 * sensor.zero_drift_v[i] - row[i]);
            }
            Kind::ClippedConverter => {
                let zero = sensor.zero_drift_v[channel];
                let peak = voltage_v
                    .iter()
                    .fold(0.0_f64, |a, row| a.max((row[channel] - zero).abs()));
                let most = (1.0 - magnitude) * peak;
                for row in voltage_v {
                    row[channel] = row[channel].clamp(zero - most, zero + most);
                }
            }
            Kind::WrongGain | Kind::WrongGainInTrial => gains[channel] *= magnitude.exp(),
            Kind::MillivoltMixUp => {
                let factor = 10.0_f64.powf(magnitude);
                voltage_v.iter_mut().flatten().for_each(|u| *u *= factor);
            }
            Kind::DriftDuringRun => {
                let strongest = (0..LIMBS)
                    .map(|i| signal(voltage_v, gains, i))
                    .fold(0.0, f64::max);
                let volts = magnitude * strongest
                    / (gains[channel] * sensor.scale_per_mass_per_kg[channel]);
                let samples = voltage_v.len() as f64;
                for (sample, row) in voltage_v.iter_mut().enumerate() {
                    row[channel] =
                        (row[channel] + volts * sample as f64 / samples).clamp(-limit_v, limit_v);
                }
            }
            _ => {}
        }
    }

    /// What is done to the standards' readings, to the sample rate that is written down and to whole records.
    pub(super) fn spoil_readings(&self, index: usize, recording: &mut SimulatedRecording) {
        let Some(defect) = self.here(Some(index)) else {
            return;
        };
        let rate = recording.sample_rate_hz;
        let accelerometer = &mut recording.accelerometer_m_s2;
        let gyroscope = &mut recording.gyroscope_rad_s;
        let magnitude = defect.magnitude;
        let times = |series: &mut Vec<f64>| series.iter_mut().for_each(|x| *x *= magnitude.exp());
        match defect.kind {
            Kind::AccelerometerGain => times(accelerometer),
            Kind::GyroscopeGain => times(gyroscope),
            Kind::WrongScaling if defect.seed % 2 == 0 => times(accelerometer),
            Kind::WrongScaling => times(gyroscope),
            Kind::ReferenceLate | Kind::ReferenceRate => {
                let late_s = defect.of(Kind::ReferenceLate);
                let rate_error = defect.of(Kind::ReferenceRate);
                for series in [accelerometer, gyroscope] {
                    *series = on_other_clock(series, rate, late_s, rate_error);
                }
            }
            Kind::SampleRate => recording.sample_rate_hz *= magnitude.exp(),
            Kind::DroppedSamples => {
                let samples = recording.voltage_v.len();
                let lost = (magnitude * samples as f64).round() as usize;
                let kept = samples.saturating_sub(lost);
                let from = (f64::from(defect.seed) / f64::from(u32::MAX) * kept as f64) as usize;
                let gap = from..(from + lost).min(samples);
                recording.voltage_v.drain(gap.clone());
                accelerometer.drain(gap.clone());
                gyroscope.drain(gap.clone());
                recording.truth.drain(gap);
            }
            _ => {}
        }
    }

    /// The direction of gravity as the session has it, m/s^2.
    pub(super) fn stated_gravity(&self, trial: &PlannedTrial) -> DVec3 {
        let gravity = trial.gravity_ground_m_s2();
        match self.defect {
            Some(defect) if defect.kind == Kind::GravityNotHandled && defect.magnitude > 0.0 => {
                defect.tilt().of(gravity.normalize()) * gravity.length()
            }
            _ => gravity,
        }
    }
}

/// The static record's drift, V, at each share of it from 0 to 1, and a factor for each channel there.
pub(super) fn at_rest(
    plan: &SessionPlan,
    zero_drift_v: [f64; LIMBS],
    defect: Option<&Defect>,
    share: f64,
) -> ([f64; LIMBS], [f64; LIMBS]) {
    let (mut drift, mut factor) = (zero_drift_v, [1.0; LIMBS]);
    let Some(defect) = defect else {
        return (drift, factor);
    };
    let all_day =
        defect.place(trial_count(plan.trials_per_step)) == super::defect::Where::Everywhere;
    let channel = defect.channel;
    drift[channel] += defect.of(Kind::DriftAtRest) * plan.chain.full_scale_v * (share - 0.5);
    match defect.kind {
        Kind::SwappedChannels if all_day => {
            let [a, b] = defect.exchanged();
            drift.swap(a, b);
        }
        Kind::InvertedChannel if all_day => factor[channel] = -1.0,
        Kind::DeadStatic if share < defect.magnitude => factor[channel] = 0.0,
        _ => {}
    }
    (drift, factor)
}
