//! The paper's decoder in fifty digits: (11), (2), the pose, (8) by improved Euler in the mass's rate, (9), (3).
//!
//! Written from the equations, in the discretisation of `sixaxis_core::Decoupler` with Heun's scheme, so that what is left
//! between the two is rounding and what core's series drop. Limb directions and nodes are the reference's, from (5) and (6).
//! Which way a loaded limb points has two answers, see [`Directions`].

use sixaxis_core::{LIMBS, Parameters, Sensor, Settings};
use sixaxis_reference::geometry::Geometry;

use super::number::{Big, Matrix, Normal, Turn, Vector, big, solve};

/// Each fixed-point iteration gains five digits: the displacement over the limb's length.
const ITERATIONS: usize = 12;
/// Limbs at a node.
const AT_A_NODE: usize = 3;
/// Powers of the rotation, below 1e-4, that w_r is summed up to.
const SERIES: u32 = 8;

/// Drawing of the sensor.
pub struct Drawing {
    directions: [Vector; LIMBS],
    /// t_i.
    ends: [Vector; LIMBS],
    length: Big,
    /// t_j - mean of the three nodes, and that mean.
    arms: [Vector; 3],
    middle: Vector,
    /// Normal matrix of a small rotation of the three nodes, inverted.
    turning: Matrix,
    /// Rows of (J^T J), wrenches of the limbs.
    wrenches: [Vec<Big>; LIMBS],
}

/// Which way loaded limbs point. The same for nine elongations that belong to a pose, and apart by what they miss one by, times the
/// strain, where scale factors are off, limbs unequal or signals noisy.
#[derive(Clone, Copy)]
pub enum Directions {
    /// To the nodes of the pose that fits best: (3) and (8) as printed, and `core/paper`.
    OfPose,
    /// To where the three limbs of a node put it: core's kernel, which needs no pose for that.
    OfNodes,
}

/// Pose of the mass in the shell.
#[derive(Clone)]
struct Pose {
    position: Vector,
    rotation: Vector,
}

/// What the nine limbs come to: force and torque per mass, shell axes.
struct Wrench {
    force: Vector,
    torque: Vector,
}

impl Drawing {
    /// The drawing of a sensor.
    pub fn new(sensor: &Sensor) -> Self {
        let geometry = Geometry {
            limb_length_m: sensor.geometry.limb_length_m,
            half_edge_m: sensor.geometry.half_edge_m,
        };
        let directions =
            Geometry::directions_shell().map(|direction| Vector::new(direction.to_array()));
        let ends = geometry
            .mass_hinges_m()
            .map(|end| Vector::new(end.to_array()));
        let nodes: [&Vector; 3] = core::array::from_fn(|node| &ends[node * AT_A_NODE]);
        let third = big(1.0) / big(3.0);
        let middle = &(&(nodes[0] + nodes[1]) + nodes[2]) * &third;
        let arms: [Vector; 3] = nodes.map(|node| node - &middle);
        let turning = Matrix(core::array::from_fn(|i| {
            Vector(core::array::from_fn(|j| {
                arms.iter().fold(big(0.0), |sum, arm| {
                    let unit = if i == j { arm.dot(arm) } else { big(0.0) };
                    sum + unit - &arm.0[i] * &arm.0[j]
                })
            }))
        }));
        let wrenches = core::array::from_fn(|limb| {
            let (e, t): (&Vector, &Vector) = (&directions[limb], &ends[limb]);
            [e.0.to_vec(), t.cross(e).0.to_vec()].concat()
        });
        Self {
            turning: turning.inverse(),
            length: big(geometry.limb_length_m),
            directions,
            ends,
            arms,
            middle,
            wrenches,
        }
    }

    /// t_i x e_i at rest.
    pub fn moment(&self, limb: usize) -> Vector {
        self.ends[limb].cross(&self.directions[limb])
    }

    /// e_i at rest.
    pub fn direction(&self, limb: usize) -> &Vector {
        &self.directions[limb]
    }

