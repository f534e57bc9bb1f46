//! What one channel does alone is noticed; what several do at once may be a blow, and is a remark.

use std::fmt::Write as _;

use sixaxis_recordings::inspect::{Severity, inspect};

const SAMPLES: usize = 6000;
const SAMPLE: usize = 3000;

/// What is noticed and what is remarked of jumps in nine channels that move, after something was done to them.
fn said(spoil: impl Fn(&mut [Vec<f64>])) -> [Vec<String>; 2] {
    let mut state = 5_u64;
    let mut noise = || {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        8e-3 * ((state >> 11) as f64 / (1_u64 << 53) as f64 - 0.5)
    };
    let course = |limb: usize, k: usize| (2e-2 * k as f64 + limb as f64).sin();
    let mut channels: Vec<Vec<f64>> = (0..9)
        .map(|limb| (0..SAMPLES).map(|k| course(limb, k) + noise()).collect())
        .collect();
    spoil(&mut channels);
    let names: Vec<String> = (1..=9).map(|limb| format!("u{limb} [V]")).collect();
    let mut text = names.join(",") + "\n";
    for k in 0..channels[0].len() {
        let row: Vec<String> = channels
            .iter()
            .map(|u| format!("{:.5}", u[k]).to_lowercase())
            .collect();
        let _ = writeln!(text, "{}", row.join(","));
    }
    let file = tempfile::Builder::new()
        .suffix(".csv")
        .tempfile()
        .expect("a file");
    std::fs::write(file.path(), text).expect("writes");
    let inspection = inspect(file.path(), None, &mut |_, _| {}).expect("it can be read");
    [Severity::Noticed, Severity::Remark].map(|severity| {
        let told = inspection.told(severity).map(|fact| fact.text.clone());
        told.filter(|text| text.contains(" jump")).collect()
    })
}

#[test]
fn inv_a_jump_of_one_channel_is_noticed_and_of_several_remarked() {
    let nothing: [Vec<String>; 2] = Default::default();
    assert_eq!(said(|_| ()), nothing);
    let [noticed, remarks] = said(|u| u[3][SAMPLE] += 1.0);
    assert!(remarks.is_empty());
    assert!(
        noticed.len() == 1 && noticed[0].starts_with("u4 jumps by "),
        "{noticed:?}"
    );
    let [noticed, remarks] = said(|channels| {
        for u in channels {
            u.drain(SAMPLE..SAMPLE + 40);
        }
    });
    assert!(noticed.is_empty(), "{noticed:?}");
    let place = format!("several limbs jump at once before sample {SAMPLE}");
    assert!(
        remarks.len() == 1 && remarks[0].contains(&place),
        "{remarks:?}"
    );
    // A blow that one channel shows shortly and another for long.
    let [noticed, _] = said(|u| {
        u[0][SAMPLE] += 1.0;
        for k in 0..400 {
            let t = k as f64;
            u[1][SAMPLE + 3 + k] += (-t / 100.0).exp() * (1.2 * t).sin();
        }
    });
    assert!(noticed.is_empty(), "{noticed:?}");
    // A plug that crackles, after a sample that is none, and taps that a weak channel shows only now and then.
    let [noticed, _] = said(|u| {
        u[5][500] = f64::NAN;
        for k in 0..6 {
            u[5][700 + 300 * k] += 1.0;
        }
    });
    assert!(
        noticed.len() == 1
            && noticed[0].contains("u6 jumps")
            && noticed[0].contains("5 other places"),
        "{noticed:?}"
    );
    let [noticed, _] = said(|u| {
        for tap in 0..5 {
            u[2][700 + 300 * tap] += 2.0;
        }
        u[0][1300] += 0.7;
    });
    assert!(
        noticed.len() == 1 && noticed[0].contains("u3 jumps"),
        "{noticed:?}"
    );
}
