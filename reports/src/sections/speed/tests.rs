//! What must hold of whatever is published: it reads, it is whole, and it is drawn.

use sixaxis_core::Scheme;

use super::*;
use sixaxis_page::{Page, render};

fn embedded() -> Snapshot {
    Snapshot::embedded().expect("benches/results/speed.json as the example writes it")
}

#[test]
fn every_scheme_is_measured_at_the_same_rates() {
    let snapshot = embedded();
    let curves = &snapshot.speed.work_precision.curves;
    let schemes: Vec<Scheme> = curves.iter().map(|curve| curve.scheme).collect();
    assert_eq!(schemes, Scheme::ALL);
    let rates = |curve: &snapshot::Curve| -> Vec<f64> {
        curve.points.iter().map(|p| p.sample_rate_hz).collect()
    };
    for curve in curves {
        assert_eq!(rates(curve), rates(&curves[0]));
        for p in &curve.points {
            let all = [
                p.push_error,
                p.record_error,
                p.push_s_per_s.median,
                p.record_s_per_s.median,
            ];
            assert!(all.iter().all(|v| v.is_finite() && *v > 0.0));
        }
    }
}

#[test]
fn quartiles_stand_around_their_medians() {
    let snapshot = embedded();
    let speed = &snapshot.speed;
    let lengths = speed.length.streamed.iter().chain(&speed.length.held);
    let of_lengths = lengths.flat_map(|p| [p.push_ns, p.record_ns]);
    let of_peers = snapshot.peers.peers.iter().map(|p| p.ns_per_sample);
    for s in of_lengths.chain(of_peers) {
        assert!(s.q1 > 0.0 && s.q1 <= s.median && s.median <= s.q3);
    }
}

#[test]
fn what_ratios_are_taken_to_is_there() {
    let snapshot = embedded();
    for peer in &snapshot.peers.peers {
        assert!(peer.ratio_to.contains_key(PUSH), "{}", peer.name);
    }
    let counts = &snapshot.instructions.per_sample;
    assert!(counts.contains_key(COUNTED_BASE));
}

#[test]
fn everything_is_on_the_page() {
    let snapshot = embedded();
    let page = Page {
        sections: vec![section().expect("a section")],
        ..Page::default()
    };
    let html = render(&page).expect("renders");
    for scheme in Scheme::ALL {
        assert!(html.contains(scheme.name()), "{}", scheme.name());
    }
    for peer in &snapshot.peers.peers {
        assert!(html.contains(&title(&peer.name)), "{}", peer.name);
    }
    assert!(html.contains("not on this machine"));
    assert!(!html.contains("NaN"));
}
