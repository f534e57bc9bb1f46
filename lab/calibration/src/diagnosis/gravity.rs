//! Weight that turns in the sensor. A pure rotation asks for no net force; what net force there is, is weight. A run that travels along
//! the axis, too, asks for none square to it.

use glam::DVec3;
use nalgebra::{Matrix3, Vector3};
use sixaxis_core::LIMBS;
use sixaxis_core::geometry::DIRECTIONS_SHELL;

use super::table::Table;
use super::trial_case::{TrialCase, angles, names};
use crate::finding::{Cause, Finding};
use crate::steps::rows;
use sixaxis_recordings::session::Role;
use sixaxis_recordings::unit::STANDARD_GRAVITY_M_S2;

/// Weight, m/s^2, from which it is worth a finding: a mounting askew by three degrees.
pub const NOTICED_M_S2: f64 = 0.5;
/// Share of the net force that a constant vector in the ground must explain to be gravity.
const EXPLAINED: f64 = 0.8;

/// Share of standard gravity by which a weight may differ from it to be nothing else: scale factors are as good as a standard's certificate.
const WEIGHS: f64 = 0.1;

/// Cosine of the angle from which two weights pull in opposite directions.
const OPPOSITE: f64 = 0.9;
/// Mean square of the sine and so on of its angles, summed over axes, from which a run turns far enough.
const TURNS: f64 = 0.1;

/// Looks for a gravity that the session does not know of. Where it is there, what turns cannot be examined further. Whether that is certain:
/// where none should turn, and the whole of it does in every angular trial.
pub fn examine(table: &Table, cases: &mut [TrialCase<'_>], findings: &mut Vec<Finding>) -> bool {
    let mut seen = Vec::new();
    let turning =
        |case: &&TrialCase<'_>| matches!(case.trial.role, Role::Angular | Role::Validation);
    for case in cases.iter().filter(turning) {
        if let Some(found) = weight(table, case) {
            let declared = case.trial.gravity_ground_m_s2;
            let n = case.trial.direction_ground;
            // What lies along the axis does not turn.
            let declared = declared - n * declared.dot(n);
            if (found - declared).length() > NOTICED_M_S2 {
                seen.push((case, found, declared));
            }
        }
    }
    let Some((_, found, declared)) = seen.first().copied() else {
        return false;
    };
    let whole = |(_, found, declared): &(&TrialCase<'_>, DVec3, DVec3)| {
        (found.length() / STANDARD_GRAVITY_M_S2 - 1.0).abs() < WEIGHS
            && declared.length() < NOTICED_M_S2
    };
    let angular = |case: &TrialCase<'_>| case.trial.role == Role::Angular;
    let seen_angular = seen.iter().filter(|(case, ..)| angular(case)).count();
    let certain = seen_angular > 1
        && seen_angular == cases.iter().filter(|case| angular(case)).count()
        && seen.iter().all(whole);
    let evidence = format!(
        "during rotation the limbs carry a net force that turns as a weight of {:.2} m/s² would{}, but by the directions in the session it should be {:.2} m/s²",
        found.length(),
        if found.dot(declared) < -OPPOSITE * found.length() * declared.length() {
            " that pulls the other way"
        } else {
            ""
        },
        declared.length()
    );
    let advice = if declared.length() > NOTICED_M_S2 {
        "correct `down` of these recordings, which says otherwise, or mount the rig as it says"
    } else {
        "state where down was with `down` of these recordings, or mount the rig with its axis vertical"
    };
    let finding = Finding::new(Cause::GravityNotHandled, evidence, advice);
    findings.push(finding.in_recordings(names(seen.iter().map(|(case, ..)| *case))));
    let of_runs = seen
        .iter()
        .all(|(case, ..)| case.trial.role == Role::Validation);
    for case in cases.iter_mut() {
        case.explained |= match case.trial.role {
            Role::Angular => !of_runs,
            role => role == Role::Validation,
        };
    }
    certain
}

/// Gravity square to the axis, m/s^2, as one trial's net force shows it; zero if it shows none. None where the trial does
/// not determine it.
fn weight(table: &Table, case: &TrialCase<'_>) -> Option<DVec3> {
    if table.silent.contains(&true) {
        return None;
    }
    let trial = case.trial;
    let axis = trial.direction_ground;
    let angle: Vec<f64> = angles(case.conditioned, trial).collect();
    let net: Vec<DVec3> = case
        .force_n
        .iter()
        .map(|force| {
            (0..LIMBS)
                .map(|i| DIRECTIONS_SHELL[i] * (force[i] / table.mass_over_scale_kg[i]))
                .sum()
        })
        .collect();
    let rest = *net.first()?;
    let travels = trial.role == Role::Validation;
    let asked_for = |force: DVec3| match travels {
        true => force - axis * force.dot(axis),
        false => force,
    };
    // Least squares for g in net - rest = g - R^T g: linear in g.
    let (mut normal, mut right) = (Matrix3::zeros(), Vector3::zeros());
    let (mut total, mut samples) = (0.0, 0);
    let basis = [DVec3::X, DVec3::Y, DVec3::Z];
    for row in rows(trial) {
        let columns = basis.map(|g| asked_for(turned_gravity_m_s2(g, axis, angle[row])));
        let change = asked_for(net[row] - rest);
        for i in 0..3 {
            for j in 0..3 {
                normal[(i, j)] += columns[i].dot(columns[j]);
            }
            right[i] += columns[i].dot(change);
        }
        total += change.length_squared();
        samples += 1;
    }
    if travels && normal.trace() < TURNS * f64::from(samples) {
        return None;
    }
    // Gravity along the axis does not turn and cannot be seen: the smallest solution has none.
    let svd = normal.try_svd(true, true, f64::EPSILON, 1000)?;
    let g = svd.solve(&right, 1e-6 * svd.singular_values.max()).ok()?;
    let found = DVec3::new(g[0], g[1], g[2]);
    let explained = right.dot(&g);
    if found.length() < NOTICED_M_S2 && (total / f64::from(samples)).sqrt() < NOTICED_M_S2 {
        return Some(DVec3::ZERO);
    }
    Some(if explained > EXPLAINED * total {
        found
    } else {
        DVec3::ZERO
    })
}

/// Change of gravity's share in the limb forces since rest, as an acceleration in shell axes, m/s^2: -(R^T - 1) g after a turn
/// about a fixed axis. Eq. (3) has R sum (f/m) e = a - g.
pub fn turned_gravity_m_s2(gravity_ground_m_s2: DVec3, axis: DVec3, angle_rad: f64) -> DVec3 {
    let turned = glam::DQuat::from_axis_angle(axis, -angle_rad) * gravity_ground_m_s2;
    gravity_ground_m_s2 - turned
}
