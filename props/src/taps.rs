//! Taps to judge the fit of k/m by: random sensors, blows and errors of what is known beforehand, and the Cramér-Rao bound.
//!
//! The bound shares no code with the fit: states instead of modes, a matrix exponential instead of eigenvalues, differences
//! instead of derivatives.

use nalgebra::{DMatrix, DVector, Matrix6, SMatrix, SVector};
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64;
use serde::Serialize;
use sixaxis_core::identify::tap::{Setup, Tap, identify};
use sixaxis_core::signal::SignalChain;
use sixaxis_core::{Geometry, InertiaPerMass, LIMBS, Parameters, Sensor};
use sixaxis_reference::campaign::{DAMPING_RATIO, MASS_KG};
use sixaxis_reference::chain::amplifier_ranges;
use sixaxis_reference::mjcf::{SensorModel, limb_jacobian};
use sixaxis_reference::paper;
use sixaxis_reference::rig::Mounting;
use sixaxis_reference::session::plan::random_sensor;
use sixaxis_reference::simulation::SimulationError;
use sixaxis_reference::tap::{Blow, DURATION_S, SAMPLE_RATE_HZ, STEPS_PER_SAMPLE};

/// Standard deviation of the noise over the largest channel's peak that the bars are set at.
pub const NOISE_SHARE: f64 = 0.01;
/// Standard deviation of what step 2 leaves of each channel's gain, and step 3 of I/m over its mean moment.
pub const KNOWN_TO: f64 = 0.005;
/// Limit of the converter, V.
pub const FULL_SCALE_V: f64 = 10.0;

/// Random stream of taps.
const STREAM: u128 = 32;

/// One tap: truth, blow and what the laboratory believes.
#[derive(Debug, Clone)]
pub struct Case {
    /// Seed that it was drawn with.
    pub seed: u64,
    /// The sensor.
    pub truth: Parameters,
    /// Damping of one limb, of critical under the whole mass.
    pub damping_ratio: f64,
    /// The blow.
    pub blow: Blow,
    /// Scale factors and I/m with their errors, k/m of the design.
    pub known: Parameters,
    rng: Pcg64,
}

/// A recorded tap with the forces behind it.
#[derive(Debug, Clone)]
pub struct Recorded {
    /// Geometry and ranges.
    pub sensor: Sensor,
    /// What is on disk.
    pub voltage_v: Vec<[f64; LIMBS]>,
    /// Changes of the true limb forces per mass since the first sample, m/s^2.
    pub force_per_mass_m_s2: Vec<[f64; LIMBS]>,
    /// Standard deviation of the noise in it.
    pub noise_v: f64,
}

impl Case {
    /// Draws a sensor, a blow and errors of what is known beforehand.
    #[must_use]
    pub fn random(seed: u64) -> Self {
        let mut rng = Pcg64::new(u128::from(seed), STREAM);
        let truth = random_sensor(&mut rng);
        let blow = Blow::random(&mut rng);
        let mut normal = || -> f64 { StandardNormal.sample(&mut rng) };
        let inertia = truth.inertia_per_mass.to_paper_order();
        let deviation = inertia_deviation_m2(&truth);
        let known = Parameters {
            scale_per_mass_per_kg: truth
                .scale_per_mass_per_kg
                .map(|s| s * (KNOWN_TO * normal()).exp()),
            inertia_per_mass: InertiaPerMass::from_paper_order(
                inertia.map(|i| i + deviation * normal()),
            ),
            stiffness_per_mass_per_s2: paper::DESIGN_STIFFNESS_PER_MASS_PER_S2,
            ..truth
        };
        Self {
            seed,
            truth,
            damping_ratio: DAMPING_RATIO,
            blow,
            known,
            rng,
        }
    }

    /// The sensor as MuJoCo has it.
    #[must_use]
    pub fn model(&self) -> SensorModel {
        SensorModel {
            geometry: Geometry::PAPER,
            mass_kg: MASS_KG,
            inertia_per_mass: self.truth.inertia_per_mass,
            stiffness_per_mass_per_s2: self.truth.stiffness_per_mass_per_s2,
            damping_ratio: self.damping_ratio,
            gravity_ground_m_s2: Mounting::AxisVertical.gravity_ground_m_s2(glam::DVec3::Z),
        }
    }

    /// Plays it in MuJoCo and records it with noise of the given share of the largest channel's peak.
    ///
    /// # Errors
    /// Those of the simulation.
    pub fn record(&self, noise_share: f64) -> Result<Recorded, SimulationError> {
        self.record_stepped(noise_share, STEPS_PER_SAMPLE)
    }

