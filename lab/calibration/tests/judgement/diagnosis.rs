//! Days in closed form, each with one thing wrong: the diagnosis names it, where it is, and its size in the evidence.
//!
//! Limbs share the load by statics, standards read the motion itself, channels have next to no noise: whatever a finding says beside
//! the one thing is an invention of the judge's.

use core::f64::consts::{PI, TAU};
use std::path::Path;

use glam::{DQuat, DVec3};
use sixaxis_calibration::conditioning::Conditioned;
use sixaxis_calibration::diagnosis::rig::accelerometer_changes;
use sixaxis_calibration::diagnosis::trial_case::{Facts, Standard};
use sixaxis_calibration::diagnosis::{Diagnosis, examine};
use sixaxis_calibration::finding::{Cause, Finding};
use sixaxis_calibration::page::calibration::page;
use sixaxis_calibration::trial::Trial;
use sixaxis_core::identify::inertia::euler_torque;
use sixaxis_core::identify::static_load_sharing::StaticLoadSharing;
use sixaxis_core::{Gains, Geometry, InertiaPerMass, LIMBS, Parameters};
use sixaxis_page::{Block, Figure};
use sixaxis_recordings::session::{Rig, Role, SessionFile};

use crate::waveform::Timing;

const RATE_HZ: f64 = 1000.0;
const FREQUENCY_HZ: f64 = 5.0;
const OMEGA: f64 = TAU * FREQUENCY_HZ;
const TIMING: Timing = Timing {
    rest_s: 0.2,
    ramp_s: 0.4,
    run_s: 4.0,
};
const SAMPLES: usize = 4000;
/// Amplitudes of travel and rotation.
const TRAVEL_M: f64 = 0.02;
const TURN_RAD: f64 = 0.4;
const GAIN_N_PER_V: f64 = 1.0;
const FULL_SCALE_V: f64 = 5.0;
const GRAVITY_M_S2: f64 = 9.80665;
/// Spread of the channels' noise, evenly distributed: without any, what carries no load shows the rounding's flat tops.
const NOISE_V: f64 = 2e-5;

const DESIGN: Parameters = Parameters {
    zero_drift_v: [0.0; LIMBS],
    scale_per_mass_per_kg: [5.0, 5.2, 5.4, 5.6, 5.8, 6.0, 6.2, 6.4, 6.6],
    inertia_per_mass: InertiaPerMass {
        xx_m2: 240e-6,
        yy_m2: 250e-6,
        zz_m2: 260e-6,
        xy_m2: 8e-6,
        xz_m2: -12e-6,
        yz_m2: 16e-6,
    },
    stiffness_per_mass_per_s2: 1e9,
};

/// What the page needs of a session: the design.
const SESSION: &str = r#"title = "a day in closed form"
[sensor]
serial = "7"
limb_length_mm = 25.5
half_edge_mm = 21.0
full_scale_v = 5.0
gain_n_per_v = 1.0
[sensor.design]
scale_per_mass_per_kg = 5.8
inertia_per_mass_mm2 = [240.0, 250.0, 260.0, 8.0, -12.0, 16.0]
stiffness_per_mass_per_s2 = 1e9
[accelerometer]
class_percent = 1.0
[gyroscope]
class_percent = 1.0
[[recording]]
file = "run 1"
role = "linear"
direction = [1, 0, 0]
frequency_hz = 5.0
"#;

/// One run as it was, and as the session has it.
#[derive(Clone)]
struct Run {
    role: Role,
    stated: DVec3,
    moved: DVec3,
    travel_m: f64,
    turn_rad: f64,
    /// Time by which the standards lag, s, and by which that grows from the run's beginning to its end.
    late_s: f64,
    later_s: f64,
    gravity: DVec3,
    stated_gravity: DVec3,
    stated_frequency_hz: f64,
}

impl Run {
    fn new(role: Role, direction: DVec3) -> Self {
        let direction = direction.normalize();
        Self {
            role,
            stated: direction,
            moved: direction,
            travel_m: if role == Role::Angular { 0.0 } else { TRAVEL_M },
            turn_rad: if role == Role::Linear { 0.0 } else { TURN_RAD },
            late_s: 0.0,
            later_s: 0.0,
            gravity: -direction * GRAVITY_M_S2,
            stated_gravity: -direction * GRAVITY_M_S2,
            stated_frequency_hz: FREQUENCY_HZ,
        }
    }

    fn played(&self, name: &str) -> (Trial, Conditioned) {
        let shares = StaticLoadSharing::new(&Geometry::PAPER).expect("the paper's sensor");
        let voltage = |t: f64| -> [f64; LIMBS] {
            let [angle, rate, acceleration] = TIMING.course(t, OMEGA);
            let a = self.moved * (acceleration * OMEGA * OMEGA * self.travel_m);
            let w = self.moved * (rate * OMEGA * self.turn_rad);
            let dw = self.moved * (acceleration * OMEGA * OMEGA * self.turn_rad);
            let torque = euler_torque(&DESIGN.inertia_per_mass, w, dw);
            let back = DQuat::from_axis_angle(self.moved, -angle * self.turn_rad);
            // Tared at rest.
            let weight = self.gravity - back * self.gravity;
            core::array::from_fn(|i| {
                let force = shares.of_acceleration(i).dot(a + weight)
                    + shares.of_torque_per_m(i).dot(torque);
                force / DESIGN.scale_per_mass_per_kg[i] / GAIN_N_PER_V
            })
        };
        let time = |n: usize| n as f64 / RATE_HZ;
        let each =
            |f: &dyn Fn(f64) -> f64| -> Vec<f64> { (0..SAMPLES).map(|n| f(time(n))).collect() };
        let linear = each(&|t| TIMING.course(t, OMEGA)[2] * OMEGA * OMEGA * self.travel_m);
        let rate = each(&|t| TIMING.course(t, OMEGA)[1] * OMEGA * self.turn_rad);
        let angular = each(&|t| TIMING.course(t, OMEGA)[2] * OMEGA * OMEGA * self.turn_rad);
        let along = |series: &[f64]| series.iter().map(|x| self.stated * *x).collect();
        let mut state = 20_261_123_u64;
        let mut noise = || {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            NOISE_V * ((state >> 11) as f64 / (1_u64 << 53) as f64 - 0.5)
        };
        let voltage_v: Vec<[f64; LIMBS]> = (0..SAMPLES)
            .map(|n| {
                let place = time(n) / TIMING.run_s - 0.5;
                let row = voltage(time(n) + self.late_s + place * self.later_s);
                row.map(|u| u + noise())
            })
            .collect();
        let conditioned = Conditioned {
            voltage_v: voltage_v.clone(),
            linear_ground_m_s2: along(&linear),
            rate_shell_rad_s: along(&rate),
            angular_shell_rad_s2: along(&angular),
            outliers: 0,
            zero_wander_v: [0.0; LIMBS],
        };
        let trial = Trial {
            name: name.to_owned(),
            role: self.role,
            sample_rate_hz: RATE_HZ,
            gains: Gains::uniform(GAIN_N_PER_V),
            full_scale_v: FULL_SCALE_V,
            voltage_v,
            accelerometer_m_s2: linear,
            gyroscope_rad_s: rate,
            limbs_band_hz: f64::INFINITY,
            standards_band_hz: f64::INFINITY,
            direction_ground: self.stated,
            gravity_ground_m_s2: self.stated_gravity,
            frequency_hz: self.stated_frequency_hz,
        };
        (trial, conditioned)
    }
}

