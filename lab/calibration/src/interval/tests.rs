//! Intervals of a campaign without noise, whose spread has a closed form.

use super::*;
use crate::grade::tests::{session, steps};
use crate::tap::Stiffness;

/// Rounding, and what the made-up fit's own noise is.
const ROUNDING: f64 = 1e-9;
/// Classes of both standards are 1 %.
const STANDARD: f64 = 0.95 * 0.01;

fn close(what: &str, ours: Option<f64>, expected: f64) {
    let ours = ours.unwrap_or_else(|| panic!("{what}: none"));
    let off = (ours - expected).abs();
    assert!(
        off <= ROUNDING * expected.abs().max(1e-3),
        "{what}: {ours}, not {expected}"
    );
}

/// Four fits that lie by `off` on either side: their jackknife is the root of three times that.
fn four<const N: usize>(off: [f64; N]) -> Vec<[f64; N]> {
    [-1.0, 1.0, -1.0, 1.0]
        .map(|sign| off.map(|x| 5.0 + sign * x))
        .to_vec()
}

#[test]
fn inv_half_widths_are_made_of_what_differs_and_what_is_the_same() {
    let mut off = [0.0; LIMBS];
    off[1] = 0.2;
    let left_out = LeftOut {
        scale_spread: four(off),
        inertia_spread: four([0.0; 6]),
        ..LeftOut::default()
    };
    let mut noise = Covariance::zeros();
    noise[(SCALE.start, SCALE.start)] = 0.1 * 0.1;
    let mut trusted = steps(None);
    trusted.drift.standard_error_v[4] = 1e-3;
    let found = report(&session(), &trusted, &left_out, Some(&noise));
    assert_eq!(found.len(), 25);
    close("drift", found[4].half_width_95, NORMAL_95 * 1e-3);
    assert_eq!(found[4].dominated_by, "noise");
    let size = 5.3476;
    let spread = NORMAL_95 * 0.2 * 3.0_f64.sqrt();
    for (limb, noise, trials, what) in [
        (0, NORMAL_95 * 0.1, 0.0, "noise"),
        (1, 0.0, spread, "differences between trials"),
        (2, 0.0, 0.0, "class of the standards"),
    ] {
        let own = &found[SCALE.start + limb];
        close("estimate", Some(own.estimate), size);
        close("noise", own.from_noise, noise);
        close("trials", own.from_trials, trials);
        close("standards", own.from_standards, STANDARD * size);
        let differs: f64 = noise.max(trials);
        close(
            "half width",
            own.half_width_95,
            differs.hypot(STANDARD * size),
        );
        assert_eq!(own.dominated_by, what);
        assert!(own.determined && own.remark.is_empty());
    }
    // Torques differ by what the scale factors differ by, and carry both gains.
    let moment = &found[INERTIA.start];
    let value = 238.76e-6;
    close(
        "standards",
        moment.from_standards.map(|x| x / value),
        STANDARD * 2.0_f64.sqrt(),
    );
    close(
        "trials",
        moment.from_trials.map(|x| x / value),
        spread / size,
    );
    let mut told = trusted.clone();
    told.rate_over_reading = Some((1.0, 2e-3));
    let found = report(&session(), &told, &left_out, Some(&noise));
    let standards = found[INERTIA.start].from_standards.map(|x| x / value);
    close("standards", standards, STANDARD.hypot(NORMAL_95 * 2e-3));
    // Wider than itself; a product of inertia or a drift has no size to be wider than.
    let mut vague = noise;
    for p in 0..25 {
        vague[(p, p)] = 100.0;
    }
    for own in report(&session(), &trusted, &left_out, Some(&vague)) {
        let sized = own.parameter.has_size() || own.parameter == Parameter::Stiffness;
        assert_eq!(own.determined, !sized, "{own:?}");
        assert_eq!(own.remark.is_empty(), !sized);
    }
    // The fits' own noise, where none is carried through the steps.
    let found = report(&session(), &trusted, &left_out, None);
    close("noise", found[SCALE.start].from_noise, 0.0);
}

#[test]
fn inv_without_its_trials_stiffness_is_the_designs() {
    let found = report(&session(), &steps(None), &LeftOut::default(), None);
    let own = &found[24];
    close("k/m", Some(own.estimate / 3.1e8), 1.0);
    assert!(!own.determined && own.half_width_95.is_none());
    assert!(
        own.remark
            .contains("there is no trial of role high_frequency_linear")
    );
    assert_eq!(found[SCALE.start].from_trials, None);
}

#[test]
fn inv_taps_take_the_place_of_step_4() {
    for (known, holding, taps, what, remark) in [
        (1e6, 1e5, 1, "noise", "from a tap"),
        (3e6, 1e6, 4, "what steps 2 and 3 leave", "from 4 taps"),
        (1e6, 3e6, 2, "how still the shell is held", "from 2 taps"),
    ] {
        let mut found = report(&session(), &steps(None), &LeftOut::default(), None);
        let before = found.clone();
        put_taps(&mut found, &Taps::default());
        assert_eq!(found, before);
        put_taps(
            &mut found,
            &Taps {
                stiffness: Some(Stiffness {
                    per_mass_per_s2: 3e8,
                    half_width_95: 4e6,
                    from_noise: 2e6,
                    from_known: known,
                    from_holding: holding,
                    taps,
                }),
                ..Taps::default()
            },
        );
        assert_eq!(found[..24], before[..24]);
        let own = &found[24];
        assert!(own.determined);
        close("k/m", Some(own.estimate), 3e8);
        close("half width", own.half_width_95, 4e6);
        close("noise", own.from_noise, 2e6);
        close("known", own.from_standards, known);
        assert_eq!(
            (own.dominated_by.as_str(), own.remark.as_str()),
            (what, remark)
        );
    }
}

/// Fits are the numbers of trials taken.
fn left_out(wedges: &[usize], refused: usize) -> Fits<1> {
    let count = wedges.len();
    leave_out(wedges, &|takes| {
        let taken = (0..count).filter(|i| takes(*i)).count();
        (taken > refused).then_some([taken as f64])
    })
}

#[test]
fn inv_wedges_are_left_out_whole() {
    // Four wedges, of one, two, one and three trials.
    let wedges = [0, 1, 1, 3, 4, 4, 4];
    let (each, spread) = left_out(&wedges, 0);
    let of = |wedge: f64| Some([7.0 - wedge]);
    assert_eq!(
        each,
        [
            of(1.0),
            of(2.0),
            of(2.0),
            of(1.0),
            of(3.0),
            of(3.0),
            of(3.0)
        ]
    );
    assert_eq!(spread, [[6.0], [5.0], [6.0], [4.0]]);
    // A wedge without which nothing is determined: its trials alone.
    let (each, _) = left_out(&wedges, 4);
    assert_eq!(
        each,
        [
            of(1.0),
            of(2.0),
            of(2.0),
            of(1.0),
            of(1.0),
            of(1.0),
            of(1.0)
        ]
    );
    // Three wedges: every trial is one of the jackknife's.
    let (each, spread) = left_out(&[0, 1, 1, 3], 0);
    assert_eq!(each, [Some([3.0]), Some([2.0]), Some([2.0]), Some([3.0])]);
    assert_eq!(spread, [[3.0]; 4]);
}