    /// As [`Self::record`] with another step of the simulation.
    ///
    /// # Errors
    /// Those of the simulation.
    pub fn record_stepped(
        &self,
        noise_share: f64,
        steps: usize,
    ) -> Result<Recorded, SimulationError> {
        let motion = self
            .blow
            .play(&self.model(), DURATION_S, SAMPLE_RATE_HZ, steps)?;
        Ok(self.measured(motion.limb_force_per_mass_m_s2, noise_share))
    }

    /// The measuring chain: ranges that fit, noise of one size in all channels.
    #[must_use]
    pub fn measured(&self, force: Vec<[f64; LIMBS]>, noise_share: f64) -> Recorded {
        let gains = amplifier_ranges(&force, &self.truth, FULL_SCALE_V);
        let rest = force[0];
        let force_per_mass_m_s2: Vec<[f64; LIMBS]> = force
            .iter()
            .map(|row| core::array::from_fn(|i| row[i] - rest[i]))
            .collect();
        let chain = SignalChain::new(&gains, &self.truth);
        let peak_v = force_per_mass_m_s2
            .iter()
            .flat_map(|row| chain.voltage_change_v(row))
            .fold(0.0_f64, |a, u| a.max(u.abs()));
        let noise_v = noise_share * peak_v;
        let mut rng = self.rng.clone();
        let voltage_v = force_per_mass_m_s2
            .iter()
            .map(|row| {
                chain.voltage_v(row).map(|u| {
                    let unit: f64 = StandardNormal.sample(&mut rng);
                    u + noise_v * unit
                })
            })
            .collect();
        Recorded {
            sensor: Sensor {
                geometry: Geometry::PAPER,
                gains,
            },
            voltage_v,
            force_per_mass_m_s2,
            noise_v,
        }
    }

    /// What the fit is told.
    #[must_use]
    pub fn setup<'a>(&'a self, sensor: &'a Sensor) -> Setup<'a> {
        let deviation = inertia_deviation_m2(&self.truth);
        Setup {
            sensor,
            parameters: &self.known,
            inertia_covariance_m4: Matrix6::identity() * (deviation * deviation),
            gain_deviation: [KNOWN_TO; LIMBS],
            sample_rate_hz: SAMPLE_RATE_HZ,
            full_scale_v: FULL_SCALE_V,
        }
    }

    /// Identifies k/m from a recording.
    ///
    /// # Errors
    /// Those of [`identify`].
    pub fn identify(&self, recorded: &Recorded) -> sixaxis_core::Result<Tap> {
        identify(&self.setup(&recorded.sensor), &recorded.voltage_v)
    }

    /// Error of ln k/m.
    #[must_use]
    pub fn error_ln(&self, tap: &Tap) -> f64 {
        (tap.stiffness_per_mass_per_s2 / self.truth.stiffness_per_mass_per_s2).ln()
    }
}

/// Standard deviation of what is known of each of I1 to I6 over m, m^2.
fn inertia_deviation_m2(truth: &Parameters) -> f64 {
    let [xx, yy, zz, ..] = truth.inertia_per_mass.to_paper_order();
    KNOWN_TO * (xx + yy + zz) / 3.0
}

/// Displacement, rotation and their rates.
const STATES: usize = 12;
/// ln k/m, damping ratio, I/m.
const SHARED: usize = 8;
/// Differences by which the derivatives are taken, relative: phases of up to a thousand radians move by a hundredth.
const DIFFERENCE: f64 = 1e-5;

type Output = SMatrix<f64, LIMBS, STATES>;

/// The decay of a sensor at rest as a linear system in its state.
#[derive(Debug, Clone)]
pub struct States {
    /// From one sample to the next.
    pub step: SMatrix<f64, STATES, STATES>,
    /// Limb forces per mass, m/s^2, of a state.
    pub output: Output,
}