/// Off the axes and off the planes between them, so that every limb has a share of every run.
const DIRECTIONS: [DVec3; 6] = [
    DVec3::new(1.0, 0.3, 0.2),
    DVec3::new(-0.2, 1.0, 0.3),
    DVec3::new(0.3, -0.2, 1.0),
    DVec3::new(1.0, 1.0, 0.4),
    DVec3::new(1.0, 0.4, -1.0),
    DVec3::new(1.0, 2.0, 3.0),
];
/// Where the angular trials and the compound one stand among all.
const ANGULAR: core::ops::Range<usize> = 6..12;
const COMPOUND: usize = 12;

fn healthy() -> Vec<Run> {
    let of = |role: Role| DIRECTIONS.map(|d| Run::new(role, d));
    let mut runs = [of(Role::Linear), of(Role::Angular)].concat();
    runs.push(Run::new(Role::Validation, DVec3::new(2.0, -1.0, 1.0)));
    runs
}

fn name(index: usize) -> String {
    format!("run {}", index + 1)
}

type Played = Vec<(Trial, Conditioned)>;

fn played(runs: &[Run]) -> Played {
    let named = runs.iter().enumerate();
    named.map(|(i, run)| run.played(&name(i))).collect()
}

/// Changes each voltage of some trials as the channel, from 0, and the sample say.
fn change(
    trials: &mut Played,
    which: impl Iterator<Item = usize>,
    of: impl Fn(usize, usize, f64) -> f64,
) {
    for index in which {
        let (trial, conditioned) = &mut trials[index];
        for (n, row) in trial.voltage_v.iter_mut().enumerate() {
            *row = core::array::from_fn(|channel| of(channel, n, row[channel]));
        }
        conditioned.voltage_v.clone_from(&trial.voltage_v);
    }
}

fn at_rest() -> Trial {
    let mut rest = Run::new(Role::Linear, DVec3::Z).played("rest").0;
    rest.role = Role::Static;
    rest.voltage_v = vec![[0.0; LIMBS]; 1600];
    rest
}

const RIG: Rig = Rig {
    stroke_mm: Some(2e3 * TRAVEL_M),
    rotation_amplitude_deg: Some(TURN_RAD * 180.0 / PI),
    wedge_deg: None,
    gravity_m_s2: None,
};

/// A standard without error.
const EXACT: Standard = Standard {
    gain_limit: 0.0,
    lag_s: 0.0,
};

struct Day {
    trials: Played,
    rest: Trial,
    rig: Option<Rig>,
    design: Parameters,
}

impl Day {
    fn of(runs: &[Run]) -> Self {
        Self {
            trials: played(runs),
            rest: at_rest(),
            rig: Some(RIG),
            design: DESIGN,
        }
    }

    fn facts(&self) -> Facts<'_> {
        Facts {
            geometry: Geometry::PAPER,
            design: &self.design,
            rig: self.rig.as_ref(),
            accelerometer: EXACT,
            gyroscope: EXACT,
            gyroscope_class: 0.0,
            gyroscope_lag_undone: false,
        }
    }

    fn examined<T>(&self, read: impl Fn(&Diagnosis<'_>) -> T) -> T {
        read(&examine(&self.facts(), Some(&self.rest), &self.trials))
    }

    fn findings(&self) -> Vec<Finding> {
        self.examined(|diagnosis| diagnosis.all())
    }

    /// The one finding, with trials and channels counted from 0.
    #[track_caller]
    fn shows(&self, cause: Cause, trials: &[usize], channels: &[usize], evidence: &str) {
        let found = self.findings();
        assert_eq!(found.len(), 1, "{found:#?}");
        self.shows_first(cause, trials, channels, evidence);
    }

    /// The first finding; others follow from what is wrong.
    #[track_caller]
    fn shows_first(&self, cause: Cause, trials: &[usize], channels: &[usize], evidence: &str) {
        let found = self.findings();
        let Some(finding) = found.first() else {
            panic!("nothing found")
        };
        assert_eq!(finding.cause, cause, "{finding:?}");
        let names: Vec<String> = trials.iter().map(|i| name(*i)).collect();
        assert_eq!(finding.recordings, names, "{finding:?}");
        let numbers: Vec<usize> = channels.iter().map(|i| i + 1).collect();
        assert_eq!(finding.channels, numbers, "{finding:?}");
        assert!(finding.evidence.contains(evidence), "{finding:?}");
        self.is_drawn(finding, trials, channels);
    }

    /// The page shows the trial and the channel that a finding names, as recorded, beside a neighbour that departs less from what is
    /// expected.
    #[track_caller]
    fn is_drawn(&self, finding: &Finding, trials: &[usize], channels: &[usize]) {
        let recordings = self.trials.iter().cloned();
        let recordings = recordings.map(|(trial, conditioned)| (trial, Some(conditioned)));
        let mut calibrated = crate::bare::calibrated(recordings.collect());
        calibrated.recordings.push((self.rest.clone(), None));
        calibrated.findings = vec![finding.clone()];
        calibrated.table = self.examined(|diagnosis| diagnosis.table.clone());
        let path = Path::new("day/session.toml");
        let file = SessionFile::parse(path, SESSION.to_owned()).expect("it can be parsed");
        let sections = page(&file, &calibrated).sections;
        let blocks = sections.iter().flat_map(|section| &section.blocks);
        let figures = blocks.clone().filter_map(|block| match block {
            Block::FigureGrid(figures) if figures[0].id.starts_with("finding-") => Some(figures),
            _ => None,
        });
        let figures: Vec<&Figure> = figures.flatten().collect();
        if finding.recordings.is_empty() && channels.is_empty() {
            assert!(figures.is_empty(), "{finding:?}");
            return;
        }
        let subjects = channels.len().max(1);
        let (of_finding, neighbours) = figures.split_at(subjects);
        let numbers = channels.iter().map(|c| Some(c + 1)).chain([None]);
        for (figure, number) in of_finding.iter().zip(numbers) {
            let title = figure
                .title
                .split_once(", channel ")
                .expect("it names both");
            let place = calibrated
                .recordings
                .iter()
                .position(|(t, _)| t.name == title.0);
            let place = place.expect("a recording of the day");
            let channel: usize = title.1.parse().expect("a number");
            assert!(number.is_none_or(|number| number == channel), "{finding:?}");
            assert!(
                trials.first().is_none_or(|trial| *trial == place),
                "{finding:?}"
            );
            let recorded = &calibrated.recordings[place].0.voltage_v;
            for (time_s, voltage_v) in &figure.series[0].points {
                let row = (time_s * RATE_HZ).round() as usize;
                assert_eq!(recorded[row][channel - 1].to_bits(), voltage_v.to_bits());
            }
        }
        let departs = |figure: &Figure| {
            let below = figure.below.as_ref().expect("what is not expected");
            let points = below.series[0].points.iter();
            points.fold(0.0_f64, |most, (_, y)| most.max(y.abs()))
        };
        let [neighbour] = neighbours else {
            panic!("{} neighbours: {finding:?}", neighbours.len())
        };
        let mut texts = blocks.filter_map(|block| match block {
            Block::Text(text) => Some(text),
            _ => None,
        });
        let in_vain = texts.any(|text| text.contains("does not show here"));
        if finding.cause == Cause::Unreadable {
            // Standards that stand still do so as they are read; what was conditioned is the motion's.
            return;
        }
        // A drive that turns otherwise than the session says, and a zero that is another all through the run: it is drawn about its own.
        let hidden = ["by the session", "between the static record and the run"]
            .iter()
            .any(|words| finding.evidence.contains(words));
        assert_eq!(in_vain, hidden, "{finding:?}");
        assert!(
            hidden
                || of_finding
                    .iter()
                    .all(|f| departs(f) > 2.0 * departs(neighbour)),
            "{finding:?}"
        );
    }
}

