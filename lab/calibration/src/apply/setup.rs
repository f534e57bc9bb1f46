//! What is known of one recording beside its samples, and from where.

use std::path::Path;

use crate::calibration::Calibration;
use crate::conditioning::high_pass::{BASELINE, LONGEST_REST_S};
use anyhow::{Context, Result, bail};
use glam::DVec3;
use sixaxis_core::aided::{Aid, Bound, ErrorFilter, bound};
use sixaxis_core::decouple::uncertainty::{ChannelNoise, Covariance, SampleUncertainty};
use sixaxis_core::{Gains, LIMBS, LimbSet, Parameters, Scheme, Sensor, Settings};
use sixaxis_recordings::session::{Channels, Entry, SessionFile};
use sixaxis_recordings::unit::STANDARD_GRAVITY_M_S2;

use super::conditioning_stream::{self, ConditioningConfig};
use super::statements::{list, other_signs, overruled, same_sensor, stated_down};

/// What the user says of the recording; each overrules the session, which overrules the calibration.
#[derive(Debug, Clone, Default)]
pub struct Overrides {
    /// c_i, N/V: none, one or nine.
    pub gain_n_per_v: Vec<f64>,
    /// Samples per second.
    pub rate_hz: Option<f64>,
    /// Where down is in the sensor's axes at rest.
    pub down: Option<[f64; 3]>,
    /// Names of the limbs' channels.
    pub limbs: Option<[String; LIMBS]>,
    /// Unit of the limbs' channels where the file does not say.
    pub limbs_unit: Option<String>,
}

/// Everything but the samples.
#[derive(Debug, Clone)]
pub struct Setup {
    /// Lengths and the gains in use.
    pub sensor: Sensor,
    /// The 25 parameters.
    pub parameters: Parameters,
    /// Stiffness of each limb over the mean one's, where the calibration knows it.
    pub stiffness_ratio: [f64; LIMBS],
    /// Half a limb's mass over the seismic mass.
    pub rod_mass: f64,
    /// g in ground axes, m/s^2.
    pub gravity_ground_m_s2: DVec3,
    /// Names and units of the channels.
    pub channels: Channels,
    /// Samples per second, if anybody but the file says it.
    pub rate_hz: Option<f64>,
    /// Limit of the converter, V.
    pub full_scale_v: f64,
    /// What is to be done to the voltages because of how they were recorded.
    pub conditioning: ConditioningConfig,
    /// Frequency of the drive, Hz, where a session states one of this recording.
    pub drive_hz: Option<f64>,
    /// Whether the session takes a line off its runs, which is known only when a run is over.
    pub detrends: bool,
    /// What was taken for granted, in sentences.
    pub notes: Vec<String>,
}

