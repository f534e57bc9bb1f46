//! A trial as it was recorded, checked and projected on its harmonics: what the fit works with instead of samples.

use glam::DVec3;
use nalgebra::DVector;

use super::harmonics::{Grid, Projection, level, mean_square, project, project_stepped};
use super::trial::{Drive, Trial};
use super::{Certificates, WHAT};
use super::{colour, ends, own};
use crate::error::{Error, Result, require, require_finite_row, require_positive, require_samples};
use crate::geometry::LIMBS;
use crate::model::Gains;

/// Last harmonic over the drive's frequency: the run-up of the crank and the squares of the rate lie below.
const HARMONICS_PER_DRIVE: f64 = 8.0;
/// Coordinates above the last harmonic that the noise is told from, at least.
const FEWEST_FOR_NOISE: usize = 64;
/// Smallest standard deviation of noise over a record's largest value: beyond what rounding leaves of one without noise.
const LEAST_NOISE: f64 = 1e-10;
/// Jump from a record's end to its beginning over its largest step.
const LARGEST_JUMP: f64 = 3.0;

/// One trial as it was recorded; nothing filtered. It begins and ends at rest, wherever that is, or, if gravity does not turn in it,
/// holds whole turns of the drive. That an angular trial ends at another angle than it began at is seen where both rests are longer than a
/// few pieces of a fiftieth of a second; it is taken to end at the same one else.
#[derive(Debug, Clone, Copy)]
pub struct Record<'a> {
    /// What the rig did.
    pub drive: Drive,
    /// Samples per second.
    pub sample_rate_hz: f64,
    /// Crank frequency, Hz.
    pub frequency_hz: f64,
    /// c_i in use.
    pub gains: &'a Gains,
    /// Nine voltages per sample, V.
    pub voltage_v: &'a [[f64; LIMBS]],
    /// Accelerometer along the travel, m/s^2, or gyroscope about the axis, rad/s.
    pub standard: &'a [f64],
    /// Frequency up to which the channels' noise is white, Hz: infinite unless they were read between their samples.
    pub limbs_band_hz: f64,
    /// The same of the standard: infinite, too, where it was resampled from a faster clock.
    pub standard_band_hz: f64,
    /// Unit vector of travel and axis in the sensor's axes at rest.
    pub direction_ground: DVec3,
    /// Gravity in the sensor's axes at rest, m/s^2.
    pub gravity_ground_m_s2: DVec3,
}

/// A trial in orthonormal coordinates, on no wedge yet.
#[derive(Debug, Clone)]
pub struct Prepared {
    pub(super) nominal: DVec3,
    pub(super) trial: Trial,
}

