//! What limbs with mass show of the square of the rate, taken off a row before it is decoded.
//!
//! The rate at the row that has come is that at the sample before the last, which is decoded, and two steps of the rate's derivative at the
//! last, whose torque is known: right to the third order of the step.

use super::Decoupler;
use crate::error::Result;
use crate::geometry::LIMBS;
use crate::kernel::number::{Real, Scalar};
use crate::kernel::rate::derivative;
use crate::kernel::vec3::Vec3;
use crate::model::Model;
use crate::model::limb_mass::{PRODUCTS, volts_by_rate};

/// V over (rad per sample)^2, for each of [`PRODUCTS`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct ShownOfRate<T: Real>([[T; LIMBS]; PRODUCTS]);

impl<T: Scalar> ShownOfRate<T> {
    /// None for limbs without mass.
    pub fn new(model: &Model) -> Result<Option<Self>> {
        let settings = model.settings();
        if settings.rod_mass == 0.0 {
            return Ok(None);
        }
        let shown = volts_by_rate(model.sensor(), model.parameters(), settings.rod_mass)?;
        let square = settings.sample_rate_hz * settings.sample_rate_hz;
        Ok(Some(Self(shown.map(|channels| {
            channels.map(|v| T::from_f64(v * square))
        }))))
    }

    /// A row without what its channels show of this rate, mass axes, rad per sample.
    fn taken_off(&self, voltage_v: &[T; LIMBS], rate: Vec3<T>) -> [T; LIMBS] {
        let [x, y, z] = rate.components();
        let products = [x * x, y * y, z * z, y * z, z * x, x * y];
        let mut row = *voltage_v;
        for (product, shown) in products.into_iter().zip(&self.0) {
            for (voltage_v, shown) in row.iter_mut().zip(shown) {
                *voltage_v = *voltage_v - product * *shown;
            }
        }
        row
    }
}

impl<T: Scalar> Decoupler<T> {
    /// Whether its limbs have mass: then it decodes sample by sample, in every way of running through a recording.
    pub(crate) fn has_limb_mass(&self) -> bool {
        self.shown_of_rate.is_some()
    }

    /// The next row as limbs without mass would show it.
    #[inline(never)]
    pub(crate) fn as_without_limb_mass(&self, voltage_v: &[T; LIMBS]) -> [T; LIMBS] {
        match &self.shown_of_rate {
            None => *voltage_v,
            Some(shown) => self.without_limb_mass(shown, voltage_v),
        }
    }

    /// The same of limbs that have mass. Where the rate has run away nothing is taken off.
    #[inline(never)]
    pub(super) fn without_limb_mass(
        &self,
        shown: &ShownOfRate<T>,
        voltage_v: &[T; LIMBS],
    ) -> [T; LIMBS] {
        if self.state.turns_far() {
            return *voltage_v;
        }
        let rate = if self.state.received < 3 {
            self.start.rate
        } else {
            let (spin, torque) = (self.state.spin.rate, self.state.now.torque);
            let slope = derivative(self.constants.gyroscopic, spin, torque);
            let two = spin.constant(2.0);
            self.constants
                .principal_to_mass(slope.times_plus(two, spin))
        };
        shown.taken_off(voltage_v, rate)
    }
}

#[cfg(test)]
mod tests {
    use alloc::vec::Vec;

    use crate::decouple::lanes::push_lanes;
    use crate::fixture::{SENSOR, decoupler, parameters, row};
    use crate::kernel::simd::LANES;
    use crate::{Decoupler, LIMBS, LimbSet, Scheme, Settings, SixAxis};

    const SAMPLES: usize = 600;

    fn heavy(rod_mass: f64) -> Decoupler {
        let settings = Settings {
            rod_mass,
            ..Settings::new(1e4)
        };
        Decoupler::new(&SENSOR, &parameters(), &settings).expect("a sound sensor")
    }

    fn rows() -> Vec<[f64; LIMBS]> {
        (0..SAMPLES).map(|sample| row(sample, 0)).collect()
    }

    fn pushed(mut decoupler: Decoupler) -> Vec<SixAxis> {
        let rows = rows();
        let answers = rows.iter().map(|row| decoupler.push(row).expect("a row"));
        answers.flatten().collect()
    }

    #[test]
    fn every_way_through_a_recording_takes_it_off() {
        let (rows, one_by_one) = (rows(), pushed(heavy(0.01)));
        assert_ne!(one_by_one, pushed(heavy(0.0)));
        let mut record = Vec::new();
        let mut stream = heavy(0.01);
        stream
            .push_record(&rows, &mut |done| record.extend(done.iter()))
            .expect("sound rows");
        assert_eq!(record, one_by_one);
        assert_eq!(stream.blocks().whole, 0);
        let mut lanes = Vec::new();
        let mut streams: [Decoupler; LANES] = core::array::from_fn(|lane| match lane {
            3 => heavy(0.01),
            _ => heavy(0.0),
        });
        let sink = &mut |done: &[_]| {
            lanes.extend(
                done.iter()
                    .map(|sample: &crate::decouple::lanes::LaneSample| {
                        core::array::from_fn::<f64, 9, _>(|i| sample[i].0[3])
                    }),
            );
        };
        push_lanes(&mut streams, [&rows[..]; LANES], sink).expect("sound rows");
        let numbers = one_by_one
            .iter()
            .map(|answer| core::array::from_fn::<f64, 9, _>(|i| answer.numbers()[i]));
        assert_eq!(lanes, numbers.collect::<Vec<_>>());
    }

    #[test]
    fn limbs_without_mass_change_no_bit() {
        assert_eq!(pushed(heavy(0.0)), pushed(decoupler(Scheme::Heun)));
    }

    /// What is taken off a row that is placed again is what was taken off when it came.
    #[test]
    fn excluding_limbs_and_taking_them_back_at_once_changes_little() {
        let rows = rows();
        let mut stream = heavy(0.01);
        let mut answers = Vec::new();
        for (sample, row) in rows.iter().enumerate() {
            answers.extend(stream.push(row).expect("a row"));
            if sample == SAMPLES / 2 {
                for limbs in [LimbSet::EMPTY.with(4), LimbSet::EMPTY] {
                    stream.set_excluded(limbs).expect("eight remain");
                }
            }
        }
        let last = |answers: &[SixAxis]| answers.last().expect("an answer").rate_shell_rad_s;
        let through = last(&pushed(heavy(0.01)));
        assert!((last(&answers) - through).length() < 1e-9 * through.length());
    }
}
