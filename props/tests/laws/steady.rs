//! What nine constant channels are taken for: rests, steady turns about the plumb line, motions at constant velocity.

use glam::{DQuat, DVec3};
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64;
use sixaxis_core::aided::{AidedDecoupler, ErrorFilter, RestFinder, Taken};
use sixaxis_core::decouple::uncertainty::{ChannelNoise, Covariance};
use sixaxis_core::{Decoupler, Gains, Geometry, LIMBS, Scheme, Sensor, Settings};
use sixaxis_props::truth;
use sixaxis_reference::compliant::compliant_forces_m_s2;
use sixaxis_reference::motion::TrueMotion;
use sixaxis_reference::smooth_step::smooth_step;

const SEED: u64 = 21;
const STREAM: u128 = 77;
const RATE_HZ: f64 = 1000.0;
const NOISE_V: f64 = 1e-3;
const GAIN_N_PER_V: f64 = 0.2;
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

/// Decouples a motion with rests for an aid, all parameters exact but for zeros that have moved since the start by so much, V.
fn followed(motion: impl Fn(f64) -> TrueMotion, moved_v: [f64; LIMBS]) -> Followed {
    let parameters = truth::identified_parameters();
    let true_sensor = truth::sensor(&parameters);
    let gravity = down() * 9.8;
    let samples = (END_S * RATE_HZ) as usize;
    let motions: Vec<_> = (0..samples).map(|k| motion(k as f64 / RATE_HZ)).collect();
    let forces = compliant_forces_m_s2(&true_sensor, gravity, &motions).expect("a sound sensor");
    let gains = Gains {
        gain_n_per_v: [GAIN_N_PER_V; LIMBS],
    };
    let sensor = Sensor {
        geometry: Geometry::PAPER,
        gains,
    };
    let settings = Settings {
        gravity_ground_m_s2: gravity,
        scheme: Scheme::HeunSubstepped,
        ..Settings::new(RATE_HZ)
    };
    let noise = ChannelNoise::white([NOISE_V; LIMBS]);
    let decoupler = Decoupler::new(&sensor, &parameters, &settings).expect("sound");
    let exact = Covariance::zeros();
    let filter = ErrorFilter::new(&sensor, &parameters, &settings, &exact, &noise, 0.0);
    let filter = filter.expect("sound");
    let mut rests = RestFinder::new(filter.model(), &noise.white_v, RATE_HZ);
    let mut stream = AidedDecoupler::new(decoupler, filter, &parameters, &settings);
    let rng = &mut Pcg64::new(u128::from(SEED), STREAM);
    let mut followed = Followed {
        taken: Vec::new(),
        worst: 0.0,
    };
    for (k, force) in forces.iter().enumerate() {
        let tared = core::array::from_fn(|i| force[i] - forces[0][i]);
        let mut volts = true_sensor.voltage_v(&tared, &gains.gain_n_per_v);
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