    /// Displacements of the nodes that their own limbs' elongations, m, ask for.
    fn nodes(&self, elongation: &[Big; LIMBS]) -> [Vector; 3] {
        let two = big(2.0);
        core::array::from_fn(|node| {
            let first = node * AT_A_NODE;
            // l^2 - L^2 = 2 L p_i + |p|^2, summed and squared: a quadratic in |p|^2 of which the smaller root holds.
            let q: [Big; AT_A_NODE] = core::array::from_fn(|i| {
                let dl = &elongation[first + i];
                dl * (&two * &self.length + dl)
            });
            let squares = &q[0] * &q[0] + &q[1] * &q[1] + &q[2] * &q[2];
            let b = &two * (&q[0] + &q[1] + &q[2]) + big(4.0) * &self.length * &self.length;
            let s = &two * &squares / (&b + (&b * &b - big(12.0) * &squares).sqrt());
            (0..AT_A_NODE).fold(Vector::new([0.0; 3]), |sum, i| {
                let along = (&q[i] - &s) / (&two * &self.length);
                &sum + &(&self.directions[first + i] * &along)
            })
        })
    }

    /// The pose that fits the nodes' displacements best.
    fn pose(&self, moved: &[Vector; 3]) -> Pose {
        let third = big(1.0) / big(3.0);
        let mean = &(&(&moved[0] + &moved[1]) + &moved[2]) * &third;
        let mut rotation = Vector::new([0.0; 3]);
        for _ in 0..ITERATIONS {
            let turn = Turn::by(rotation.clone());
            let moment = self.arms.iter().zip(moved).fold(
                Vector::new([0.0; 3]),
                |sum, (arm, displacement)| {
                    let beyond = &turn.added(arm) - &rotation.cross(arm);
                    &sum + &arm.cross(&(&(displacement - &mean) - &beyond))
                },
            );
            rotation = self.turning.times(&moment);
        }
        Pose {
            position: &mean - &Turn::by(rotation.clone()).added(&self.middle),
            rotation,
        }
    }

    /// Displacements of the nodes at a pose.
    fn placed(&self, pose: &Pose) -> [Vector; 3] {
        let turn = Turn::by(pose.rotation.clone());
        core::array::from_fn(|node| &pose.position + &turn.added(&self.ends[node * AT_A_NODE]))
    }

    /// Sums of (3) and (8) at a pose, limbs pointing to nodes that are so displaced.
    fn wrench(&self, pose: &Pose, nodes: &[Vector; 3], force_per_mass: &[Big; LIMBS]) -> Wrench {
        let zero = || Vector::new([0.0; 3]);
        let mut wrench = Wrench {
            force: zero(),
            torque: zero(),
        };
        let turn = Turn::by(pose.rotation.clone());
        for limb in 0..LIMBS {
            let along = &(&self.directions[limb] * &self.length) + &nodes[limb / AT_A_NODE];
            let force = &along * &(&force_per_mass[limb] / along.length());
            let arm = turn.turned(&self.ends[limb]);
            wrench.torque = &wrench.torque + &arm.cross(&force);
            wrench.force = &wrench.force + &force;
        }
        wrench
    }

    /// Forces of the limbs per mass that hold the mass at rest against gravity, shell axes: what a piezo does not show.
    fn at_rest(&self, stiffness: &Big, gravity: &Vector) -> [Big; LIMBS] {
        let mut pose = Pose {
            position: Vector::new([0.0; 3]),
            rotation: Vector::new([0.0; 3]),
        };
        let mut forces = core::array::from_fn(|_| big(0.0));
        for _ in 0..ITERATIONS {
            let nodes = self.placed(&pose);
            for limb in 0..LIMBS {
                let p = &nodes[limb / AT_A_NODE];
                let along = &(&self.directions[limb] * &self.length) + p;
                let q = &self.directions[limb].dot(p) * &(&big(2.0) * &self.length) + p.dot(p);
                forces[limb] = -(stiffness * q / (&self.length + along.length()));
            }
            let wrench = self.wrench(&pose, &nodes, &forces);
            let missing: Vec<Big> = [&wrench.force + gravity, wrench.torque]
                .iter()
                .flat_map(|v| v.0.each_ref().map(|x| x / stiffness))
                .collect();
            let mut normal = Normal::of(6);
            for row in &self.wrenches {
                let row: Vec<(usize, Big)> = row.iter().cloned().enumerate().collect();
                normal.push(&row, &big(0.0));
            }
            let step = solve(normal.matrix(), missing);
            let part = |first: usize| Vector(core::array::from_fn(|i| step[first + i].clone()));
            // Compression pushes along e, so that the mass gives way against what is asked of the limbs.
            pose.position = &pose.position + &part(0);
            pose.rotation = &pose.rotation + &part(3);
        }
        forces
    }
}

