//! What must hold of whatever is published: it reads, it is whole, and it has what the page shows.

use super::*;

#[test]
fn inv_published_detection_is_whole() {
    let d = published::detection().expect("props/results/detection.json");
    assert_eq!(d.classes.len(), 6);
    for kind in &d.kinds {
        assert_eq!(kind.detected_within.len(), d.within_samples.len());
        assert_eq!(kind.isolated.all(), kind.trials, "{}", kind.kind);
        assert_eq!(kind.named.all(), kind.trials, "{}", kind.kind);
        assert!(kind.detected_within.is_sorted(), "{}", kind.kind);
    }
    for curve in &d.curves {
        assert_eq!(curve.false_alarm.len(), curve.detected.len());
        assert_eq!(curve.false_alarm.len(), curve.theory.len());
    }
}

#[test]
fn inv_published_history_is_whole() {
    let d = published::dying_limb().expect("props/results/dying_limb.json");
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