/// A healthy day with some voltages changed.
fn with(which: impl Iterator<Item = usize>, of: impl Fn(usize, usize, f64) -> f64) -> Day {
    let mut day = Day::of(&healthy());
    change(&mut day.trials, which, of);
    day
}

/// A healthy day with some runs changed.
fn where_runs(which: impl Iterator<Item = usize>, of: impl Fn(&mut Run)) -> Day {
    let mut runs = healthy();
    for index in which {
        of(&mut runs[index]);
    }
    Day::of(&runs)
}

const ALL: core::ops::RangeInclusive<usize> = 0..=COMPOUND;

fn one(channel: usize, of: impl Fn(f64) -> f64) -> impl Fn(usize, usize, f64) -> f64 {
    move |i, _, u| if i == channel { of(u) } else { u }
}

#[test]
fn inv_a_healthy_day_shows_nothing() {
    let day = Day::of(&healthy());
    assert_eq!(day.findings(), []);
    let departures = day.examined(|diagnosis| diagnosis.departures.clone());
    assert_eq!(departures.len(), COMPOUND + 1);
    // The derivative of a cubic through nine samples is right to the fourth power of a sample's phase.
    for departure in departures {
        assert!(departure.is_some_and(|d| d < 3e-4), "{departure:?}");
    }
    // Weight that turns, as the session says.
    let day = where_runs([8, 9].into_iter(), |run| {
        let side = run.moved.any_orthogonal_vector().normalize() * GRAVITY_M_S2;
        (run.gravity, run.stated_gravity) = (side, side);
    });
    assert_eq!(day.findings(), []);
    // Converters round.
    let day = with(ALL, |_, _, u| (u * 200.0).round() / 200.0);
    assert_eq!(day.findings(), []);
}

/// A channel that a slower card holds stands still at its crests, too, and is not cut off there.
#[test]
fn inv_held_channels_are_no_clipped_ones() {
    let mut day = Day::of(&healthy());
    for (trial, _) in &mut day.trials {
        for n in 0..trial.voltage_v.len() {
            trial.voltage_v[n][4] = trial.voltage_v[n - n % 5][4];
        }
    }
    let found = day.findings();
    let [first, ..] = &found[..] else {
        panic!("nothing is said")
    };
    assert_eq!(first.cause, Cause::Unreadable, "{found:#?}");
    assert!(
        first
            .evidence
            .starts_with("each reading of channel 5 stands there 5 times"),
        "{found:#?}"
    );
    let clips = |f: &Finding| f.cause == Cause::ClippedConverter;
    assert!(!found.iter().any(clips), "{found:#?}");
}