impl Record<'_> {
    /// Projects the trial on its harmonics.
    pub(super) fn prepare(&self, certificates: &Certificates) -> Result<Prepared> {
        self.validate()?;
        let samples = self.voltage_v.len();
        let turns = samples as f64 / self.sample_rate_hz * self.frequency_hz;
        // More than there are samples are too many, however many more.
        let harmonics = ((HARMONICS_PER_DRIVE * turns).min(samples as f64) as usize).max(1);
        let grid = Grid {
            samples,
            step_s: 1.0 / self.sample_rate_hz,
            harmonics,
        };
        require_samples(WHAT, grid.coordinates() + FEWEST_FOR_NOISE, samples)?;
        self.closes()?;
        let row = |n: usize| {
            let row = &self.voltage_v[n];
            core::array::from_fn(|c| if c < LIMBS { row[c] } else { self.standard[n] })
        };
        let mut data = project(&grid, row);
        self.put_noise(&grid, &mut data, row)?;
        let elsewhere = ends::look(self, &grid, &data.variance);
        let step = elsewhere.map_or([0.0; LIMBS + 1], |ends| ends.step);
        let flat = level(&grid, &step, row);
        if elsewhere.is_some() {
            data = project_stepped(&grid, &step, row);
            self.put_noise(&grid, &mut data, &flat)?;
        }
        let band_hz = self.limbs_band_hz.min(self.standard_band_hz);
        let near = colour::look(&grid, flat, &data.variance, self.band(band_hz));
        let nominal = self.direction_ground.normalize();
        let amplifier = certificates.amplifier_corner_rad_s.is_some();
        let room = &certificates.room;
        let g = self.gravity_ground_m_s2;
        Ok(Prepared {
            nominal,
            trial: Trial {
                drive: self.drive,
                elsewhere,
                latent: DVector::zeros(2 * harmonics + usize::from(elsewhere.is_some())),
                grid,
                gains: *self.gains,
                data,
                near,
                louder: [1.0; LIMBS + 1],
                wedge: 0,
                gravity_m_s2: g,
                gravity_turns: self.drive == Drive::Angular
                    && (room.plumb_rad > 0.0 || ends::turns(nominal, g)),
                amplifier,
                accelerometer_lag_s: certificates.accelerometer_lag_s,
                standard_delay_s: certificates.standard_delay_s,
                own: own::of(self.drive, amplifier, room, nominal, g),
            },
        })
    }

    /// Puts the noise of what was read between its samples, which has less at high frequencies and more below than its samples show, and of
    /// what has none.
    fn put_noise(
        &self,
        grid: &Grid,
        data: &mut Projection<{ LIMBS + 1 }>,
        row: impl Fn(usize) -> [f64; LIMBS + 1],
    ) -> Result<()> {
        let samples = grid.samples;
        // A short run has too few coordinates below: those next to them are the nearest to white.
        let white = |band_hz: f64| {
            let last = self
                .band(band_hz)
                .max(grid.harmonics + FEWEST_FOR_NOISE / 2);
            (last < samples / 2).then_some(grid.harmonics + 1..=last)
        };
        if let Some(band) = white(self.limbs_band_hz) {
            let limbs = |n: usize| core::array::from_fn::<f64, LIMBS, _>(|limb| row(n)[limb]);
            data.variance[..LIMBS].copy_from_slice(&mean_square(grid, limbs, band));
        }
        if let Some(band) = white(self.standard_band_hz) {
            [data.variance[LIMBS]] = mean_square(grid, |n| [row(n)[LIMBS]], band);
        }
        // A limb may well feel nothing in a trial, all of them may not.
        let largest =
            |values: &mut dyn Iterator<Item = f64>| values.fold(0.0_f64, |a, x| a.max(x.abs()));
        let floors = [
            largest(&mut self.voltage_v.iter().flatten().copied()),
            largest(&mut self.standard.iter().copied()),
        ]
        .map(|largest| (LEAST_NOISE * largest) * (LEAST_NOISE * largest));
        for (channel, variance) in data.variance.iter_mut().enumerate() {
            let floor = floors[usize::from(channel == LIMBS)];
            if floor == 0.0 {
                return Err(Error::DeadChannel {
                    channel: channel + 1,
                    value_v: 0.0,
                    samples,
                });
            }
            *variance = variance.max(floor);
        }
        Ok(())
    }

    /// Last harmonic up to a frequency, of those that there are.
    fn band(&self, band_hz: f64) -> usize {
        let samples = self.voltage_v.len();
        let duration_s = samples as f64 / self.sample_rate_hz;
        (band_hz * duration_s).min((samples / 2) as f64) as usize
    }

    /// Refuses lengths, numbers and settings with which nothing can be done.
    fn validate(&self) -> Result<()> {
        let samples = self.voltage_v.len();
        if self.standard.len() != samples {
            return Err(Error::LengthMismatch {
                what: "standard",
                expected: samples,
                got: self.standard.len(),
            });
        }
        for (name, value) in [
            ("sample_rate_hz", self.sample_rate_hz),
            ("frequency_hz", self.frequency_hz),
            ("direction_ground", self.direction_ground.length()),
        ] {
            require_positive(name, value)?;
        }
        require(
            self.gravity_ground_m_s2.is_finite(),
            "gravity_ground_m_s2",
            self.gravity_ground_m_s2.length(),
            "finite",
        )?;
        self.gains.validate()?;
        for (sample, (row, standard)) in self.voltage_v.iter().zip(self.standard).enumerate() {
            require_finite_row(row.iter().chain([standard]), sample)?;
        }
        Ok(())
    }

    /// Refuses a record that does not close: from its last sample to its first the standard may step as from any other to the next, with
    /// the noise of two samples more.
    ///
    /// # Errors
    /// [`Error::NotClosed`].
    pub fn closes(&self) -> Result<()> {
        let steps = self.standard.windows(2).map(|w| (w[1] - w[0]).abs());
        let largest = steps.fold(f64::MIN_POSITIVE, f64::max);
        let (Some(first), Some(last)) = (self.standard.first(), self.standard.last()) else {
            return Ok(());
        };
        let jump_over_step = (last - first).abs() / largest;
        if jump_over_step <= LARGEST_JUMP {
            Ok(())
        } else {
            Err(Error::NotClosed {
                what: WHAT,
                jump_over_step,
            })
        }
    }
}
