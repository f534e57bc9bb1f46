//! The nine forces of a harmonic trial with the geometry kept: limbs that tilt, a mass that turns, centrifugal torque.
//!
//! To first order in y = m/k, and to all orders in the motion. At y = 0 the limbs carry phi = J G l, G = (J^T J)^-1, under the
//! load l = (a - g; (I/m) w' + w x (I/m) w), and the mass is at y x1, x1 = -G l. At first order f/m = phi + y psi, with
//!
//! ```text
//! elongations   dl_i = y J_i x1 + y^2 (J_i x2 + q_i),     psi = -(J x2 + q),
//! balance       J^T psi + sum phi_i dw_i(x1) = l1,        x2 = G (sum phi_i dw_i - J^T q - l1):
//! ```
//!
//! q_i is the second order of the limb's elongation, dw_i what its wrench (e_i, t_i x e_i) changes by as it tilts, l1 what the
//! motion of the mass in the shell adds to the load, (3) and (8) to first order. The harmonic part of that last one is the
//! linear theory's, which has it to all orders in y; here is the rest. All of it moves with the square of the motion: it shows
//! at twice the frequency, where no scale factor does.

use glam::{DMat3, DVec3};
use nalgebra::{SVector, Vector6};

use super::{Excitation, INERTIAS, LinearSensor, Response, TAU, inertia_part};
use crate::columns::{halves, stacked};
use crate::error::{Result, require};
use crate::float::{sin_cos, sqrt};
use crate::geometry::{DIRECTIONS_SHELL, LIMBS, LIMBS_PER_NODE};

/// One instant of the motion, shell axes.
struct Instant {
    w: DVec3,
    w_dot: DVec3,
    /// l, its time derivative, and the second one of its centrifugal part; torques over the half edge.
    load: Vector6<f64>,
    load_slope: Vector6<f64>,
    centrifugal_curvature: Vector6<f64>,
}

impl LinearSensor {
    /// Forces at a phase of a harmonic motion, whole and with gravity's share, and what moves them: a, w' as the sine of the
    /// phase, w as its cosine.
    ///
    /// Gravity, m/s^2, is constant in shell axes: without angular motion, or along its axis. What k/m and I/m change at first
    /// order in y and at once is left out, 1e-6 of their effect at 5 Hz. For a small motion without gravity, equals the sine
    /// times [`LinearSensor::response`].
    ///
    /// # Errors
    /// Those of [`LinearSensor::response`]; [`crate::Error::OutOfRange`] for a frequency of zero and for gravity that turns in the shell.
    pub fn tilted(
        &self,
        excitation: &Excitation,
        gravity_shell_m_s2: DVec3,
        phase_rad: f64,
    ) -> Result<Response> {
        let linear = self.response(excitation)?;
        let omega = TAU * excitation.frequency_hz;
        require(
            omega > 0.0,
            "frequency_hz",
            excitation.frequency_hz,
            "positive",
        )?;
        let axis = excitation.angular_shell_rad_s2;
        let across = gravity_shell_m_s2.cross(axis).length();
        let along = gravity_shell_m_s2.length() * axis.length();
        require(
            across <= sqrt(f64::EPSILON) * along,
            "gravity_shell_m_s2",
            across,
            "along the axis of the angular motion",
        )?;
        let (sin, cos) = sin_cos(phase_rad);
        let now = self.instant(excitation, gravity_shell_m_s2, [omega, sin, cos]);
        let (rigid, psi) = self.first_order(&now);
        let n = self.geometry.half_edge_m;
        let still = self.jacobian * self.inverse;
        // What the linear theory has beyond rigid limbs; its static part is in `rigid`.
        let (a, b) = (excitation.linear_shell_m_s2, axis);
        let static_load = self.mass * stacked(a, b * n);
        let beyond = SVector::from(linear.force_per_mass_m_s2) - still * static_load;
        let y = self.compliance_s2;
        let force = rigid + psi * y + beyond * sin;
        let by_log = SVector::from(linear.by_log_stiffness_m_s2) * sin - psi * y;
        Ok(Response {
            force_per_mass_m_s2: force.into(),
            by_log_stiffness_m_s2: by_log.into(),
            by_inertia: core::array::from_fn(|entry| {
                let mut unit = [0.0; INERTIAS];
                unit[entry] = 1.0 / (n * n);
                // E w, as n^2 over n.
                let [_, product] = halves(&(inertia_part(&unit) * stacked(DVec3::ZERO, now.w * n)));
                let centrifugal = still * stacked(DVec3::ZERO, now.w.cross(product));
                (SVector::from(linear.by_inertia[entry]) * sin + centrifugal).into()
            }),
        })
    }

