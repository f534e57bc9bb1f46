//! A sample in wider registers than the program was compiled for: [`crate::kernel::wider`].

use super::{Answer, Decoupler, State, answer};
use crate::error::Result;
use crate::geometry::LIMBS;
use crate::kernel::attitude::{HALF_ANGLE_SQUARED_LIMIT, exp, half_rotation, to_ground};
use crate::kernel::number::Scalar;
use crate::kernel::order::to_kernel_order;
use crate::kernel::placement::{self, STRAIN_LIMIT};
use crate::kernel::rate::Torques;
use crate::kernel::shell;
use crate::kernel::wider::Wider;

impl<T: Scalar> Decoupler<T> {
    /// [`Decoupler::push`] of a stream that has had three samples, in these registers; the same bits.
    #[inline(always)]
    pub(super) fn push_wider<const EXCLUDING: bool>(
        &mut self,
        proof: <T::Wider as Wider<T>>::Proof,
        voltage_v: &[T; LIMBS],
    ) -> Result<Option<Answer<T>>> {
        let done = T::Wider::run(
            proof,
            #[inline(always)]
            || self.in_wider_registers::<EXCLUDING>(voltage_v).is_some(),
        );
        match &self.wider {
            // Put together here, where it goes straight to its place.
            Some(wider) if done => {
                let State {
                    received, attitude, ..
                } = self.state;
                Ok(Some(answer(received - 2, wider.kept(), attitude)))
            }
            _ => self.push_checked(voltage_v),
        }
    }

    /// Where wider registers were looked for in vain: rare, and not worth a copy at each place that pushes.
    #[inline(never)]
    pub(super) fn push_narrow(&mut self, voltage_v: &[T; LIMBS]) -> Result<Option<Answer<T>>> {
        self.push_fast(voltage_v)
    }

    /// Leaves accelerations and rate with [`Wider::keep`]. Nothing, and nothing done, where series and polynomials do not hold.
    #[inline(always)]
    fn in_wider_registers<const EXCLUDING: bool>(&mut self, voltage_v: &[T; LIMBS]) -> Option<()> {
        let wider = self.wider.as_ref()?;
        let widen = wider.widen();
        let narrow = T::Wider::narrow;
        let constants = wider.constants();
        let [u, v, w] = to_kernel_order(*voltage_v);
        let after = if EXCLUDING {
            let [u, v, w] = self.mask.voltages([u, v, w]);
            let used = [u.map(widen), v.map(widen), w.map(widen)];
            wider.strains().by_series(constants, used)
        } else {
            placement::by_series(constants, [u.map(widen), v.map(widen), w.map(widen)])
        };
        let in_range = narrow(after.strain_squares) <= T::from_f64(STRAIN_LIMIT * STRAIN_LIMIT);
        if !in_range {
            return None;
        }
        let state = &self.state;
        let now = state.now.map(widen);
        let torques = Torques {
            now: now.torque,
            next: after.torque,
        };
        let spin = state.spin.map(widen);
        let step = spin.step(self.scheme, constants.gyroscopic, torques);
        let motion = shell::motion(
            constants,
            &state.before.map(widen),
            &now.relative_pose(),
            &after.relative_pose(),
            now.force,
            [step.rate, step.derivative],
        );
        let half = half_rotation(&state.shell.map(widen), &motion);
        let attitude = state.attitude.map(widen);
        let (turn, half_angle_squared) = exp(half, attitude.to_unit());
        let slow = narrow(half_angle_squared) <= T::from_f64(HALF_ANGLE_SQUARED_LIMIT);
        if !slow {
            return None;
        }
        let attitude = attitude.after(turn);
        let ground = to_ground(constants, &motion, attitude);
        self.wider.as_mut()?.keep(ground);
        self.state.spin.take(self.scheme, step.map(narrow));
        self.remember(voltage_v);
        self.advance(after.map(narrow), motion.map(narrow), attitude.map(narrow));
        Some(())
    }
}

#[cfg(all(
    test,
    feature = "std",
    target_arch = "x86_64",
    not(target_feature = "avx")
))]
mod tests {
    use pulp::x86::V3;

    use crate::fixture::{decoupler, row};
    use crate::limb_set::LimbSet;
    use crate::scheme::Scheme;

    #[test]
    fn wider_registers_change_no_bit() {
        for scheme in Scheme::ALL {
            for excluded in [LimbSet::EMPTY, LimbSet::EMPTY.with(0).with(5).with(8)] {
                let fresh = decoupler(scheme).excluding(excluded).expect("six remain");
                assert_eq!(fresh.wider.is_some(), V3::is_available());
                let (mut wide, mut narrow) = (fresh.clone(), fresh);
                narrow.wider = None;
                for sample in 0..500 {
                    let voltage_v = row(sample, 0);
                    // What fails in them is done again in narrow ones, with the same bits.
                    if sample > 2 && V3::is_available() {
                        let mut tried = wide.clone();
                        let done = if excluded.is_empty() {
                            tried.in_wider_registers::<false>(&voltage_v)
                        } else {
                            tried.in_wider_registers::<true>(&voltage_v)
                        };
                        assert!(done.is_some(), "{scheme:?} {sample}");
                    }
                    let (ours, other) = (wide.push(&voltage_v), narrow.push(&voltage_v));
                    let numbers = |answer| match answer {
                        Ok(Some(answer)) => crate::SixAxis::numbers(&answer).map(f64::to_bits),
                        other => panic!("{other:?}"),
                    };
                    if sample >= 2 {
                        assert_eq!(numbers(ours), numbers(other), "{scheme:?} {sample}");
                    }
                }
            }
        }
    }
}
