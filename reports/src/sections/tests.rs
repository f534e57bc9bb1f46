//! What must hold of whatever is published: it is whole, it is of the parameters that the study has, and it is drawn.

use sixaxis_core::{Parameter, Scheme};
use sixaxis_page::render;
use sixaxis_props::evidence::Quantiles;
use sixaxis_props::results::{
    Campaign, Detection, DyingLimb, Growth, GrowthPoint, Hours, Propagation, PropagationSet,
    Published, SchemeCurve, SelfCalibration, Speed, Work,
};

use super::*;

fn embedded<P: Published>() -> P {
    P::embedded().expect(P::FILE)
}

#[test]
fn sections_of_published_results_are_drawn() {
    let sections = [
        budget::section(),
        speed::section(),
        fault_tolerance::section(),
        self_calibration::section(),
        blind::section(),
        hours::section(),
    ];
    let page = Page {
        sections: sections.map(|s| s.expect("a section")).to_vec(),
        ..Page::default()
    };
    let html = render(&page).expect("renders");
    for scheme in Scheme::ALL {
        assert!(html.contains(scheme.name()), "{}", scheme.name());
    }
    let dying: DyingLimb = embedded();
    let dies = format!("limb {} dies", dying.limb);
    for words in [
        "Eigen (C++)",
        "not on this machine",
        "brisk, 2 s",
        "usual\u{a0}room",
        &dies,
    ] {
        assert!(html.contains(words), "{words}");
    }
    // Runs that ended on an error are said, and medians of the others are not drawn.
    let hours: Hours = embedded();
    let looks = hours.rides.iter().flat_map(|ride| &ride.at);
    let fewer = |errors: Quantiles| (errors.count as u64) < hours.runs;
    let lost = looks.filter_map(|at| at.linear_m_s2).any(fewer);
    assert_eq!(html.contains("could still be decoded"), lost);
    // As a number: a cell, its title, a place in a drawing. What differs of a peer may speak of it.
    for number in [">NaN", "\"NaN", ",NaN", " NaN,"] {
        assert!(!html.contains(number), "{number}");
    }
}

#[test]
fn detection_is_whole() {
    let d: Detection = embedded();
    assert_eq!(d.classes.len(), 6);
    for kind in &d.kinds {
        assert_eq!(kind.isolated.all(), kind.trials, "{:?}", kind.kind);
        assert_eq!(kind.named.all(), kind.trials, "{:?}", kind.kind);
        assert!(kind.detected_within.is_sorted(), "{:?}", kind.kind);
    }
    for curve in &d.curves {
        assert_eq!(curve.false_alarm.len(), curve.detected.len());
        assert_eq!(curve.false_alarm.len(), curve.theory.len());
    }
}

#[test]
fn history_of_a_dying_limb_is_whole() {
    let d: DyingLimb = embedded();
    for series in [
        &d.statistic,
        &d.truth_m_s2,
        &d.nine_m_s2,
        &d.watched_m_s2,
        &d.never_failed_rad,
        &d.nine_rad,
        &d.watched_rad,
    ] {
        assert_eq!(series.len(), d.time_s.len());
        assert!(series.iter().all(|x| x.is_finite()));
    }
}

#[test]
fn campaign_and_propagation_are_of_the_25() {
    let campaign: Campaign = embedded();
    let of_campaign: Vec<Parameter> = campaign.parameters.iter().map(|p| p.parameter).collect();
    assert_eq!(of_campaign, Parameter::all().collect::<Vec<_>>());
    // A campaign has the stiffness, a fit its reciprocal.
    let fitted: Vec<Parameter> = Parameter::all().map(Parameter::estimated).collect();
    let propagation: Propagation = embedded();
    let edges = |set: &PropagationSet| -> Vec<f64> {
        set.by_attitude.iter().map(|band| band.below_rad).collect()
    };
    for set in &propagation.sets {
        let of_set: Vec<Parameter> = set.parameters.iter().map(|p| p.parameter).collect();
        assert_eq!(of_set, fitted);
        assert_eq!(edges(set), edges(&propagation.sets[0]));
    }
}

#[test]
fn campaign_has_what_the_page_shows() {
    let campaign: Campaign = embedded();
    let (_, known) = campaign.parameters.split_last().expect("25 parameters");
    for p in known {
        let joint = p.joint.as_ref().expect("a joint fit");
        let told = p.joint_gain_known.as_ref().expect("a bound");
        for share in [
            joint.within_stated_95.expect("coverage").value,
            p.four_steps.within_stated_95.expect("coverage").value,
        ] {
            assert!((0.0..=1.0).contains(&share), "{}", p.parameter);
        }
        assert!(
            told.variance_over_stated.is_some_and(|v| v > 0.0),
            "{}",
            p.parameter
        );
    }
}

