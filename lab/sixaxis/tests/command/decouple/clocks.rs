//! `sixaxis compare`: two recordings with rates and clocks of their own.

use std::path::Path;

use sixaxis_recordings::{Block, Channel, Layout, create};

use super::session::ACCELERATIONS;
use crate::program::{Folder, done, run, stderr, text};

/// Largest errors of the six accelerations over their peaks, %.
pub fn largest_errors(result: &Path, truth: &Path) -> Vec<f64> {
    let json = result.with_extension("json");
    let page = result.with_extension("html");
    done(&[
        "compare",
        text(result),
        text(truth),
        "--out",
        text(&page),
        "--json",
        text(&json),
    ]);
    let html = std::fs::read_to_string(page).expect("a page");
    assert!(html.contains("Decoupled motion against the truth"));
    let figures: serde_json::Value =
        serde_json::from_slice(&std::fs::read(json).expect("figures")).expect("is JSON");
    figures["axes"].as_array().expect("axes")[..6]
        .iter()
        .map(|axis| axis["largest_error_percent"].as_f64().expect("a figure"))
        .collect()
}

#[test]
fn inv_rates_and_clocks_are_aligned_or_refused() {
    let folder = Folder::new("decouple-clocks");
    let motion = |path: &Path, rate_hz: f64, start_s: f64, samples: usize| {
        let times: Vec<f64> = (0..samples).map(|k| start_s + k as f64 / rate_hz).collect();
        let wave = |axis: usize| {
            times
                .iter()
                .map(|t| ((axis + 1) as f64 * t).sin())
                .collect()
        };
        let mut columns = vec![times.clone()];
        columns.extend((0..6).map(wave));
        let names = [&["time"], &ACCELERATIONS[..]].concat();
        let channels = names.iter().map(|name| Channel::new(*name, None)).collect();
        let mut sink = create(
            path,
            &Layout {
                channels,
                ..Layout::default()
            },
        )
        .expect("creates");
        sink.write(&Block { columns }).expect("writes");
        sink.finish().expect("finishes");
    };
    let truth = folder.join("truth.csv");
    motion(&truth, 1000.0, 0.0, 5000);
    let result = folder.join("result.csv");
    for (rate_hz, start_s) in [
        (1000.0, 0.001),
        (1000.0, -0.5),
        (500.0, 0.003),
        (4000.0, -0.00025),
    ] {
        motion(&result, rate_hz, start_s, 3000);
        let errors_percent = largest_errors(&result, &truth);
        assert!(
            errors_percent.iter().all(|e| *e < 1e-6),
            "{rate_hz}: {errors_percent:?}"
        );
    }
    for (rate_hz, start_s, why) in [
        (1500.0, 0.0, "whole multiple"),
        (1000.0, 0.0004, "beside those"),
        (1000.0, 100.0, "no instant in common"),
    ] {
        motion(&result, rate_hz, start_s, 3000);
        let page = folder.join("refused.html");
        let refused = run(&["compare", text(&result), text(&truth), "--out", text(&page)]);
        assert_eq!(refused.status.code(), Some(1));
        assert!(
            stderr(&refused).contains(why),
            "{why}: {}",
            stderr(&refused)
        );
        assert!(!page.exists());
    }
}