impl Setup {
    /// Puts together what calibration, session and user say. `recording` is none for a stream.
    ///
    /// # Errors
    /// A session of another sensor, a recording that the session does not have, gains that nobody says, that are neither one nor nine
    /// or cannot be, a direction without length.
    pub fn new(
        calibration: &Calibration,
        session: Option<&SessionFile>,
        recording: Option<&Path>,
        overrides: &Overrides,
    ) -> Result<Self> {
        let mut notes = Vec::new();
        let entry = match (session, recording) {
            (Some(file), Some(path)) => Some(entry_of(file, path)?),
            _ => None,
        };
        if let Some(file) = session {
            same_sensor(calibration, file)?;
        }
        if let (Some(file), Some(entry)) = (session, entry) {
            notes.extend(overruled(file, entry, overrides));
            let own = recording.and_then(|path| file.namesake(entry, path));
            notes.extend(own.map(|own| {
                format!(
                    "it is taken for the {} of {}, whose gains, rate and direction of gravity are used: the name is the same, the file is not",
                    own.display(),
                    file.path.display()
                )
            }));
        }
        let mut sensor = calibration.sensor();
        match (overrides.gain_n_per_v.as_slice(), session, entry) {
            ([], Some(file), Some(entry)) => {
                let gains = entry
                    .gain_n_per_v
                    .unwrap_or(file.session.sensor.gain_n_per_v);
                sensor.gains = Gains {
                    gain_n_per_v: gains.each(),
                };
            }
            // The amplifiers may have been switched since, and nothing in the voltages tells.
            ([], ..) => bail!(
                "nobody says the gains of this recording's amplifier ranges: give --gain, or the --session that has the recording; the \
                 session of the calibration has {} N/V by default",
                list(&sensor.gains.gain_n_per_v)
            ),
            ([one], ..) => sensor.gains = Gains::uniform(*one),
            (several, ..) => match <[f64; LIMBS]>::try_from(several) {
                Ok(gain_n_per_v) => sensor.gains = Gains { gain_n_per_v },
                Err(_) => bail!(
                    "--gain: {} numbers; give one or nine (a decimal mark is a point)",
                    several.len()
                ),
            },
        }
        sensor.gains.validate().context("--gain")?;
        notes.extend(other_signs(&calibration.sensor().gains, &sensor.gains));
        let down = match overrides.down {
            Some(down) => Some(("--down", down)),
            None => entry.and_then(stated_down),
        };
        let gravity_ground_m_s2 = match down {
            Some((key, down)) => {
                let down = DVec3::from_array(down);
                if !(down.length().is_finite() && down.length() > 1e-6) {
                    bail!("{key}: {down} has no direction");
                }
                let stated = session.and_then(|file| file.session.stated_gravity_m_s2());
                let of_the_day = calibration.provenance.gravity_m_s2;
                down.normalize() * stated.or(of_the_day).unwrap_or(STANDARD_GRAVITY_M_S2)
            }
            None => {
                notes.push(
                    "nobody says where down is: gravity is taken not to turn in the sensor (--down X,Y,Z or --session)"
                        .to_owned(),
                );
                DVec3::ZERO
            }
        };
        let mut channels = match (session, entry) {
            (Some(file), Some(entry)) => entry
                .channels
                .clone()
                .unwrap_or_else(|| file.session.channels.clone()),
            _ => calibration.channels.clone(),
        };
        channels.state(overrides.limbs.as_ref(), overrides.limbs_unit.as_ref());
        let stages = session.map(|file| &file.session.preprocessing);
        let amplifier_high_pass_hz = match session {
            Some(file) => file.session.preprocessing.amplifier_high_pass_hz,
            // The amplifiers are those of the calibration unless somebody says otherwise.
            None => calibration.sensor.amplifier_high_pass_hz,
        };
        notes.extend(amplifier_high_pass_hz.map(|corner_hz| {
            format!(
                "the amplifiers' high-pass of {corner_hz} Hz is undone about the level at rest, whose noise becomes a ramp: as large as a channel's noise after {:.0} s where {BASELINE} samples of rest come first, and after ten times as long where a hundred times as many do \
                 ({LONGEST_REST_S} s are taken at most)",
                (BASELINE as f64).sqrt() / (core::f64::consts::TAU * corner_hz)
            )
        }));
        let cross_talk = calibration.cross_talk(&sensor).context("cross-talk")?;
        Ok(Self {
            sensor,
            parameters: calibration.parameters(),
            stiffness_ratio: (calibration.limbs.as_ref())
                .map_or([1.0; LIMBS], |limbs| limbs.stiffness_ratio),
            rod_mass: (calibration.limbs.as_ref()).map_or(0.0, |limbs| limbs.rod_mass),
            gravity_ground_m_s2,
            rate_hz: overrides
                .rate_hz
                .or(entry.and_then(|entry| entry.sample_rate_hz)),
            full_scale_v: calibration.sensor.full_scale_v,
            conditioning: ConditioningConfig {
                delays_s: channels
                    .limbs_lag_us
                    .map(|delays| delays.each().map(|us| us * 1e-6)),
                amplifier_high_pass_hz,
                cross_talk,
                outliers: stages.and_then(|stages| stages.outliers.settings().copied()),
                ..ConditioningConfig::default()
            },
            drive_hz: entry.and_then(|entry| entry.frequency_hz),
            detrends: stages.is_some_and(|stages| stages.detrend.settings().is_some()),
            channels,
            notes,
        })
    }