#[test]
fn self_calibration_is_whole() {
    let p: SelfCalibration = embedded();
    assert!(!p.lengths.is_empty() && !p.stiffness.is_empty());
    for length in &p.lengths {
        assert!(length.refused < length.draws);
        for share in length.coverage_95_by_limb {
            assert!((0.0..=1.0).contains(&share));
        }
    }
    assert!(p.motions.iter().any(|m| m.open.is_none()));
}

#[test]
fn every_scheme_is_timed_at_the_same_rates() {
    let snapshot: Speed = embedded();
    let curves = &snapshot.speed.work_precision.curves;
    let schemes: Vec<Scheme> = curves.iter().map(|curve| curve.scheme).collect();
    assert_eq!(schemes, Scheme::ALL);
    let rates = |curve: &SchemeCurve| -> Vec<f64> {
        curve.points.iter().map(|p| p.sample_rate_hz).collect()
    };
    for curve in curves {
        assert_eq!(rates(curve), rates(&curves[0]));
        for p in &curve.points {
            let times = [p.push_s_per_s.median, p.record_s_per_s.median];
            let all = [p.push_error, p.record_error].into_iter().chain(times);
            assert!(all.into_iter().all(|v| v.is_finite() && v > 0.0));
        }
    }
}

#[test]
fn quartiles_stand_around_their_medians() {
    let snapshot: Speed = embedded();
    let length = &snapshot.speed.length;
    let lengths = length.streamed.iter().chain(&length.held);
    let of_lengths = lengths.flat_map(|p| [p.push_ns, p.record_ns]);
    let of_peers = snapshot.peers.peers.iter().map(|p| p.ns_per_sample);
    for s in of_lengths.chain(of_peers) {
        assert!(s.q1 > 0.0 && s.q1 <= s.median && s.median <= s.q3);
    }
}

#[test]
fn what_ratios_are_taken_to_is_there() {
    let snapshot: Speed = embedded();
    for peer in &snapshot.peers.peers {
        assert!(peer.ratio_to.contains_key(speed::PUSH), "{}", peer.name);
    }
    let counts = snapshot.instructions.expect("instruction counts");
    assert!(counts.per_sample.contains_key(speed::COUNTED_BASE));
}

#[test]
fn growth_is_whole() {
    let growth: Growth = embedded();
    assert!(!growth.quick, "{} was measured in a hurry", Growth::FILE);
    for work in Work::ALL {
        let curve = growth.of(work).expect("every kind of work");
        assert!(curve.points.is_sorted_by_key(|p| p.size), "{work:?}");
        let positive = |p: &GrowthPoint| p.processor_s.q1 > 0.0 && p.peak_memory_bytes > 0;
        assert!(curve.points.iter().all(positive), "{work:?}");
        assert!(curve.power_law().is_some(), "{work:?}");
    }
}

/// A cost in proportion has the slope one, the square of anything two. Fixed costs at the small end and caches at the large one bend a
/// curve of three or four decades by some hundredths.
const SLOPE_OF_PROPORTION: core::ops::RangeInclusive<f64> = 0.9..=1.1;
/// The memory of blocks, whatever the samples: over a hundred times as many it may vary by what the allocator keeps, not double.
const FLAT: f64 = 2.0;

#[test]
fn cost_grows_in_proportion_and_the_memory_of_decouple_does_not() {
    let growth: Growth = embedded();
    let curve = |work| growth.of(work).expect("every kind of work");
    for work in [
        Work::Decouple,
        Work::PushRecord,
        Work::PushLanes,
        Work::Campaign,
    ] {
        let law = curve(work).power_law().expect("a line");
        assert!(
            SLOPE_OF_PROPORTION.contains(&law.exponent),
            "{work:?}: {law:?}"
        );
    }
    // Trials have the joint fit's own fixed cost: no lower end, and squares show at the upper.
    let trials = curve(Work::Calibrate).power_law().expect("a line");
    assert!(trials.exponent <= *SLOPE_OF_PROPORTION.end(), "{trials:?}");
    let over = |work| {
        let points = &curve(work).points;
        let (last, before) = (points.last().expect("a point"), &points[points.len() - 3]);
        last.peak_memory_bytes as f64 / before.peak_memory_bytes as f64
    };
    assert!(over(Work::Decouple) < FLAT);
    // What holds the record must show, or memory is not measured.
    assert!(over(Work::PushRecord) > FLAT);
}
