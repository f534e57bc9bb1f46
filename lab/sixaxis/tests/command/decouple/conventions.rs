//! `--aid attitude`: attitudes in another convention than the one that is asked for, and good ones with noise.

use std::path::{Path, PathBuf};

use glam::{DQuat, DVec3};
use rand::{RngExt, SeedableRng};
use rand_distr::StandardNormal;
use rand_pcg::Pcg64;
use sixaxis_reference::rig::journey::Kind;

use super::ride::Ride;
use super::session::calibration;
use crate::program::{run, stderr, text};

const RATE_HZ: f64 = 500.0;
const DURATION_S: f64 = 20.0;

impl Ride {
    fn of(kind: Kind, test: &str) -> Self {
        let name = format!("conventions-{test}-{kind:?}");
        Self::recorded(&name, kind, 7, RATE_HZ, DURATION_S)
    }

    /// What a camera writes of it that sees it every so often, s, first at a time, s, off by noise in degrees about each axis; and each
    /// attitude as `given`.
    fn camera(
        &self,
        from_s: f64,
        every_s: f64,
        noise_deg: f64,
        seed: u64,
        given: impl Fn(DQuat) -> DQuat,
    ) -> PathBuf {
        let path = self.folder.join("camera.csv");
        let rng = &mut Pcg64::seed_from_u64(seed);
        let mut lines = "time [s],qw,qx,qy,qz\n".to_owned();
        let first = (from_s * RATE_HZ) as usize;
        let seen = self.truth.iter().enumerate().skip(first);
        for (sample, instant) in seen.step_by((every_s * RATE_HZ) as usize) {
            let off: [f64; 3] = core::array::from_fn(|_| rng.sample(StandardNormal));
            let off = DVec3::from_array(off) * noise_deg.to_radians();
            let q = given(DQuat::from_scaled_axis(off) * instant.attitude);
            let time_s = sample as f64 / RATE_HZ;
            lines += &format!("{time_s},{},{},{},{}\n", q.w, q.x, q.y, q.z);
        }
        std::fs::write(&path, lines).expect("writes");
        path
    }

    /// Decouples it with these attitudes; whether it is done, and what is said.
    fn decoupled(&self, camera: &Path, deviation_deg: f64, more: &[&str]) -> (bool, String) {
        let (path, out) = (self.folder.join("ride.csv"), self.folder.join("out.csv"));
        let calibration = calibration();
        let aid = format!("attitude={},{deviation_deg}", text(camera));
        let first = ["decouple", &calibration, text(&path), "--gain", &self.gains];
        let last = ["--down", "0,0,-1", "--aid", &aid, "--out", text(&out)];
        let output = run(&[&first[..], &last, more].concat());
        assert_eq!(out.exists(), output.status.success(), "{}", stderr(&output));
        let _ = std::fs::remove_file(&out);
        (output.status.success(), stderr(&output))
    }
}

/// As a file has an attitude whose columns qw, qx, qy, qz hold x, y, z, w.
fn w_last(q: DQuat) -> DQuat {
    DQuat::from_xyzw(q.y, q.z, q.w, q.x)
}

#[test]
fn neg_attitudes_in_another_convention_are_refused_with_the_one_they_are_in() {
    const CONJUGATE: &str = "These would fit from the ground's axes to the sensor's; change";
    const NONE: &str = "If these are, then DEGREES is too small";
    let frame = DQuat::from_scaled_axis(DVec3::new(0.1, 0.5, 0.3));
    type Case<'a> = (&'a str, &'a dyn Fn(DQuat) -> DQuat, [&'a str; 2]);
    let cases: [Case; 5] = [
        (
            "conjugate",
            &|q| q.conjugate(),
            [" attitudes contradict the channels", CONJUGATE],
        ),
        (
            "w last",
            &w_last,
            [
                "attitude 1, at 0 s: 1",
                "These would fit with qw in the last place",
            ],
        ),
        (
            "both",
            &|q| w_last(q.conjugate()),
            ["attitude 1, at 0 s: 1", "in the last place"],
        ),
        (
            "other ground axes",
            &|q| frame * q,
            ["attitude 1, at 0 s: 3", NONE],
        ),
        (
            "other sensor axes",
            &|q| q * frame,
            ["attitude 1, at 0 s: 3", NONE],
        ),
    ];
    let recorded = Ride::of(Kind::TumbleWithRests, "other");
    for (name, given, words) in cases {
        for more in [&[][..], &["--smooth"]] {
            let camera = recorded.camera(0.0, 1.0, 0.5, 1, given);
            let (done, said) = recorded.decoupled(&camera, 0.5, more);
            assert!(!done && said.contains("camera.csv: "), "{name}: {said}");
            for word in words {
                assert!(said.contains(word), "{name}, {word}: {said}");
            }
        }
    }
}

#[test]
fn prop_noise_as_stated_refuses_no_attitudes() {
    for kind in [Kind::TumbleWithRests, Kind::Vehicle] {
        let recorded = Ride::of(kind, "noise");
        for seed in 0..20 {
            let camera = recorded.camera(0.0, 1.0, 0.5, seed, |q| q);
            let (done, said) = recorded.decoupled(&camera, 0.5, &[]);
            assert!(done, "{kind:?}, {seed}: {said}");
        }
    }
}

/// A vehicle turns so slowly that the filter follows its conjugates after a while.
#[test]
fn neg_conjugates_of_a_slow_turn_are_refused() {
    const DEVIATION_DEG: f64 = 0.2;
    let recorded = Ride::of(Kind::Vehicle, "slow");
    let camera = recorded.camera(0.0, 1.0, DEVIATION_DEG, 1, |q| q.conjugate());
    let (done, said) = recorded.decoupled(&camera, DEVIATION_DEG, &[]);
    assert!(
        !done && said.contains("attitudes contradict the channels"),
        "{said}"
    );
}

/// A camera that once takes one marker for another.
#[test]
fn prop_one_wrong_attitude_of_many_is_counted_and_no_more() {
    let recorded = Ride::of(Kind::TumbleWithRests, "slip");
    let at = std::cell::Cell::new(0);
    let camera = recorded.camera(0.0, 1.0, 0.5, 1, |q| match at.replace(at.get() + 1) {
        7 => q * DQuat::from_rotation_z(2.0),
        _ => q,
    });
    let (done, said) = recorded.decoupled(&camera, 0.5, &[]);
    assert!(
        done && said.contains("1 of 20 attitudes contradict"),
        "{said}"
    );
}