#[test]
fn inv_what_a_recording_shows_by_itself_is_named() {
    let day = Day::of(&healthy());
    let rows = |day: &Day| day.trials[3].0.voltage_v.clone();
    let limit = 0.7
        * rows(&day)
            .iter()
            .fold(0.0_f64, |most, row| most.max(row[4].abs()));
    let limit = (1e4 * limit).round() / 1e4;
    let mut day = with(3..4, one(4, |u| u.clamp(-limit, limit)));
    let count = |is: &dyn Fn(f64) -> bool| rows(&day).iter().filter(|row| is(row[4])).count();
    let (either, low) = (count(&|u| u.abs() == limit), count(&|u| u == -limit));
    // Four equal readings at one crest of many, where noise may have repeated itself: no converter does that.
    let crest = rows(&day).iter().map(|row| row[4]).fold(f64::MIN, f64::max);
    let top = rows(&day)
        .iter()
        .position(|row| row[4] == crest)
        .expect("a crest");
    let at_the_crest = move |_, n: usize, u: f64| match n.abs_diff(top) {
        0..=1 => 1.02 * crest,
        _ if n == top + 2 => 1.02 * crest,
        _ => u,
    };
    let repeated = with(
        3..4,
        move |i, n, u| if i == 4 { at_the_crest(i, n, u) } else { u },
    );
    let clips = |f: &Finding| f.cause == Cause::ClippedConverter;
    assert!(
        !repeated.findings().iter().any(clips),
        "{:#?}",
        repeated.findings()
    );
    day.shows(
        Cause::ClippedConverter,
        &[3],
        &[4],
        &format!("flat at -{limit:.4} V in {low} samples, below the limit of 5 V"),
    );
    day.trials[3].0.full_scale_v = limit;
    let found = day.findings();
    let expected =
        format!("{either} of {SAMPLES} samples stand at the converter's limit of {limit} V");
    let own = |f: &&Finding| f.channels == [5] && f.evidence == expected;
    assert_eq!(
        found.iter().filter(own).count(),
        1,
        "{expected}: {found:#?}"
    );

    with(ALL, |_, _, u| 1000.0 * u).shows(
        Cause::MillivoltMixUp,
        &[],
        &[],
        "from a converter that ends at 5 V",
    );
    // A factor that is none of a unit, and leaves the converter's range.
    for factor in [5.0, 8.0] {
        let found = with(2..3, |_, _, u| factor * u).findings();
        let beyond = |f: &&Finding| f.evidence.contains("from a converter that ends at 5 V");
        assert_eq!(found.iter().filter(beyond).count(), 1, "{found:#?}");
        let scaled = |f: &Finding| f.cause == Cause::WrongScaling && f.recordings == [name(2)];
        assert!(found.iter().all(scaled), "{found:#?}");
    }
    with(2..3, |_, _, u| 1000.0 * u).shows(
        Cause::MillivoltMixUp,
        &[2],
        &[],
        "from a converter that ends at 5 V",
    );
    with(ALL, one(6, |u| 1000.0 * u)).shows(
        Cause::MillivoltMixUp,
        &[],
        &[6],
        "from a converter that ends at 5 V",
    );

    let mut day = Day::of(&healthy());
    day.trials[1].0.accelerometer_m_s2.fill(0.25);
    day.shows(
        Cause::Unreadable,
        &[1],
        &[],
        "accelerometer reads one value throughout",
    );
    let mut day = Day::of(&healthy());
    day.trials[7].0.gyroscope_rad_s.fill(0.25);
    day.shows(
        Cause::Unreadable,
        &[7],
        &[],
        "gyroscope reads one value throughout",
    );
}

#[test]
fn inv_channels_that_are_not_their_limbs_are_named() {
    with(ALL, one(3, |_| 0.0)).shows(Cause::DeadLimb, &[], &[3], "no response to the motion in");
    with(5..6, one(7, |_| 0.0)).shows(
        Cause::DeadLimb,
        &[5],
        &[7],
        "no response to the motion in 1 of",
    );
    with(ALL, one(4, |u| -u)).shows(
        Cause::InvertedChannel,
        &[],
        &[4],
        "scale factor -5.800 1/kg, of the other sign than the design's 5.800 1/kg",
    );
    with(ALL, |_, _, u| -u).shows(
        Cause::InvertedChannel,
        &[],
        &[],
        "all scale factors have the other sign than the design's, and the inertias have not",
    );
    // As an accelerometer that is reversed in all of them.
    let found = with(LINEAR, |_, _, u| -u).findings();
    let reversed = "and so have the inertias: the standard accelerometer is reversed";
    assert!(
        found
            .iter()
            .any(|f| f.cause == Cause::WrongScaling && f.evidence.contains(reversed)),
        "{found:#?}"
    );
}

#[test]
fn inv_directions_that_are_left_out_are_named() {
    for (role, what) in [(Role::Linear, "linear"), (Role::Angular, "angular")] {
        let flat = |run: Run| match run.role == role {
            true => Run::new(role, run.stated.with_z(0.0)),
            false => run,
        };
        let runs: Vec<Run> = healthy().into_iter().map(flat).collect();
        let found = Day::of(&runs).findings();
        assert_eq!(
            found.first().map(|f| f.cause),
            Some(Cause::UnderExcitedAxis),
            "{found:#?}"
        );
        let expected = format!("the {what} trials together move 0.0 % as much along");
        assert!(found[0].evidence.contains(&expected), "{found:#?}");
    }
}

#[test]
fn inv_weight_that_the_session_does_not_know_is_named() {
    let day = where_runs(8..9, |run| {
        run.gravity = run.moved.any_orthogonal_vector().normalize() * GRAVITY_M_S2;
    });
    day.shows(
        Cause::GravityNotHandled,
        &[8],
        &[],
        "as a weight of 9.81 m/s² would, but by the directions in the session it should be 0.00 m/s²",
    );
    let day = where_runs(8..9, |run| {
        run.stated_gravity = run.moved.any_orthogonal_vector().normalize() * GRAVITY_M_S2;
    });
    day.shows(
        Cause::GravityNotHandled,
        &[8],
        &[],
        "as a weight of 0.00 m/s² would, but by the directions in the session it should be 9.81 m/s²",
    );
}

#[test]
fn inv_clocks_are_told_by_their_lag() {
    where_runs(2..3, |run| run.late_s = 2e-3).shows(
        Cause::ClockMismatch,
        &[2],
        &[],
        "the standards are 2.00 ms behind the sensor in the middle of run 3, and that changes by",
    );
    where_runs(2..3, |run| run.late_s = -2e-3).shows(
        Cause::ClockMismatch,
        &[2],
        &[],
        "the standards are -2.00 ms behind the sensor",
    );
    where_runs(2..3, |run| run.later_s = 3e-3).shows(
        Cause::ClockMismatch,
        &[2],
        &[],
        "and that changes by 3.0",
    );
    // A first-order lag of tau turns a sine back by atan(omega tau).
    where_runs(ANGULAR, |run| run.late_s = (OMEGA * 2e-3).atan() / OMEGA).shows(
        Cause::GyroscopeLag,
        &[],
        &[],
        "in all 6 angular trials the gyroscope is 2.0 ms behind the sensor, as a first-order bandwidth of 79.6 Hz",
    );
    where_runs(ANGULAR, |run| run.late_s = -2e-3).shows(
        Cause::ClockMismatch,
        &[6, 7, 8, 9, 10, 11],
        &[],
        "the standards are -2.00 ms behind",
    );
    where_runs(6..7, |run| run.late_s = 2e-3).shows(
        Cause::ClockMismatch,
        &[6],
        &[],
        "the standards are 2.00 ms behind the sensor in the middle of run 7",
    );
    let mut day = where_runs(4..5, |run| run.stated_frequency_hz = 5.25);
    day.rig = None;
    day.shows(
        Cause::ClockMismatch,
        &[4],
        &[],
        "the drive turns at 5.000 Hz by the standard and the recording's clock, at 5.250 Hz by the session",
    );
    let mut day = where_runs(4..5, |run| run.stated_frequency_hz = 5.05);
    day.rig = None;
    assert_eq!(day.findings(), []);
}

