//! What a record holds beside the motion: power spectral density after Welch, and the noise floor as one number.
//!
//! Both only look. Before a filter is chosen they say where the motion ends and the noise begins; after it, what is
//! left.

use alloc::vec::Vec;

use super::outlier::{SIGMA_PER_MAD, median};
use super::{check_answer, check_finite, detrend};
use crate::error::{Error, Result, require, require_positive, require_samples};
use crate::float::{sin_cos, sqrt};

/// Shortest segment offered: the window's own line is four wide.
pub const MIN_SEGMENT: usize = 8;

/// Fewest samples of which a noise floor is told: it scatters by a quarter then.
pub const MIN_NOISE_SAMPLES: usize = 32;

/// Power spectral density, one-sided: its sum times the distance of two lines is the mean square about the segments'
/// means.
#[derive(Debug, Clone, PartialEq)]
pub struct Spectrum {
    /// Frequencies of the lines, Hz: from 0 to half the sample rate, segment/2 + 1 of them.
    pub frequencies_hz: Vec<f64>,
    /// Density at each, in the series' unit squared per Hz.
    pub densities: Vec<f64>,
    /// Segments averaged. Half of each is shared with the next; the relative standard deviation of a density of white
    /// noise is 1.03/sqrt(segments), but of the two first lines and the last, which have more: 1.7, 1.14 and 1.46. Of the mean that is taken off, the first two
    /// have less than their density.
    pub segments: usize,
}

/// Welch's estimate over a stream: mean of the periodograms of segments that overlap by half, each without its mean and under a
/// Hann window. What is left over at the end, less than half a segment, is not used.
///
/// Holds three segments and the spectrum. A segment with a sample that is not finite, or of a size whose mean is not, is left
/// out and counted.
#[derive(Debug, Clone, PartialEq)]
pub struct Welch {
    fourier: Fourier,
    /// Periodic Hann window, sin^2(pi k/N): its rise is its fall backwards.
    window: Vec<f64>,
    waiting: Vec<f64>,
    work: Vec<f64>,
    sums: Vec<f64>,
    segments: usize,
    left_out: usize,
}

impl Welch {
    /// With segments of `segment` samples.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for a segment that is not a power of two or below [`MIN_SEGMENT`].
    pub fn new(segment: usize) -> Result<Self> {
        check_segment(segment)?;
        Ok(Self {
            fourier: Fourier::new(segment)?,
            window: (0..segment)
                .map(|k| {
                    let (sine, _) = sin_cos(core::f64::consts::PI * k as f64 / segment as f64);
                    sine * sine
                })
                .collect(),
            waiting: Vec::with_capacity(segment),
            work: alloc::vec![0.0; segment],
            sums: alloc::vec![0.0; segment / 2 + 1],
            segments: 0,
            left_out: 0,
        })
    }

    /// Takes the next samples.
    pub fn push(&mut self, mut samples: &[f64]) {
        let segment = self.segment();
        while !samples.is_empty() {
            let room = segment - self.waiting.len();
            let (now, later) = samples.split_at(room.min(samples.len()));
            self.waiting.extend_from_slice(now);
            samples = later;
            if self.waiting.len() == segment {
                if self.average().is_err() {
                    self.left_out += 1;
                }
                self.waiting.copy_within(segment / 2.., 0);
                self.waiting.truncate(segment / 2);
            }
        }
    }

    /// Adds the periodogram of the segment that waits.
    fn average(&mut self) -> Result<()> {
        self.work.copy_from_slice(&self.waiting);
        detrend::constant(&mut self.work)?;
        for (x, w) in self.work.iter_mut().zip(&self.window) {
            *x *= w;
        }
        self.fourier.transform(&mut self.work)?;
        let lines = self.sums.len() - 1;
        self.sums[0] += self.work[0] * self.work[0];
        self.sums[lines] += self.work[1] * self.work[1];
        let (pairs, _) = self.work.as_chunks::<2>();
        // Twice, for the negative frequencies; zero and half the sample rate have none.
        for (sum, [re, im]) in self.sums[1..lines].iter_mut().zip(&pairs[1..]) {
            *sum += 2.0 * (re * re + im * im);
        }
        self.segments += 1;
        Ok(())
    }

    /// Samples of a segment.
    #[must_use]
    pub fn segment(&self) -> usize {
        self.fourier.length()
    }

    /// Segments that were left out.
    #[must_use]
    pub const fn left_out(&self) -> usize {
        self.left_out
    }