    fn instant(
        &self,
        excitation: &Excitation,
        gravity_shell_m_s2: DVec3,
        [omega, sin, cos]: [f64; 3],
    ) -> Instant {
        let (a, b) = (
            excitation.linear_shell_m_s2,
            excitation.angular_shell_rad_s2,
        );
        let n = self.geometry.half_edge_m;
        let euler = self.tensor_m2 * b / n;
        // w x (I/m) w is this times the square of the cosine.
        let centrifugal = b.cross(self.tensor_m2 * b) / (omega * omega * n);
        let twice = cos * cos - sin * sin;
        Instant {
            w: b * (-cos / omega),
            w_dot: b * sin,
            load: stacked(
                a * sin - gravity_shell_m_s2,
                euler * sin + centrifugal * (cos * cos),
            ),
            load_slope: stacked(a * cos, euler * cos - centrifugal * (2.0 * sin * cos)) * omega,
            centrifugal_curvature: stacked(DVec3::ZERO, centrifugal)
                * (-2.0 * omega * omega * twice),
        }
    }

    /// phi, and psi without the harmonic motion of the mass in the shell.
    fn first_order(&self, now: &Instant) -> (SVector<f64, LIMBS>, SVector<f64, LIMBS>) {
        let n = self.geometry.half_edge_m;
        let length = self.geometry.limb_length_m;
        let rigid = self.jacobian * (self.inverse * now.load);
        let moved = |load: &Vector6<f64>| {
            let [r, turned] = halves(&-(self.inverse * load));
            (r, turned / n)
        };
        let (r, phi) = moved(&now.load);
        let (v, phi_dot) = moved(&now.load_slope);
        let (acceleration, phi_ddot) = moved(&now.centrifugal_curvature);
        // (3) and (8): what the mass's own motion asks of the limbs.
        let (w, w_dot, tensor) = (now.w, now.w_dot, self.tensor_m2);
        let force = w_dot.cross(r) + w.cross(w.cross(r)) + 2.0 * w.cross(v) + acceleration;
        let turned = |x: DVec3| turned_tensor(&tensor, phi, x);
        let torque = turned(w_dot)
            + w.cross(turned(w))
            + tensor * (w.cross(phi_dot) + phi_ddot)
            + phi_dot.cross(tensor * w)
            + w.cross(tensor * phi_dot);
        let mut unbalanced = -stacked(force, torque / n);
        let mut second = SVector::<f64, LIMBS>::zeros();
        for limb in 0..LIMBS {
            let e = DIRECTIONS_SHELL[limb];
            let t = self.geometry.node_mass_m(limb / LIMBS_PER_NODE);
            let swung = phi.cross(t);
            let p = r + swung;
            let along = e.dot(p);
            second[limb] = 0.5 * e.dot(phi.cross(swung))
                + (p.length_squared() - along * along) / (2.0 * length);
            let tilt = (p - e * along) / length;
            unbalanced += stacked(tilt, (swung.cross(e) + t.cross(tilt)) / n) * rigid[limb];
        }
        unbalanced -= self.jacobian.transpose() * second;
        let psi = -(self.jacobian * (self.inverse * unbalanced) + second);
        (rigid, psi)
    }
}

/// What a tensor that turns by phi adds to its product with x: (phi x I - I phi x) x.
fn turned_tensor(tensor: &DMat3, phi: DVec3, x: DVec3) -> DVec3 {
    phi.cross(*tensor * x) - *tensor * phi.cross(x)
}