/// Motion of the mass in the shell.
struct Relative {
    pose: Pose,
    velocity: Vector,
    rate: Vector,
    acceleration: Vector,
    angular: Vector,
}

impl Relative {
    /// Central differences of three poses; w_r = sum ad^k(phi) phi' / (k + 1)!, and its derivative.
    fn of(poses: [&Pose; 3], step: &Big) -> Self {
        let half_rate = big(0.5) / step;
        let rate2 = big(1.0) / (step * step);
        let differences = |of: fn(&Pose) -> &Vector| {
            let [before, now, after] = poses.map(of);
            let second = &(after - now) - &(now - before);
            [&(after - before) * &half_rate, &second * &rate2]
        };
        let [velocity, acceleration] = differences(|pose| &pose.position);
        let [mut term, mut slope] = differences(|pose| &pose.rotation);
        let (phi, phi_dot) = (&poses[1].rotation, term.clone());
        let (mut rate, mut angular) = (term.clone(), slope.clone());
        for k in 2..=SERIES {
            let part = big(1.0) / big(f64::from(k));
            slope = &(&phi_dot.cross(&term) + &phi.cross(&slope)) * &part;
            term = &phi.cross(&term) * &part;
            rate = &rate + &term;
            angular = &angular + &slope;
        }
        Self {
            pose: poses[1].clone(),
            velocity,
            rate,
            acceleration,
            angular,
        }
    }
}

/// One decoupled sample.
pub struct Answer {
    /// a, ground axes, m/s^2.
    pub linear: Vector,
    /// w', ground axes, rad/s^2.
    pub angular: Vector,
    /// w*, rad/s.
    pub rate: Vector,
    /// R.
    pub attitude: Matrix,
}

/// The decoder.
pub struct Decoder {
    drawing: Drawing,
    scale: [Big; LIMBS],
    drift: [Big; LIMBS],
    gain: [Big; LIMBS],
    stiffness: Big,
    preload: [Big; LIMBS],
    inertia: Matrix,
    inverse_inertia: Matrix,
    gravity: Vector,
    step: Big,
    directions: Directions,
    /// The two samples before the newest, the older first: pose, forces, and nodes as their limbs put them.
    window: Vec<(Pose, [Big; LIMBS], [Vector; 3])>,
    last: Option<State>,
}

struct State {
    stepped: [Vector; 2],
    shell: [Vector; 2],
    attitude: Matrix,
}

impl Decoder {
    /// For a tared sensor that starts at rest with its axes along the ground's.
    pub fn new(
        sensor: &Sensor,
        parameters: &Parameters,
        settings: &Settings,
        directions: Directions,
    ) -> Self {
        let drawing = Drawing::new(sensor);
        let gravity = Vector::new(settings.gravity_ground_m_s2.to_array());
        let stiffness = big(parameters.stiffness_per_mass_per_s2);
        let inertia = tensor(&parameters.inertia_per_mass.to_paper_order().map(big));
        Self {
            preload: drawing.at_rest(&stiffness, &gravity),
            inverse_inertia: inertia.inverse(),
            inertia,
            drawing,
            scale: parameters.scale_per_mass_per_kg.map(big),
            drift: parameters.zero_drift_v.map(big),
            gain: sensor.gains.gain_n_per_v.map(big),
            stiffness,
            gravity,
            step: big(1.0) / big(settings.sample_rate_hz),
            directions,
            window: Vec::new(),
            last: None,
        }
    }