impl States {
    /// From M x'' + C x' + K x = 0.
    #[must_use]
    pub fn new(inertia_m2: &[f64; 6], stiffness: f64, damping_ratio: f64, step_s: f64) -> Self {
        let jacobian = limb_jacobian(&Geometry::PAPER);
        let damping = 2.0 * damping_ratio * stiffness.sqrt();
        let mut mass = Matrix6::identity();
        let [xx, yy, zz, xy, xz, yz] = *inertia_m2;
        mass.fixed_view_mut::<3, 3>(3, 3)
            .copy_from(&nalgebra::Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz));
        let inverse = mass.try_inverse().expect("an inertia is regular");
        let pull = -inverse * (jacobian.transpose() * jacobian);
        let mut rate = DMatrix::<f64>::zeros(STATES, STATES);
        for i in 0..6 {
            rate[(i, 6 + i)] = 1.0;
            for j in 0..6 {
                rate[(6 + i, j)] = stiffness * pull[(i, j)];
                rate[(6 + i, 6 + j)] = damping * pull[(i, j)];
            }
        }
        let step = (rate * step_s).exp();
        Self {
            step: SMatrix::from_fn(|i, j| step[(i, j)]),
            output: SMatrix::from_fn(|limb, column| {
                if column < 6 {
                    -stiffness * jacobian[(limb, column)]
                } else {
                    -damping * jacobian[(limb, column - 6)]
                }
            }),
        }
    }

    /// Forces of each sample from a state on.
    pub fn forces(&self, start: SVector<f64, STATES>) -> impl Iterator<Item = SVector<f64, LIMBS>> {
        let mut state = start;
        core::iter::from_fn(move || {
            let force = self.output * state;
            state = self.step * state;
            Some(force)
        })
    }

    /// The state at the beginning of a stretch of forces that fits them best.
    #[must_use]
    pub fn start(&self, force: &[[f64; LIMBS]]) -> SVector<f64, STATES> {
        let mut basis = DMatrix::zeros(LIMBS * force.len(), STATES);
        let mut output = self.output;
        for sample in 0..force.len() {
            basis
                .fixed_view_mut::<LIMBS, STATES>(LIMBS * sample, 0)
                .copy_from(&output);
            output *= self.step;
        }
        // States differ by six orders of size.
        let sizes: Vec<f64> = basis.column_iter().map(|c| c.norm()).collect();
        for (column, size) in sizes.iter().enumerate() {
            basis.column_mut(column).unscale_mut(*size);
        }
        let right = DVector::from_iterator(LIMBS * force.len(), force.iter().flatten().copied());
        let svd = basis.svd(true, true);
        let scaled = svd.solve(&right, 0.0).expect("both sides were asked for");
        SVector::from_fn(|i, _| scaled[i] / sizes[i])
    }
}

/// Cramér-Rao bound of the standard deviation of ln k/m for the stretch that was fitted, with what is known beforehand: no
/// unbiased estimate of the same samples is better.
#[must_use]
pub fn bound_ln(case: &Case, recorded: &Recorded, fitted: &core::ops::Range<usize>) -> f64 {
    let force = &recorded.force_per_mass_m_s2[fitted.clone()];
    let truth = [
        case.truth.stiffness_per_mass_per_s2.ln(),
        case.damping_ratio,
    ]
    .into_iter()
    .chain(case.truth.inertia_per_mass.to_paper_order())
    .collect::<Vec<f64>>();
    let states = |p: &[f64]| {
        let inertia: [f64; 6] = core::array::from_fn(|k| p[2 + k]);
        States::new(&inertia, p[0].exp(), p[1], 1.0 / SAMPLE_RATE_HZ)
    };
    let true_states = states(&truth);
    let start = true_states.start(force);
    let deviation = inertia_deviation_m2(&case.truth);
    let sizes: [f64; SHARED] = core::array::from_fn(|k| {
        if k < 2 {
            DIFFERENCE
        } else {
            DIFFERENCE * deviation / KNOWN_TO
        }
    });
    let slopes: Vec<Vec<SVector<f64, LIMBS>>> = (0..SHARED)
        .map(|k| {
            let moved = |by: f64| -> Vec<SVector<f64, LIMBS>> {
                let mut p = truth.clone();
                p[k] += by;
                states(&p).forces(start).take(force.len()).collect()
            };
            moved(sizes[k])
                .iter()
                .zip(moved(-sizes[k]))
                .map(|(a, b)| (a - b) / (2.0 * sizes[k]))
                .collect()
        })
        .collect();
    // Unknowns: shared, gains, states, offsets, each column scaled to unit length before it is inverted.
    const UNKNOWNS: usize = SHARED + LIMBS + STATES + LIMBS;
    let known = 6 + LIMBS;
    let mut rows = DMatrix::zeros(LIMBS * force.len() + known, UNKNOWNS);
    let volts: Vec<f64> = SignalChain::new(&recorded.sensor.gains, &case.truth)
        .sensitivity_m_s2_per_v()
        .iter()
        .map(|s| 1.0 / (s * recorded.noise_v))
        .collect();
    let mut output = true_states.output;
    for (sample, now) in true_states.forces(start).take(force.len()).enumerate() {
        for limb in 0..LIMBS {
            let row = LIMBS * sample + limb;
            for (k, slope) in slopes.iter().enumerate() {
                rows[(row, k)] = volts[limb] * slope[sample][limb];
            }
            rows[(row, SHARED + limb)] = volts[limb] * now[limb];
            for state in 0..STATES {
                rows[(row, SHARED + LIMBS + state)] = volts[limb] * output[(limb, state)];
            }
            rows[(row, SHARED + LIMBS + STATES + limb)] = 1.0 / recorded.noise_v;
        }
        output *= true_states.step;
    }
    let first_known = LIMBS * force.len();
    for k in 0..6 {
        rows[(first_known + k, 2 + k)] = 1.0 / deviation;
    }
    for limb in 0..LIMBS {
        rows[(first_known + 6 + limb, SHARED + limb)] = 1.0 / KNOWN_TO;
    }
    let first = rows.column(0).norm();
    for mut column in rows.column_iter_mut() {
        let size = column.norm();
        column.unscale_mut(size);
    }
    let triangle = rows.qr().r();
    let inverse = triangle.try_inverse().expect("every unknown shows");
    inverse.row(0).norm() / first
}