    /// The spectrum at a sample rate; none without a segment.
    #[must_use]
    pub fn spectrum(&self, sample_rate_hz: f64) -> Option<Spectrum> {
        let (segment, segments) = (self.segment(), self.segments);
        let power: f64 = self.window.iter().map(|w| w * w).sum();
        let density = |sum: &f64| *sum / (power * segments as f64) / sample_rate_hz;
        let line = |k: usize| k as f64 / segment as f64 * sample_rate_hz;
        (segments > 0).then(|| Spectrum {
            frequencies_hz: (0..self.sums.len()).map(line).collect(),
            densities: self.sums.iter().map(density).collect(),
            segments,
        })
    }
}

fn check_segment(segment: usize) -> Result<()> {
    require(
        segment >= MIN_SEGMENT && segment.is_power_of_two(),
        "segment",
        segment as f64,
        "a power of two, at least 8",
    )
}

/// [`Welch`] of a whole record.
///
/// Equals SciPy's `welch(series, fs=sample_rate_hz, nperseg=segment)` with its defaults (periodic Hann window, overlap
/// of half, constant detrend, density, mean) to 1e-15 of the peak and each line to 2e-13 of itself (measured; test
/// `ref_scipy_welch` allows more). A sine of amplitude A on a line stands there as A^2/2 over 1.5 line distances; a trend stands in
/// the lowest lines, so detrend first.
///
/// # Errors
/// Those of [`Welch::new`]; [`Error::OutOfRange`] for a sample rate that is not positive and finite; [`Error::TooFewSamples`]
/// for a series shorter than one segment; [`Error::NotFinite`]; [`Error::Overflow`] where a segment's mean or a density overflows.
pub fn welch(series: &[f64], segment: usize, sample_rate_hz: f64) -> Result<Spectrum> {
    const WHAT: &str = "Welch's spectrum";
    check_segment(segment)?;
    require_positive("sample_rate_hz", sample_rate_hz)?;
    // Before anything of its size is allocated.
    require_samples(WHAT, segment, series.len())?;
    check_finite(series)?;
    let mut welch = Welch::new(segment)?;
    welch.push(series);
    let spectrum = welch
        .spectrum(sample_rate_hz)
        .filter(|_| welch.left_out == 0)
        .ok_or(Error::overflow(WHAT, 0))?;
    check_answer(WHAT, spectrum.densities.iter().copied())?;
    Ok(spectrum)
}

/// Discrete Fourier transform of real series of one length, a power of two: radix 2, in place.
#[derive(Debug, Clone, PartialEq)]
pub struct Fourier {
    /// Cosine and sine of 2 pi k/length for k below half the length.
    turns: Vec<(f64, f64)>,
}

impl Fourier {
    /// Computes the sines and cosines.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for a length that is not a power of two or below 4.
    pub fn new(length: usize) -> Result<Self> {
        require(
            length >= 4 && length.is_power_of_two(),
            "length",
            length as f64,
            "a power of two, at least 4",
        )?;
        let turns = (0..length / 2)
            .map(|k| {
                let (sine, cosine) = sin_cos(core::f64::consts::TAU * k as f64 / length as f64);
                (cosine, sine)
            })
            .collect();
        Ok(Self { turns })
    }

    /// Samples that [`Self::transform`] takes.
    #[must_use]
    pub fn length(&self) -> usize {
        2 * self.turns.len()
    }

    /// Replaces x by X, X_k = sum over n of x_n exp(-2 pi i k n/N), for k from 0 to N/2, packed as X_0, X_(N/2) (both
    /// real), Re X_1, Im X_1, Re X_2, ... Not allocating.
    ///
    /// Within 2e-16 of the root of the sum of all |X|^2 from the definition in 50 digits at N = 256 (measured; test
    /// `ref_exact_transform` allows more) and of SciPy's at N = 4096 (test `ref_scipy_transform`). Not checked for NaN.
    ///
    /// # Errors
    /// [`Error::LengthMismatch`].
    pub fn transform(&self, series: &mut [f64]) -> Result<()> {
        if series.len() != self.length() {
            return Err(Error::LengthMismatch {
                what: "Fourier transform",
                expected: self.length(),
                got: series.len(),
            });
        }
        // Even samples as real, odd as imaginary part: one complex transform of half the length does for both.
        let (pairs, _) = series.as_chunks_mut::<2>();
        self.complex(pairs);
        self.untangle(pairs);
        Ok(())
    }