    /// The same with zero drifts, scale factors and inertia of fifty digits.
    pub fn with(mut self, drift: [Big; LIMBS], scale: [Big; LIMBS], inertia: &[Big]) -> Self {
        (self.drift, self.scale) = (drift, scale);
        self.inertia = tensor(inertia);
        self.inverse_inertia = self.inertia.inverse();
        self
    }

    /// Takes nine voltages, V; answers for the sample before them, once there are three.
    pub fn push(&mut self, voltage_v: &[f64; LIMBS]) -> Option<Answer> {
        // (11), and what the piezo does not show.
        let force: [Big; LIMBS] = core::array::from_fn(|i| {
            &self.scale[i] * &self.gain[i] * (big(voltage_v[i]) - &self.drift[i]) + &self.preload[i]
        });
        // (2), compression positive.
        let elongation = core::array::from_fn(|i| -(&force[i] / &self.stiffness));
        let nodes = self.drawing.nodes(&elongation);
        self.window.push((self.drawing.pose(&nodes), force, nodes));
        let [before, now, after] = self.window.as_slice() else {
            return None;
        };
        let relative = Relative::of([&before.0, &now.0, &after.0], &self.step);
        let (pose, force, asked) = now;
        let wrench = match self.directions {
            Directions::OfPose => self.drawing.wrench(pose, &self.drawing.placed(pose), force),
            Directions::OfNodes => self.drawing.wrench(pose, asked, force),
        };
        self.window.remove(0);
        Some(self.step(&relative, &wrench))
    }

    fn step(&mut self, relative: &Relative, wrench: &Wrench) -> Answer {
        let h = self.step.clone();
        let mass = Turn::by(relative.pose.rotation.clone());
        let torque = mass.back(&wrench.torque);
        // (8) in the mass: (I/m) W' = torque - W x (I/m) W.
        let slope = |total: &Vector| {
            let gyroscopic = total.cross(&self.inertia.times(total));
            self.inverse_inertia.times(&(&torque - &gyroscopic))
        };
        let half = big(0.5) * &h;
        let total = match &self.last {
            None => mass.back(&relative.rate),
            Some(State {
                stepped: [w, k], ..
            }) => {
                let ahead = w + &(k * &h);
                w + &(&(k + &slope(&ahead)) * &half)
            }
        };
        let stepped = slope(&total);
        let rate = &mass.turned(&total) - &relative.rate;
        let derivative =
            &(&mass.turned(&stepped) - &relative.angular) - &rate.cross(&relative.rate);
        // (9): Hermite's quadrature of the rate and the first commutator of the Magnus series.
        let attitude = match &self.last {
            None => Matrix([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(Vector::new)),
            Some(State {
                shell: [w, w_dot],
                attitude,
                ..
            }) => {
                let twelfth = &h * &h / big(12.0);
                let commutator = &(&(w_dot - &derivative) + &w.cross(&rate)) * &twelfth;
                let turn = Turn::by(&(&(w + &rate) * &half) + &commutator);
                // Column j of R exp is R (exp e_j).
                Matrix::of_columns(core::array::from_fn(|axis| {
                    let unit = core::array::from_fn(|i| f64::from(u8::from(i == axis)));
                    attitude.times(&turn.turned(&Vector::new(unit)))
                }))
            }
        };
        // (3).
        let r = &relative.pose.position;
        let euler = derivative.cross(r);
        let centripetal = rate.cross(&rate.cross(r));
        let coriolis = &rate.cross(&relative.velocity) * &big(2.0);
        let apparent = &(&(&euler + &centripetal) + &coriolis) + &relative.acceleration;
        let specific = &wrench.force - &apparent;
        self.last = Some(State {
            stepped: [total, stepped],
            shell: [rate.clone(), derivative.clone()],
            attitude: attitude.clone(),
        });
        Answer {
            linear: &attitude.times(&specific) + &self.gravity,
            angular: attitude.times(&derivative),
            rate,
            attitude,
        }
    }
}

/// The tensor of six entries in the paper's order.
fn tensor(entries: &[Big]) -> Matrix {
    let row = |columns: [usize; 3]| Vector(columns.map(|column| entries[column].clone()));
    Matrix([row([0, 3, 4]), row([3, 1, 5]), row([4, 5, 2])])
}
