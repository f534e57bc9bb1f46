//! A filter run forwards only, sample by sample: what a live display or a simulated instrument has.

use alloc::vec::Vec;

use super::butterworth::Section;
use super::stage::Stage;
use crate::error::Result;

/// A cascade and its memory. Only the constructors allocate.
#[derive(Debug, Clone, PartialEq)]
pub struct SectionsState {
    cascade: Vec<(Section, [f64; 2])>,
}

impl SectionsState {
    /// The filter after an endless input of zero.
    #[must_use]
    pub fn at_rest(sections: &[Section]) -> Self {
        Self::settled(sections, 0.0)
    }

    /// The filter after an endless constant input: a first sample of that value makes no transient.
    #[must_use]
    pub fn settled(sections: &[Section], input: f64) -> Self {
        let mut level = input;
        let cascade = sections
            .iter()
            .map(|section| {
                let memory = section.settled(level);
                level = section.step(&mut memory.clone(), level);
                (*section, memory)
            })
            .collect();
        Self { cascade }
    }

    /// What the filter makes of the next sample, in direct form II transposed. Equals SciPy's `sosfilt` to 1e-14 of the
    /// peak (measured; test `ref_scipy_causal` allows more). A NaN stays in the memory for good: look at the samples first.
    pub fn step(&mut self, input: f64) -> f64 {
        self.cascade
            .iter_mut()
            .fold(input, |x, (section, memory)| section.step(memory, x))
    }
}

/// A cascade that begins settled at its first sample, as a stage. It delays.
#[derive(Debug, Clone, PartialEq)]
pub struct Causal {
    sections: Vec<Section>,
    state: Option<SectionsState>,
}

impl Causal {
    /// Of these sections.
    #[must_use]
    pub const fn new(sections: Vec<Section>) -> Self {
        Self {
            sections,
            state: None,
        }
    }
}

impl Stage for Causal {
    fn push(&mut self, samples: &[f64], out: &mut Vec<f64>) {
        let Self { sections, state } = self;
        out.extend(samples.iter().map(|&x| {
            state
                .get_or_insert_with(|| SectionsState::settled(sections, x))
                .step(x)
        }));
    }

    fn finish(&mut self, _out: &mut Vec<f64>) -> Result<()> {
        Ok(())
    }
}