#[test]
fn inv_factors_that_all_share_are_told_by_their_size() {
    let scaled = |linear: f64, rate: f64| {
        let mut day = Day::of(&healthy());
        for (trial, conditioned) in &mut day.trials {
            trial
                .accelerometer_m_s2
                .iter_mut()
                .for_each(|a| *a *= linear);
            trial.gyroscope_rad_s.iter_mut().for_each(|w| *w *= rate);
            conditioned
                .linear_ground_m_s2
                .iter_mut()
                .for_each(|a| *a *= linear);
            conditioned
                .rate_shell_rad_s
                .iter_mut()
                .for_each(|w| *w *= rate);
            conditioned
                .angular_shell_rad_s2
                .iter_mut()
                .for_each(|w| *w *= rate);
        }
        day
    };
    // Standards in the wrong unit, seen against the rig, and all that was fitted to them with it.
    for (linear, rate, what) in [
        (1.0 / 9.80665, 1.0, "accelerometer shows 1/9."),
        (1.0, 57.29578, "gyroscope shows 5"),
    ] {
        let found = scaled(linear, rate).findings();
        let own = found.iter().filter(|f| f.evidence.contains(what)).count();
        assert_eq!(own, 1, "{found:#?}");
        let reason = if rate > 1.0 {
            "degrees and radians"
        } else {
            "g and m/s²"
        };
        assert!(found[0].evidence.contains(reason), "{found:#?}");
        assert_eq!(found[0].cause, Cause::WrongScaling);
    }
    // A clock that is fast by 2 %: rates and accelerations are what they were, and the drive seems to turn faster.
    let mut fast = Day::of(&healthy());
    for (trial, _) in &mut fast.trials {
        trial.sample_rate_hz *= 1.02;
    }
    let found = fast.findings();
    let clock = found
        .iter()
        .filter(|f| f.evidence.contains("a clock that is fast by 2.00 %"));
    assert_eq!(clock.count(), 1, "{found:#?}");
    assert!(
        found.iter().all(|f| f.cause == Cause::ClockMismatch),
        "{found:#?}"
    );
    // By 0.5 %, where the standards' own errors hide a part.
    let mut fast = scaled(1.0025, 0.9985);
    for (trial, _) in &mut fast.trials {
        trial.sample_rate_hz *= 1.005;
    }
    let found = fast.findings();
    assert_eq!(found[0].cause, Cause::ClockMismatch, "{found:#?}");
    // By 0.25 %, as much as a motor may turn slower of itself: where the gyroscope does not bear the clock out it is one of two things.
    let mut fast = scaled(1.001, 0.9985);
    for (trial, _) in &mut fast.trials {
        trial.sample_rate_hz *= 0.9975;
    }
    fast.shows(
        Cause::Unexplained,
        &[],
        &[],
        "by the recordings' clock the drive turns 0.25 % slower than the session says, as a motor may, and the standard accelerometer reads +0.60 %",
    );
    // One standard alone, by what no certificate leaves it.
    for (linear, rate) in [(1.02, 1.0), (0.98, 1.0), (1.0, 1.02), (1.0, 0.98)] {
        let found = scaled(linear, rate).findings();
        assert_eq!(found[0].cause, Cause::WrongScaling, "{found:#?}");
        assert!(found[0].recordings.is_empty(), "{found:#?}");
    }
    // The accelerometer alone, where nothing is known of the rig.
    let mut day = with(ALL, |_, _, u| u / 5.0);
    day.shows(
        Cause::WrongScaling,
        &[],
        &[],
        "all scale factors come out at 5.000 times the design's; a step of an amplifier's range",
    );
    day = with(ALL, |_, _, u| u / 1000.0);
    day.shows(
        Cause::MillivoltMixUp,
        &[],
        &[],
        "all scale factors come out at 1000.000 times the design's; volts and millivolts",
    );
    assert_eq!(with(ALL, |_, _, u| u / 2.0).findings(), []);
    // One channel of little force: of little voltage, which may be the limb's or the amplifier's, or of a written gain.
    let of_one = "its scale factor comes out at 100.000 times what the other channels make of the design; a decade";
    with(ALL, one(5, |u| u / 100.0)).shows(Cause::Unexplained, &[], &[5], of_one);
    let mut day = Day::of(&healthy());
    for (trial, _) in &mut day.trials {
        trial.gains.gain_n_per_v[5] /= 100.0;
    }
    day.shows_first(Cause::WrongScaling, &[], &[5], of_one);
    assert_eq!(with(ALL, one(5, |u| u / 3.0)).findings(), []);
    // What the rig bears out is no standard's doing.
    for (factor, by_the_rig, cause, evidence) in [
        (
            2.0,
            false,
            Cause::WrongScaling,
            "the inertias come out at 1/2.000 of the design's, which the drawing fixes far better; a step",
        ),
        (
            0.7,
            false,
            Cause::WrongScaling,
            "the inertias come out at 1.429 times the design's",
        ),
        (
            0.7,
            true,
            Cause::Unexplained,
            "the inertias come out at 1.429 times the design's, which the drawing fixes far better; by the rig's stroke and rotation both",
        ),
    ] {
        let mut day = Day::of(&healthy());
        let inertia = DESIGN.inertia_per_mass.to_paper_order().map(|i| factor * i);
        day.design.inertia_per_mass = InertiaPerMass::from_paper_order(inertia);
        day.rig = day.rig.filter(|_| by_the_rig);
        day.shows(cause, &[], &[], evidence);
    }
    let mut day = Day::of(&healthy());
    let inertia = DESIGN.inertia_per_mass.to_paper_order().map(|i| 1.4 * i);
    day.design.inertia_per_mass = InertiaPerMass::from_paper_order(inertia);
    assert_eq!(day.findings(), []);
}

/// The number behind some words.
fn millivolt(evidence: &str, words: &str) -> f64 {
    let number = evidence
        .strip_prefix(words)
        .and_then(|rest| rest.split(' ').next());
    number.and_then(|x| x.parse().ok()).unwrap_or(f64::NAN)
}