    /// Complex transform of half the length.
    fn complex(&self, z: &mut [[f64; 2]]) {
        let bits = z.len().trailing_zeros();
        for i in 0..z.len() {
            let mirrored = i.reverse_bits() >> (usize::BITS - bits);
            if i < mirrored {
                z.swap(i, mirrored);
            }
        }
        let mut half = 1;
        while half < z.len() {
            let stride = self.turns.len() / half;
            for group in z.chunks_exact_mut(2 * half) {
                let (low, high) = group.split_at_mut(half);
                let turns = self.turns.iter().step_by(stride);
                for ((a, b), &(cosine, sine)) in low.iter_mut().zip(high).zip(turns) {
                    let turned = [b[0] * cosine + b[1] * sine, b[1] * cosine - b[0] * sine];
                    *b = [a[0] - turned[0], a[1] - turned[1]];
                    *a = [a[0] + turned[0], a[1] + turned[1]];
                }
            }
            half *= 2;
        }
    }

    /// From the transform Z of x_2n + i x_(2n+1) to that of x: even and odd samples' transforms are
    /// (Z_k + conj Z_(M-k))/2 and (Z_k - conj Z_(M-k))/2i, and X_k = even + exp(-2 pi i k/N) odd.
    fn untangle(&self, z: &mut [[f64; 2]]) {
        let m = z.len();
        z[0] = [z[0][0] + z[0][1], z[0][0] - z[0][1]];
        for k in 1..m / 2 {
            let ([a, b], [c, d]) = (z[k], z[m - k]);
            let even = [0.5 * (a + c), 0.5 * (b - d)];
            let odd = [0.5 * (b + d), 0.5 * (c - a)];
            let (cosine, sine) = self.turns[k];
            let turned = [
                odd[0] * cosine + odd[1] * sine,
                odd[1] * cosine - odd[0] * sine,
            ];
            z[k] = [even[0] + turned[0], even[1] + turned[1]];
            z[m - k] = [even[0] - turned[0], turned[1] - even[1]];
        }
        z[m / 2][1] = -z[m / 2][1];
    }
}

/// Standard deviation of a series' white noise under a smooth motion, in the series' unit: the median absolute deviation
/// of its third differences about their median, as that of a normal variable, over sqrt(20) (1 + 9 + 9 + 1).
///
/// Equals the same formula in NumPy to 2e-13 of itself (measured; test `ref_numpy_noise_floor` allows 2e-12). Offset, trend, and curves up to
/// the cubic have no say, and wild values little: one sample in a hundred, however wild, adds 5 % (test
/// `inv_wild_values_hardly_raise_the_noise_floor`).
///
/// What a motion adds: a sine of amplitude A and frequency f at sample rate F, without noise, passes for
/// 1.05 (2 sin(pi f/F))^3/sqrt(20) of A where all its phases occur: 5.8e-5 A at F/100, 7.2e-3 A at F/20, 5.5e-2 A at F/10. Of a whole number of
/// samples to a period the same few are seen again and again: then it is off by up to 3.5 % at F/100, 18 % at F/20 and 23 % at F/10, by the
/// phase. Noise beside it adds as the root of the sum of the squares, or less by up to 14 % (test `inv_sine_passes_for_little_noise`).
///
/// Unbiased for normal noise, 5.5 % high for uniform; scatters from record to record by 1.5/sqrt(samples) of itself (test
/// `inv_noise_floor_of_known_noise`). The noise is taken for white: of one behind a low-pass it shows what is left near
/// half the sample rate. A converter shows, too: noise of half a step and more is told in thirds of a step, its rounding
/// included, and noise below that may be told as 0 (test `inv_noise_floor_behind_a_converter`).
///
/// # Errors
/// [`Error::TooFewSamples`] below [`MIN_NOISE_SAMPLES`], [`Error::NotFinite`], [`Error::Overflow`].
pub fn noise_floor(series: &[f64]) -> Result<f64> {
    require_samples("noise floor", MIN_NOISE_SAMPLES, series.len())?;
    check_finite(series)?;
    let mut differences: Vec<f64> = series
        .windows(4)
        .map(|x| (x[3] - x[0]) - 3.0 * (x[2] - x[1]))
        .collect();
    check_answer("noise floor", differences.iter().copied())?;
    let middle = median(&mut differences);
    for d in &mut differences {
        *d = (*d - middle).abs();
    }
    let floor = SIGMA_PER_MAD * median(&mut differences) / sqrt(20.0);
    check_answer("noise floor", [floor])?;
    Ok(floor)
}
