//! A filter run causally, sample by sample: what a live display or a simulated instrument has.

use alloc::vec::Vec;

use super::butterworth::Section;

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
                level *= section.static_gain();
                (*section, memory)
            })
            .collect();
        Self { cascade }
    }

    /// What the filter makes of the next sample, in direct form II transposed. Equals SciPy's `sosfilt` to 1e-14 of the
    /// peak (test `ref_scipy_causal`). A NaN stays in the memory for good: look at the samples first.
    pub fn step(&mut self, input: f64) -> f64 {
        self.cascade
            .iter_mut()
            .fold(input, |x, (section, memory)| section.step(memory, x))
    }
}
