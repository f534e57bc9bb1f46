//! What nine constant channels are taken for: rests, steady turns about the plumb line, motions at constant velocity.

use glam::{DQuat, DVec3};
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64;
use sixaxis_core::aided::{Aid, AidedDecoupler, ErrorFilter, RestFinder, Taken};
use sixaxis_core::decouple::uncertainty::{ChannelNoise, Covariance};
use sixaxis_core::parameter::DRIFT;
use sixaxis_core::{Decoupler, Gains, Geometry, LIMBS, Scheme, Sensor, Settings, SixAxis};
use sixaxis_props::truth;
use sixaxis_reference::compliant::compliant_forces_m_s2;
use sixaxis_reference::motion::TrueMotion;
use sixaxis_reference::smooth_step::smooth_step;

const SEED: u64 = 21;
const STREAM: u128 = 77;
const RATE_HZ: f64 = 1000.0;
const NOISE_V: f64 = 1e-3;
const GAIN_N_PER_V: f64 = 0.2;
const GRAVITY_M_S2: f64 = 9.8;
/// When a motion has begun, when it ends and when all ends, s; it begins and ends within a second.
const BEGUN_S: f64 = 2.0;
const ENDS_S: f64 = 22.0;
const END_S: f64 = 26.0;
/// Looks of a quarter of a second within the steady motion, at least.
const LOOKS: usize = 80;
/// Largest error of the attitude over its deviation about all axes together: one axis alone exceeds it once in 16,000 looks, and these are
/// 2,600, hardly independent of one another.
const LARGEST: f64 = 4.0;

/// Down in ground axes, which are the sensor's at the start: along none of its own.
fn down() -> DVec3 {
    DVec3::new(0.3, -0.5, -0.8).normalize()
}

/// How far a motion has come at unit speed, its speed and its acceleration.
fn course(time_s: f64) -> [f64; 3] {
    let [begun, v, dv, _] = smooth_step(time_s - (BEGUN_S - 1.0));
    let [ended, w, dw, _] = smooth_step(time_s - ENDS_S);
    [begun - ended, v - w, dv - dw]
}

/// On an arm of 0.2 m about the plumb line.
fn turntable(rate_rad_s: f64) -> impl Fn(f64) -> TrueMotion {
    move |time_s| {
        let [angle, rate, acceleration] = course(time_s).map(|v| v * rate_rad_s);
        let axis = -down();
        let attitude = DQuat::from_axis_angle(axis, angle);
        let arm = attitude * (axis.any_orthonormal_vector() * 0.2);
        TrueMotion {
            linear_ground_m_s2: axis.cross(arm) * acceleration - arm * rate * rate,
            angular_ground_rad_s2: axis * acceleration,
            rate_shell_rad_s: axis * rate,
            attitude,
        }
    }
}

fn lift(speed_m_s: f64) -> impl Fn(f64) -> TrueMotion {
    move |time_s| {
        let [_, _, acceleration] = course(time_s).map(|v| v * speed_m_s);
        TrueMotion {
            linear_ground_m_s2: -down() * acceleration,
            ..TrueMotion::at_rest(DQuat::IDENTITY)
        }
    }
}

/// What each look at constant channels was taken for, and the attitude's largest error over its deviation.
struct Followed {
    taken: Vec<(f64, Taken)>,
    worst: f64,
}

impl Followed {
    fn count(&self, of: Taken) -> usize {
        self.taken.iter().filter(|(_, taken)| *taken == of).count()
    }
}

/// A decoupler with its filter, parameters taken to be so uncertain, and one to decouple once more with.
fn aided(covariance: &Covariance) -> (AidedDecoupler, Decoupler) {
    let parameters = truth::identified_parameters();
    let sensor = Sensor {
        geometry: Geometry::PAPER,
        gains: Gains {
            gain_n_per_v: [GAIN_N_PER_V; LIMBS],
        },
    };
    let settings = settings();
    let noise = ChannelNoise::white([NOISE_V; LIMBS]);
    let decoupler = Decoupler::new(&sensor, &parameters, &settings).expect("sound");
    let filter = ErrorFilter::new(&sensor, &parameters, &settings, covariance, &noise, 0.0);
    let again = decoupler.clone();
    let stream = AidedDecoupler::new(decoupler, filter.expect("sound"), &parameters, &settings);
    (stream, again)
}

fn settings() -> Settings {
    Settings {
        gravity_ground_m_s2: down() * GRAVITY_M_S2,
        scheme: Scheme::HeunSubstepped,
        ..Settings::new(RATE_HZ)
    }
}

/// Decouples a motion with rests for an aid, all parameters exact but for zeros that have moved since the start by so much, V.
fn followed(motion: impl Fn(f64) -> TrueMotion, moved_v: [f64; LIMBS]) -> Followed {
    let true_sensor = truth::sensor(&truth::identified_parameters());
    let gravity = down() * GRAVITY_M_S2;
    let samples = (END_S * RATE_HZ) as usize;
    let motions: Vec<_> = (0..samples).map(|k| motion(k as f64 / RATE_HZ)).collect();
    let forces = compliant_forces_m_s2(&true_sensor, gravity, &motions).expect("a sound sensor");
    let (mut stream, _) = aided(&Covariance::zeros());
    let noise_v = [NOISE_V; LIMBS];
    let mut rests = RestFinder::new(stream.filter().model(), &noise_v, RATE_HZ);
    let rng = &mut Pcg64::new(u128::from(SEED), STREAM);
    let mut followed = Followed {
        taken: Vec::new(),
        worst: 0.0,
    };
    for (k, force) in forces.iter().enumerate() {
        let tared = core::array::from_fn(|i| force[i] - forces[0][i]);
        let mut volts = true_sensor.voltage_v(&tared, &[GAIN_N_PER_V; LIMBS]);
        for (v, moved) in volts.iter_mut().zip(moved_v) {
            let unit: f64 = StandardNormal.sample(rng);
            *v += NOISE_V * unit + if k > 0 { moved } else { 0.0 };
        }
        let answer = stream.push(&volts).expect("a rate that holds");
        if let (Some(sample), Some(block)) = (answer, stream.block().copied()) {
            let off = sample.attitude * motions[k - 1].attitude.inverse();
            let deviation = stream.deviations().attitude_rad();
            let error = 2.0 * off.xyz().length().asin();
            followed.worst = f64::max(followed.worst, error / deviation);
            if let Some(rest) = rests.push(&block) {
                followed.taken.push((k as f64 / RATE_HZ, stream.aid(&rest)));
            }
        }
    }
    followed
}