#[test]
fn inv_zeros_that_move_are_told_by_their_size() {
    let place = |n: usize| n as f64 / (SAMPLES - 1) as f64;
    for size in [0.06, -0.06] {
        with(
            1..2,
            move |i, n, u| if i == 2 { u + size * place(n) } else { u },
        )
        .shows(
            Cause::DriftDuringRun,
            &[1],
            &[2],
            &format!("the zero moves by {:.1} mV during the run", 1e3 * size),
        );
        // Next to nothing moves at the ends of what counts as rest.
        let day = with(9..10, one(8, move |u| u + size));
        day.shows(
            Cause::DriftDuringRun,
            &[9],
            &[8],
            "mV between the static record and the run",
        );
        let moved = millivolt(&day.findings()[0].evidence, "the zero moves by ");
        assert!((moved - 1e3 * size).abs() < 1.0, "{moved}");
    }
    assert_eq!(
        with(1..2, move |i, n, u| if i == 2 {
            u + 2e-3 * place(n)
        } else {
            u
        })
        .findings(),
        []
    );
    // From the first of sixteen pieces' middle to the last's: 15/16 of what the zero wanders by.
    let wandering = |size: f64, noise: f64| {
        let mut day = Day::of(&healthy());
        let samples = day.rest.voltage_v.len();
        for (n, row) in day.rest.voltage_v.iter_mut().enumerate() {
            // Pieces of a hundred samples lie above and below the line by turns.
            let sign = if (n / 100).is_multiple_of(2) {
                1.0
            } else {
                -1.0
            };
            row[7] = size * (n as f64 / samples as f64 - 0.5) + sign * noise;
        }
        day
    };
    for (size, noise) in [(16e-3, 0.0), (-16e-3, 0.0), (16e-3, 0.3e-3)] {
        let found = wandering(size, noise).findings();
        let [finding] = &found[..] else {
            panic!("{found:#?}")
        };
        assert_eq!(finding.channels, [8]);
        let wandered = millivolt(&finding.evidence, "the zero wanders by ");
        assert!((wandered - 15.0 * size.signum()).abs() < 0.2, "{finding:?}");
    }
    assert_eq!(wandering(0.4e-3, 0.0).findings(), []);
    assert_eq!(wandering(16e-3, 8e-3).findings(), []);
    // A warm-up is no line.
    for share in [0.2, 0.4] {
        let mut day = Day::of(&healthy());
        let samples = day.rest.voltage_v.len() as f64;
        for (n, row) in day.rest.voltage_v.iter_mut().enumerate() {
            row[7] = 50e-3 * (-(n as f64) / samples / share).exp();
        }
        let found = day.findings();
        let drifts = |f: &&Finding| f.cause == Cause::DriftDuringRun && f.recordings == ["rest"];
        assert!(
            found.iter().any(|f| drifts(&f) && f.channels == [8]),
            "{share}: {found:#?}"
        );
    }
}

#[test]
fn inv_odd_trials_are_told_by_what_explains_them() {
    for odd in [4, 10] {
        let only = odd..odd + 1;
        with(only.clone(), |_, _, u| 1.5 * u).shows(
            Cause::WrongScaling,
            &[odd],
            &[],
            "all channels are 1.5000 times what",
        );
        with(only.clone(), |_, _, u| u / 1000.0).shows(
            Cause::MillivoltMixUp,
            &[odd],
            &[],
            "all channels are 0.0010 times what",
        );
        // A limb that carries much in both.
        for (factor, cause) in [
            (1.5, Cause::WrongScaling),
            (-1.0, Cause::InvertedChannel),
            (0.001, Cause::MillivoltMixUp),
            (0.01, Cause::DeadLimb),
        ] {
            with(only.clone(), one(5, move |u| factor * u)).shows(
                cause,
                &[odd],
                &[5],
                &format!("the channel shows {factor:.4} times"),
            );
        }
        let mut day = Day::of(&healthy());
        let (trial, conditioned) = &mut day.trials[odd];
        trial.voltage_v.iter_mut().for_each(|row| row.swap(1, 6));
        conditioned.voltage_v.clone_from(&trial.voltage_v);
        day.shows(
            Cause::SwappedChannels,
            &[odd],
            &[1, 6],
            "exchanged in this recording",
        );
        let turned = |degrees: f64| {
            where_runs(odd..odd + 1, move |run| {
                let about = run.stated.any_orthogonal_vector().normalize();
                run.moved = DQuat::from_axis_angle(about, degrees.to_radians()) * run.stated;
                run.gravity = -run.moved * GRAVITY_M_S2;
            })
        };
        turned(5.0).shows(
            Cause::LooseWedge,
            &[odd],
            &[],
            "5.0° from the stated direction",
        );
        assert_eq!(turned(0.65).findings(), []);
        with(only.clone(), |i, _, u| u * (1.0 + 0.1 * (i % 3) as f64)).shows(
            Cause::ForeignTrial,
            &[odd],
            &[],
            "neither a factor, an exchange nor another direction explains it",
        );
        with(only.clone(), |i, n, u| {
            u + 0.05 * (1.0 + i as f64 / 9.0) * (TAU * 30.0 * n as f64 / RATE_HZ).sin()
        })
        .shows(
            Cause::Unexplained,
            &[odd],
            &[],
            "of the signal follows neither",
        );
    }
}

/// In a run that travels and turns one standard's factor changes a part of what is expected, and of every channel another share.
#[test]
fn inv_one_standard_s_factor_in_a_compound_run_is_named() {
    let of = |standard: &str, factor: f64| {
        let mut day = Day::of(&healthy());
        let (trial, conditioned) = &mut day.trials[COMPOUND];
        let scaled = |v: &mut DVec3| *v *= factor;
        if standard == "accelerometer" {
            trial
                .accelerometer_m_s2
                .iter_mut()
                .for_each(|a| *a *= factor);
            conditioned.linear_ground_m_s2.iter_mut().for_each(scaled);
        } else {
            trial.gyroscope_rad_s.iter_mut().for_each(|w| *w *= factor);
            conditioned.rate_shell_rad_s.iter_mut().for_each(scaled);
            conditioned.angular_shell_rad_s2.iter_mut().for_each(scaled);
        }
        day
    };
    for (standard, factor, cause, said) in [
        ("accelerometer", 1.0 / 9.80665, Cause::WrongScaling, "9.8"),
        ("accelerometer", 1000.0, Cause::MillivoltMixUp, "1/1000"),
        (
            "accelerometer",
            -1.0,
            Cause::InvertedChannel,
            "the other way round",
        ),
        ("accelerometer", 1.1, Cause::WrongScaling, "1/1.10"),
        (
            "gyroscope",
            57.29578,
            Cause::WrongScaling,
            "degrees and radians",
        ),
        (
            "gyroscope",
            -1.0,
            Cause::InvertedChannel,
            "the other way round",
        ),
        ("gyroscope", 1e-6, Cause::Unreadable, "reads nothing"),
        ("gyroscope", 0.9, Cause::WrongScaling, "1.11"),
    ] {
        let found = of(standard, factor).findings();
        assert_eq!(found.len(), 1, "{standard} {factor}: {found:#?}");
        let told = |words: &str| found[0].evidence.contains(words);
        assert!(
            found[0].cause == cause && told(standard) && told(said),
            "{standard} {factor}: {found:#?}"
        );
    }
}

