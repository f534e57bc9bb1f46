//! The ways in which samples are decoded: by the decoupler, by the decoder with aids, or by the one that watches for failures.

use sixaxis_core::LIMBS;
use sixaxis_core::decouple::uncertainty::SampleUncertainty;
use sixaxis_core::six_axis::SixAxisColumns;
use sixaxis_recordings::Block;

use super::Decoding;
use crate::apply::Row;
use crate::apply::columns::DEVIATIONS;

impl Decoding {
    /// By the decoupler, with the attitude followed beside it, without the limbs that a first pass has found to have failed, from
    /// where each did.
    pub(super) fn answers_in_parts(
        &mut self,
        voltage_v: [&[f64]; LIMBS],
        block: &mut Block,
    ) -> sixaxis_core::Result<()> {
        let (first, samples) = (self.decoupler.received(), voltage_v[0].len());
        let watched = self.watched.as_ref();
        let changes: Vec<_> = watched.map_or_else(Vec::new, |watched| {
            let all = watched.found.excluded.changes();
            all.filter(|(at, _)| (first..first + samples as u64).contains(at))
                .collect()
        });
        let mut from = 0;
        for (at, limbs) in changes {
            let to = (at - first) as usize;
            self.answers(voltage_v.map(|column| &column[from..to]), block)?;
            self.decoupler.set_excluded(limbs)?;
            if let Some(attitude) = &mut self.attitude {
                attitude.set_excluded(limbs)?;
            }
            from = to;
        }
        self.answers(voltage_v.map(|column| &column[from..]), block)
    }

    /// By the decoupler, with the limbs that it has now.
    fn answers(
        &mut self,
        voltage_v: [&[f64]; LIMBS],
        block: &mut Block,
    ) -> sixaxis_core::Result<()> {
        let first = self.decoupler.received();
        let (answers, more) = block.columns[1..].split_at_mut(self.columns.count());
        let deviations = if self.deviates { DEVIATIONS.len() } else { 0 };
        let deviations = &mut more[..deviations];
        let (uncertainty, attitude) = (&mut self.uncertainty, &mut self.attitude);
        let (before, gravity) = (self.before, self.gravity_ground_m_s2);
        // Voltages of a sample that is answered: of this block, or the last one of the block before.
        let row = |sample: u64| match sample.checked_sub(first) {
            Some(here) => voltage_v.map(|column| column[here as usize]),
            None => before,
        };
        let mut refused = Ok(());
        let done = self.decoupler.push_columns(voltage_v, &mut |done| {
            if refused.is_err() {
                return;
            }
            if attitude.is_none() && !self.columns.in_sensor_axes() {
                self.columns.extend(done, answers);
            } else {
                for answer in done.iter() {
                    let known = attitude.as_mut().is_none_or(|attitude| {
                        attitude.see(&row(answer.sample), &answer);
                        attitude.counts()
                    });
                    self.columns.push(&answer, known, gravity, answers);
                    if let (Some(column), Some(attitude)) =
                        (deviations.last_mut(), attitude.as_ref())
                    {
                        column.extend(attitude.deviations().last());
                    }
                }
            }
            if let Some(stream) = uncertainty {
                refused = spread(stream, done, deviations, &row);
            }
        });
        if let Some(last) = voltage_v[0].len().checked_sub(1) {
            self.before = voltage_v.map(|column| column[last]);
        }
        refused.and(done)
    }

    /// By the decoder with aids.
    pub(super) fn aided(
        &mut self,
        voltage_v: [&[f64]; LIMBS],
        block: &mut Block,
    ) -> sixaxis_core::Result<()> {
        let Some(attitude) = &mut self.attitude else {
            return Ok(());
        };
        let (answers, more) = block.columns[1..].split_at_mut(self.columns.count());
        let deviations = if self.deviates { DEVIATIONS.len() } else { 0 };
        let deviations = &mut more[..deviations];
        let first = self.samples - voltage_v[0].len() as u64;
        for sample in 0..voltage_v[0].len() {
            if let Some(watched) = &self.watched {
                let now = first + sample as u64;
                if let Some(limbs) = watched.found.excluded.change_at(now) {
                    attitude.set_excluded(limbs)?;
                    let noise = watched.noise.iter().find(|(from, _)| *from == now);
                    noise
                        .into_iter()
                        .for_each(|(_, noise)| attitude.set_noise(*noise));
                }
            }
            let row = voltage_v.map(|column| column[sample]);
            let Some(motion) = attitude.push(&row)? else {
                continue;
            };
            let known = attitude.counts();
            self.columns
                .push(&motion, known, self.gravity_ground_m_s2, answers);
            for (column, value) in deviations.iter_mut().zip(attitude.deviations()) {
                column.push(*value);
            }
        }
        Ok(())
    }

    /// By the decoder that watches for failures, with the attitude followed beside it.
    pub(super) fn watched(
        &mut self,
        voltage_v: [&[f64]; LIMBS],
        block: &mut Block,
    ) -> sixaxis_core::Result<()> {
        let Some(watching) = &mut self.watching else {
            return Ok(());
        };
        for sample in 0..voltage_v[0].len() {
            let row = voltage_v.map(|column| column[sample]);
            let excluded = watching.excluded();
            let answer = watching.push(&row)?;
            if let Some(attitude) = &mut self.attitude
                && watching.excluded() != excluded
            {
                attitude.set_excluded(watching.excluded())?;
            }
            if let Some((motion, flags)) = answer {
                let known = self.attitude.as_mut().is_none_or(|attitude| {
                    attitude.see(&self.before, &motion);
                    attitude.counts()
                });
                let (answers, of_flags) = block.columns[1..].split_at_mut(self.columns.count());
                self.columns
                    .push(&motion, known, self.gravity_ground_m_s2, answers);
                for (column, value) in of_flags.iter_mut().zip(flags) {
                    column.push(value);
                }
            }
            self.before = row;
        }
        Ok(())
    }
}

/// Appends standard deviations of the accelerations of answers to their columns; `row` gives the voltages of a sample.
fn spread(
    stream: &mut SampleUncertainty,
    answers: SixAxisColumns,
    deviations: &mut [Vec<f64>],
    row: &impl Fn(u64) -> Row,
) -> sixaxis_core::Result<()> {
    for motion in answers.iter() {
        let spread = stream.push(&row(motion.sample), &motion)?;
        for (column, value) in deviations.iter_mut().zip(spread.accelerations()) {
            column.push(value);
        }
    }
    Ok(())
}