#[test]
fn law_steady_motions_are_not_taken_for_rests() {
    println!("seed {SEED}");
    let still = [0.0; LIMBS];
    for rate_rad_s in [0.05, 0.5, 5.0] {
        let found = followed(turntable(rate_rad_s), still);
        let [turns, used] = [Taken::Turn, Taken::Used].map(|taken| found.count(taken));
        println!(
            "{rate_rad_s} rad/s: {turns} turns, {used} rests; {:.2} deviations",
            found.worst
        );
        assert!(turns >= LOOKS && turns + used == found.taken.len());
        let begins_and_ends = |(at, taken): &(f64, Taken)| {
            let steady = (BEGUN_S..ENDS_S + 0.3).contains(at);
            steady == (*taken == Taken::Turn)
        };
        assert!(found.taken.iter().all(begins_and_ends), "{:?}", found.taken);
        assert!(found.worst < LARGEST, "{}", found.worst);
    }
    for speed_m_s in [0.5, 2.0, 20.0] {
        let found = followed(lift(speed_m_s), still);
        let cruises = found.count(Taken::Cruise);
        println!(
            "{speed_m_s} m/s: {cruises} cruises of {}; {:.2} deviations",
            found.taken.len(),
            found.worst
        );
        // Where it begins and where it ends: velocities are counted anew from there.
        assert!((2..=4).contains(&cruises), "{:?}", found.taken);
        assert!(found.worst < LARGEST, "{}", found.worst);
    }
}

/// A zero that has moved makes rates about all axes: what contradicts is no turn about the plumb line, and goes on counting.
#[test]
fn neg_a_rest_that_contradicts_a_wrong_zero_is_no_turn() {
    println!("seed {SEED}");
    for limb in 0..LIMBS {
        let mut moved = [0.0; LIMBS];
        moved[limb] = 20.0 * NOISE_V;
        let found = followed(|_| TrueMotion::at_rest(DQuat::IDENTITY), moved);
        let [turns, refused] = [Taken::Turn, Taken::Refused].map(|taken| found.count(taken));
        println!("limb {}: {refused} contradict, {turns} turns", limb + 1);
        assert!(refused > 4 && turns == 0, "{:?}", found.taken);
    }
}

/// Channels that are constant, at zeros that are wrong by a hundredth of their noise and may be by ten times it, so that nothing of what a rest
/// tells is taken back to before it: what it corrects is in all rows that come after it, those of samples that had been received by then, too.
#[test]
fn law_a_correction_holds_from_the_next_row_on() {
    let moved_v = [1.0, -1.0, 1.0, 1.0, 1.0, -1.0, -1.0, 1.0, 1.0].map(|sign| sign * 1e-5);
    let mut covariance = Covariance::zeros();
    for limb in DRIFT {
        covariance[(limb, limb)] = 1e-4;
    }
    let (stream, again) = aided(&covariance);
    let mut stream = stream.remembering();
    let parameters = truth::identified_parameters();
    let volts = core::array::from_fn(|i| parameters.zero_drift_v[i] + moved_v[i]);
    let rest = Aid::Rest {
        deviation_rad_s: 1e-9,
        deviation_m_s: 1e-9,
        continues: false,
    };
    let (mut rows, mut rested_at) = (Vec::new(), None);
    for _ in 0..2500 {
        if let Some(row) = stream.push(&volts).expect("a rate that holds") {
            rows.push(row);
            if stream.block().is_some() && rested_at.is_none() && row.sample > 2000 {
                assert_eq!(stream.aid(&rest), Taken::Used);
                rested_at = Some(row.sample);
            }
        }
    }
    let rested_at = rested_at.expect("a block that ends");
    held("filter", &rows, rested_at);
    let mut smoothed = stream.smoothed(again, &settings()).expect("remembered");
    let rows: Vec<_> = (0..2500)
        .filter_map(|_| smoothed.push(&volts).expect("a rate that holds"))
        .collect();
    held("smoother", &rows, rested_at);
}

/// The accelerations of the first rows after a correction are those of the rows that follow, but for a thousandth of what it has changed.
fn held(what: &str, rows: &[SixAxis], rested_at: u64) {
    let at = |sample: u64| &rows[sample as usize - rows[0].sample as usize];
    let later = at(rested_at + 10);
    let apart = |row: &SixAxis| {
        let linear = row.linear_ground_m_s2 - later.linear_ground_m_s2;
        let angular = row.angular_ground_rad_s2 - later.angular_ground_rad_s2;
        [linear.length(), angular.length()]
    };
    let changed = apart(at(rested_at));
    for sample in rested_at + 1..rested_at + 10 {
        let off = apart(at(sample));
        println!("{what}, sample {sample}: {off:?} of {changed:?}");
        assert!(changed[0] > 1e-3 && (0..2).all(|i| off[i] < 1e-3 * changed[i]));
    }
}