/// What became of one tap.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Outcome {
    /// Seed of the case.
    pub seed: u64,
    /// Error of ln k/m.
    pub error_ln: f64,
    /// Standard error that the fit states.
    pub stated_ln: f64,
    /// Cramér-Rao bound of the samples that it used.
    pub bound_ln: f64,
    /// Whether the fit calls k/m determined.
    pub determined: bool,
}

impl Outcome {
    /// Plays, records and identifies one random tap.
    ///
    /// # Errors
    /// The refusal or the failure of the simulation, as text with the seed.
    pub fn of(seed: u64, damping_ratio: f64, noise_share: f64) -> Result<Self, String> {
        let at = |error: &dyn core::fmt::Display| format!("seed {seed}: {error}");
        let case = Case {
            damping_ratio,
            ..Case::random(seed)
        };
        let recorded = case.record(noise_share).map_err(|e| at(&e))?;
        let tap = case.identify(&recorded).map_err(|e| at(&e))?;
        Ok(Self {
            seed,
            error_ln: case.error_ln(&tap),
            stated_ln: tap.standard_error_ln,
            bound_ln: bound_ln(&case, &recorded, &tap.fitted),
            determined: tap.verdict.is_determined(),
        })
    }
}

/// Many taps at one damping.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Tally {
    /// Damping of one limb, of critical under the whole mass.
    pub damping_ratio: f64,
    /// Taps.
    pub taps: usize,
    /// Taps refused or called undetermined.
    pub refused: usize,
    /// Root mean square of the errors of ln k/m.
    pub rms_error_ln: f64,
    /// Of the bound of one tap: median and largest.
    pub median_bound_ln: f64,
    /// See `median_bound_ln`.
    pub largest_bound_ln: f64,
    /// Share of taps whose bound is 1e-3 or less.
    pub share_within_bar: f64,
    /// Standard deviation of error over bound.
    pub deviation_over_bound: f64,
    /// Mean of error over bound.
    pub bias_over_bound: f64,
    /// Share of 95 % intervals that hold the truth.
    pub coverage_95: f64,
}

/// Standard deviation of ln k/m that is asked for.
pub const BAR_LN: f64 = 1e-3;
/// Half width of the 95 % interval of a normal variable, in standard deviations.
const NORMAL_95: f64 = 1.959_963_984_540_054;

impl Tally {
    /// Counts; none of no outcome at all.
    #[must_use]
    pub fn of(damping_ratio: f64, taps: usize, outcomes: &[Outcome]) -> Self {
        let used: Vec<&Outcome> = outcomes.iter().filter(|o| o.determined).collect();
        let n = used.len() as f64;
        let mean = |of: &dyn Fn(&Outcome) -> f64| used.iter().map(|o| of(o)).sum::<f64>() / n;
        let bias_over_bound = mean(&|o| o.error_ln / o.bound_ln);
        let mut bounds: Vec<f64> = used.iter().map(|o| o.bound_ln).collect();
        bounds.sort_unstable_by(f64::total_cmp);
        Self {
            damping_ratio,
            taps,
            refused: taps - used.len(),
            rms_error_ln: mean(&|o| o.error_ln * o.error_ln).sqrt(),
            median_bound_ln: bounds.get(bounds.len() / 2).copied().unwrap_or(f64::NAN),
            largest_bound_ln: bounds.last().copied().unwrap_or(f64::NAN),
            share_within_bar: mean(&|o| f64::from(u8::from(o.bound_ln <= BAR_LN))),
            deviation_over_bound: mean(&|o| (o.error_ln / o.bound_ln - bias_over_bound).powi(2))
                .sqrt(),
            bias_over_bound,
            coverage_95: mean(&|o| {
                f64::from(u8::from(o.error_ln.abs() <= NORMAL_95 * o.stated_ln))
            }),
        }
    }
}