/// The accelerometer reads more from trial to trial, of which the first six are linear and six more are angular: along a line through all it
/// changes by the whole of that.
#[test]
fn inv_an_accelerometer_that_changes_over_the_day_is_told_by_the_rig() {
    let changes =
        |day: &Day| day.examined(|diagnosis| accelerometer_changes(&day.facts(), &diagnosis.cases));
    let mut day = Day::of(&healthy());
    assert!(changes(&day).is_some_and(|by| by.abs() < 1e-3));
    for (index, (trial, _)) in day.trials.iter_mut().enumerate() {
        let grown = 1.0 + 0.02 * index as f64 / 11.0;
        trial
            .accelerometer_m_s2
            .iter_mut()
            .for_each(|a| *a *= grown);
    }
    let by = changes(&day).expect("the rig is known");
    assert!((by - 0.02).abs() < 1e-3, "{by}");
    day.rig = None;
    assert_eq!(changes(&day), None);
}

/// In a compound run two motions' shares may cancel in a channel, and never in all of them.
#[test]
fn inv_the_unit_of_a_compound_run_is_told() {
    let day = with(COMPOUND..COMPOUND + 1, |_, _, u| 1000.0 * (u + 0.1));
    day.shows(
        Cause::MillivoltMixUp,
        &[COMPOUND],
        &[],
        "times what the design makes one expect",
    );
}

/// From one sample to another, what a loose cable leaves of a series.
const LOOSE: core::ops::Range<usize> = 1500..2000;
const LEFT: f64 = 0.01;

fn loosened(series: &mut [f64]) {
    series[LOOSE].iter_mut().for_each(|x| *x *= LEFT);
}

#[test]
fn inv_a_part_of_a_run_that_is_another_s_is_told_by_its_time() {
    for odd in [4, 10, COMPOUND] {
        let day = with(odd..odd + 1, |i, n, u| match i == 5 && LOOSE.contains(&n) {
            true => LEFT * u,
            false => u,
        });
        let evidence = "the channel does not follow the motion as it does in the rest of the run";
        day.shows(Cause::Unreadable, &[odd], &[5], evidence);
        let said = &day.findings()[0].evidence;
        let times: Vec<f64> = (said.split(' ').filter_map(|word| word.parse().ok())).collect();
        let near = |told: f64, sample: usize| (told - sample as f64 / RATE_HZ).abs() < 0.15;
        assert!(
            near(times[0], LOOSE.start) && near(times[1], LOOSE.end),
            "{said}"
        );
    }
    for (odd, standard) in [(4, "accelerometer"), (10, "gyroscope")] {
        let mut day = Day::of(&healthy());
        let (trial, conditioned) = &mut day.trials[odd];
        let (series, motion) = match standard {
            "accelerometer" => (
                &mut trial.accelerometer_m_s2,
                &mut conditioned.linear_ground_m_s2,
            ),
            _ => {
                let rates = &mut conditioned.rate_shell_rad_s[LOOSE];
                rates.iter_mut().for_each(|w| *w *= LEFT);
                (
                    &mut trial.gyroscope_rad_s,
                    &mut conditioned.angular_shell_rad_s2,
                )
            }
        };
        loosened(series);
        motion[LOOSE].iter_mut().for_each(|v| *v *= LEFT);
        let evidence = format!("the standard {standard} reads nothing while the channels move");
        day.shows_first(Cause::Unreadable, &[odd], &[], &evidence);
    }
    // A wedge that is off is off wherever the run moves, and where it rests nothing can be told.
    let mut day = where_runs(4..5, |run| {
        run.moved = DQuat::from_rotation_z(0.09) * run.stated;
        run.gravity = -run.moved * GRAVITY_M_S2;
    });
    let (trial, conditioned) = &mut day.trials[4];
    let rest = 4 * SAMPLES;
    let noise: Vec<[f64; LIMBS]> = (0..rest).map(|n| trial.voltage_v[n % 150]).collect();
    trial.voltage_v.extend(noise);
    conditioned.voltage_v.clone_from(&trial.voltage_v);
    trial.accelerometer_m_s2.extend(vec![0.0; rest]);
    trial.gyroscope_rad_s.extend(vec![0.0; rest]);
    for vectors in [
        &mut conditioned.linear_ground_m_s2,
        &mut conditioned.rate_shell_rad_s,
        &mut conditioned.angular_shell_rad_s2,
    ] {
        vectors.extend(vec![DVec3::ZERO; rest]);
    }
    day.shows_first(Cause::LooseWedge, &[4], &[], "from the stated direction");
}

#[test]
fn inv_trials_with_one_cause_make_one_finding() {
    let found = with([4, 10].into_iter(), one(5, |u| 1.5 * u)).findings();
    assert_eq!(found.len(), 1, "{found:#?}");
    assert_eq!(found[0].recordings, [name(4), name(10)]);
    assert_eq!(found[0].channels, [6]);
    // The same cause in other channels is another finding.
    let mut day = Day::of(&healthy());
    change(&mut day.trials, 4..5, one(5, |u| 1.5 * u));
    change(&mut day.trials, 10..11, one(6, |u| 1.5 * u));
    let found = day.findings();
    assert_eq!(found.len(), 2, "{found:#?}");
    // A wedge is loose in all of its trials, another wedge is another finding.
    let loose = |which: &[usize]| {
        where_runs(which.iter().copied(), |run| {
            let about = run.stated.any_orthogonal_vector().normalize();
            run.moved = DQuat::from_axis_angle(about, 5.0_f64.to_radians()) * run.stated;
            run.gravity = -run.moved * GRAVITY_M_S2;
        })
        .findings()
    };
    let found = loose(&[4, 10]);
    assert_eq!(found.len(), 1, "{found:#?}");
    assert_eq!(found[0].recordings, [name(4), name(10)]);
    assert_eq!(loose(&[4, 11]).len(), 2);
}

/// What turns lags where the gyroscope does: the compound run shows it, too, and is not told of.
#[test]
fn inv_a_gyroscopes_lag_is_told_of_what_only_turns() {
    where_runs(ANGULAR.start..COMPOUND + 1, |run| run.late_s = 2e-3).shows(
        Cause::GyroscopeLag,
        &[],
        &[],
        "in all 6 angular trials the gyroscope is 2.0 ms behind the sensor",
    );
    let day = where_runs(2..3, |run| run.late_s = 0.3e-3);
    let lags = day.examined(|diagnosis| {
        let lags = diagnosis
            .cases
            .iter()
            .map(sixaxis_calibration::diagnosis::timing::lag_of);
        lags.collect::<Vec<_>>()
    });
    for (index, lag) in lags.into_iter().enumerate() {
        let expected = if index == 2 { 0.3e-3 } else { 0.0 };
        assert!(
            lag.is_some_and(|lag| (lag - expected).abs() < 1e-5),
            "{index}: {lag:?}"
        );
    }
}