    /// A stream that says how well samples are known, beside the decoupler with these settings.
    ///
    /// # Errors
    /// A calibration that does not say how well its parameters are known, or says what cannot be; a low-pass that the sample
    /// rate does not allow.
    pub fn uncertainty(
        &self,
        calibration: &Calibration,
        settings: &Settings,
        excluded: LimbSet,
    ) -> Result<SampleUncertainty> {
        let (covariance, noise) = self
            .errors(calibration, settings)
            .context("--uncertainty")?;
        SampleUncertainty::new(
            &self.sensor,
            &self.parameters,
            settings,
            excluded,
            &covariance,
            &noise,
        )
        .context("--uncertainty")
    }

    /// How well the calibration's parameters are known and how noisy its channels are after conditioning.
    fn errors(
        &self,
        calibration: &Calibration,
        settings: &Settings,
    ) -> Result<(Covariance, ChannelNoise)> {
        let propagated = calibration
            .covariance
            .propagated
            .as_ref()
            .context("the calibration has no covariance of all parameters; calibrate again")?;
        let covariance = propagated
            .total()
            .context("the calibration's covariance is not 25 by 25")?;
        let noise = ChannelNoise {
            white_v: propagated.channel_noise_v,
            correlation: conditioning_stream::noise_correlation(
                &self.conditioning,
                settings.sample_rate_hz,
            )?,
        };
        Ok((covariance, noise))
    }

    /// A filter that says how well rate and attitude are known, beside the decoupler with these settings, and the channels' noise.
    ///
    /// # Errors
    /// As [`Self::uncertainty`].
    pub fn error_filter(
        &self,
        calibration: &Calibration,
        settings: &Settings,
        excluded: LimbSet,
        down_deviation_rad: f64,
    ) -> Result<(ErrorFilter, ChannelNoise)> {
        let (covariance, noise) = self.errors(calibration, settings)?;
        let mut filter = ErrorFilter::new(
            &self.sensor,
            &self.parameters,
            settings,
            &covariance,
            &noise,
            down_deviation_rad,
        )?;
        filter.set_excluded(excluded).context("--excluded")?;
        Ok((filter, noise))
    }

    /// What aids that come again and again leave open before the next, each with the time from one to the next, s. Nothing where a high-pass is
    /// undone: zeros wander further and further.
    ///
    /// # Errors
    /// As [`Self::uncertainty`].
    pub fn bound(
        &self,
        calibration: &Calibration,
        settings: &Settings,
        excluded: LimbSet,
        aids: &[(Aid, f64)],
    ) -> Result<Option<Bound>> {
        if self.conditioning.amplifier_high_pass_hz.is_some() {
            return Ok(None);
        }
        let (_, noise) = self.errors(calibration, settings)?;
        Ok(bound::steady(
            &self.sensor,
            &self.parameters,
            settings,
            &noise,
            excluded,
            aids,
        )?)
    }

    /// The decoupler's settings at a rate.
    pub fn settings(&self, sample_rate_hz: f64, scheme: Scheme) -> Settings {
        Settings {
            scheme,
            stiffness_ratio: self.stiffness_ratio,
            rod_mass: self.rod_mass,
            gravity_ground_m_s2: self.gravity_ground_m_s2,
            ..Settings::new(sample_rate_hz)
        }
    }
}

fn entry_of<'a>(file: &'a SessionFile, recording: &Path) -> Result<&'a Entry> {
    file.entry(recording).with_context(|| {
        format!(
            "{}: no recording {} in it; without --session, give --gain, --down and --rate as needed",
            file.path.display(),
            recording.display()
        )
    })
}
