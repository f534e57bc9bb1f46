//! Those who decode: voltages in, six accelerations out.

use sixaxis_core::Decoupler;
use sixaxis_core::LIMBS;
use sixaxis_core::Scheme;
use sixaxis_core::SixAxis;
use sixaxis_core::decouple::lanes::LaneSample;
use sixaxis_core::decouple::lanes::push_lanes;
use sixaxis_core::kernel::simd::LANES;
use sixaxis_core::six_axis::SixAxisColumns;
use sixaxis_props::problem::recorded::true_parameters;
use std::array::from_fn;
use std::hint::black_box;

use crate::peer::{Decoder, Input, Peer, Row, row};

pub fn push(input: &Input) -> Box<dyn Peer> {
    let ready = input.recorded.decoupler(Scheme::Heun);
    let voltage_v = input.recorded.recording.voltage_v.clone();
    Decoder::boxed(voltage_v.len(), move |rows| {
        let mut decoupler = black_box(&ready).clone();
        let sink = |s: &SixAxis| rows.push(row(s.linear_ground_m_s2, s.angular_ground_rad_s2));
        decoupler
            .push_all(black_box(&voltage_v), sink)
            .expect("a recorded run");
    })
}

/// The record path, which answers in columns: those of the accelerations are kept as they come.
struct Record {
    ready: Decoupler,
    portable: bool,
    voltage_v: Vec<[f64; LIMBS]>,
    columns: [Vec<f64>; 6],
}

impl Peer for Record {
    fn decode(&mut self) {
        let mut decoupler = black_box(&self.ready).clone();
        let columns = &mut self.columns;
        columns.iter_mut().for_each(Vec::clear);
        let mut sink = |done: SixAxisColumns| {
            for (kept, column) in columns.iter_mut().zip(done.columns()) {
                kept.extend_from_slice(column);
            }
        };
        let voltage_v = black_box(&self.voltage_v);
        let done = if self.portable {
            decoupler.push_record_portable(voltage_v, &mut sink)
        } else {
            decoupler.push_record(voltage_v, &mut sink)
        };
        done.expect("a recorded run");
    }

    fn rows(&self) -> Vec<Row> {
        let samples = 0..self.columns[0].len();
        samples
            .map(|i| from_fn(|column| self.columns[column][i]))
            .collect()
    }
}

pub fn record(input: &Input, portable: bool) -> Box<dyn Peer> {
    let voltage_v = input.recorded.recording.voltage_v.clone();
    Box::new(Record {
        ready: input.recorded.decoupler(Scheme::Heun),
        portable,
        columns: from_fn(|_| Vec::with_capacity(voltage_v.len())),
        voltage_v,
    })
}

/// Eight streams of the same record; the rows are the last one's.
pub struct Lanes {
    pub ready: Decoupler,
    pub voltage_v: Vec<[f64; LIMBS]>,
    pub samples: Vec<LaneSample>,
}

impl Peer for Lanes {
    fn decode(&mut self) {
        let mut streams: [Decoupler; LANES] = from_fn(|_| black_box(&self.ready).clone());
        let rows = black_box([&self.voltage_v[..]; LANES]);
        self.samples.clear();
        let samples = &mut self.samples;
        push_lanes(&mut streams, rows, &mut |done| {
            samples.extend_from_slice(done)
        })
        .expect("a recorded run");
    }

    fn records(&self) -> u32 {
        LANES as u32
    }

    fn rows(&self) -> Vec<Row> {
        let last = |sample: &LaneSample| from_fn(|i| sample[i].0[LANES - 1]);
        self.samples.iter().map(last).collect()
    }
}

pub fn lanes(input: &Input) -> Box<dyn Peer> {
    let voltage_v = input.recorded.recording.voltage_v.clone();
    Box::new(Lanes {
        ready: input.recorded.decoupler(Scheme::Heun),
        samples: Vec::with_capacity(voltage_v.len()),
        voltage_v,
    })
}

pub fn paper(input: &Input) -> Box<dyn Peer> {
    let ready = input.recorded.paper_decoder(&true_parameters());
    let voltage_v = input.recorded.recording.voltage_v.clone();
    Decoder::boxed(voltage_v.len(), move |rows| {
        let mut decoder = black_box(&ready).clone();
        let sink = |s: &SixAxis| rows.push(row(s.linear_ground_m_s2, s.angular_ground_rad_s2));
        decoder
            .push_all(black_box(&voltage_v), sink)
            .expect("a recorded run");
    })
}