#[test]
fn inv_what_is_like_a_cause_but_is_none_is_not_named_after_it() {
    // Two channels' millivolts are theirs alone.
    with(ALL, |i, _, u| if i == 2 || i == 6 { 1000.0 * u } else { u }).shows(
        Cause::MillivoltMixUp,
        &[],
        &[2, 6],
        "from a converter that ends at 5 V",
    );
    // A ninth is neither a g nor a decade.
    for factor in [9.0, 1.0 / 9.0] {
        let mut day = with(ALL, |_, _, u| u / factor);
        for (trial, _) in &mut day.trials {
            trial.full_scale_v = 1000.0;
        }
        let found = day.findings();
        assert_eq!(found.len(), 1, "{found:#?}");
        assert!(
            found[0]
                .evidence
                .contains("check gains, sensitivities and units"),
            "{found:#?}"
        );
    }
    // Two channels that depart are no other sensor's; three are.
    for (channels, cause) in [
        ([3, 5, 5], Cause::Unexplained),
        ([3, 5, 7], Cause::ForeignTrial),
    ] {
        let factor = move |i: usize| match channels.iter().position(|c| *c == i) {
            Some(place) => 1.2 + 0.3 * place as f64,
            None => 1.0,
        };
        with(4..5, move |i, _, u| factor(i) * u).shows(cause, &[4], &[], "depart");
    }
}

/// Without linear trials there is no table; what moves is noticed all the same.
#[test]
fn inv_drift_is_seen_without_a_table() {
    let mut day = Day::of(&healthy()[ANGULAR]);
    let place = |n: usize| n as f64 / (SAMPLES - 1) as f64;
    change(&mut day.trials, 1..2, |i, n, u| {
        if i == 2 { u + 0.06 * place(n) } else { u }
    });
    let found = day.findings();
    let own = |f: &&Finding| f.cause == Cause::DriftDuringRun && f.channels == [3];
    assert_eq!(found.iter().filter(own).count(), 1, "{found:#?}");
}

/// Where weight turns, what the error of its angle leaves of it, three thousandths here, is no drift; more than that is.
#[test]
fn inv_drift_beside_turning_weight() {
    let place = |n: usize| n as f64 / (SAMPLES - 1) as f64;
    for (size_v, told) in [(1e-3, 0), (1e-2, 1)] {
        let mut day = where_runs(8..9, |run| {
            let side = run.moved.any_orthogonal_vector().normalize() * GRAVITY_M_S2;
            (run.gravity, run.stated_gravity) = (side, side);
        });
        change(&mut day.trials, 8..9, |i, n, u| {
            if i == 2 { u + size_v * place(n) } else { u }
        });
        let found = day.findings();
        assert_eq!(found.len(), told, "{found:#?}");
        assert!(
            found.iter().all(|f| f.cause == Cause::DriftDuringRun),
            "{found:#?}"
        );
    }
}

/// What is said of the static record.
fn of_the_static_record(trials: Played) -> Vec<Finding> {
    let day = Day {
        trials,
        ..Day::of(&[])
    };
    let concerned = |finding: &Finding| finding.recordings == ["rest"];
    day.findings().into_iter().filter(concerned).collect()
}

const LINEAR: core::ops::Range<usize> = 0..6;

#[test]
fn inv_zeros_that_are_not_the_static_record_s_are_told() {
    let mut trials = played(&healthy());
    change(
        &mut trials,
        LINEAR,
        |channel, _, u| {
            if channel == 4 { u + 0.01 } else { u }
        },
    );
    let found = of_the_static_record(trials);
    assert_eq!(found.len(), 1, "{found:#?}");
    assert_eq!(found[0].cause, Cause::DriftDuringRun, "{found:#?}");
    assert_eq!(found[0].channels, [5], "{found:#?}");
    assert!(found[0].evidence.contains("+10.0"), "{found:#?}");
    // Once, however large it is beside the runs' signals.
    let mut trials = played(&healthy());
    change(&mut trials, 0..=COMPOUND, |channel, _, u| {
        if channel == 4 { u + 0.1 } else { u }
    });
    let day = Day {
        trials,
        ..Day::of(&[])
    };
    let found = day.findings();
    assert_eq!(found.len(), 1, "{found:#?}");
    assert_eq!(found[0].recordings, ["rest"], "{found:#?}");

    let mut trials = played(&healthy());
    change(&mut trials, LINEAR, |channel, _, u| {
        u + 1e-3 * (channel as f64 + 2.0)
    });
    let found = of_the_static_record(trials);
    assert_eq!(found.len(), 1, "{found:#?}");
    assert_eq!(found[0].cause, Cause::Unreadable, "{found:#?}");
    assert!(found[0].evidence.contains("9 channels"), "{found:#?}");
}

/// Limbs that are stiffer one way than the other show another zero in motion, and at rest the static record's.
#[test]
fn inv_a_zero_of_the_motion_alone_is_not_the_static_record_s() {
    let moved = |at_rest: usize| {
        let mut trials = played(&healthy());
        change(&mut trials, LINEAR, |channel, n, u| {
            let moves = (at_rest..SAMPLES - at_rest).contains(&n);
            if channel == 4 && moves { u + 0.01 } else { u }
        });
        of_the_static_record(trials).len()
    };
    assert_eq!([moved(0), moved(32)], [1, 0]);
}

#[test]
fn inv_zeros_within_what_a_day_shows_are_not_told() {
    // Amplifiers that warm up: from -6 to 14 mV over the linear trials.
    let mut trials = played(&healthy());
    for index in LINEAR {
        let zero_v = 4e-3 * index as f64 - 6e-3;
        change(&mut trials, index..=index, |_, _, u| u + zero_v);
    }
    assert_eq!(of_the_static_record(trials), []);
    // A converter of 16 mV shows 7 mV as nothing at rest, and as 7 mV of a signal.
    let mut trials = played(&healthy());
    change(&mut trials, 0..=COMPOUND, |_, _, u| {
        ((u + 7e-3) / 1.6e-2).round() * 1.6e-2
    });
    assert_eq!(of_the_static_record(trials), []);
}
