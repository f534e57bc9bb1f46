//! Every number an assertion compares with, and where it comes from.
//!
//! Measured on x86-64 Linux; a margin of about ten is for other platforms' sine and tangent.

/// SciPy against ours, ordinary corners, of the peak. Measured 9e-14, where SciPy is 3e-14 from 50 digits.
pub const ZERO_PHASE: f64 = 1e-12;
/// SciPy against ours at order 8, corner 5e-4. Reference-limited: SciPy is 2.5e-11 from 50 digits.
pub const NARROW_AGAINST_SCIPY: f64 = 1e-10;
/// 50 digits against ours, same filter. Measured 2.3e-12.
pub const NARROW_AGAINST_EXACT: f64 = 1e-11;
/// What a filter may keep of what was before its settling: the 1e-16 that its documentation promises.
pub const FORGOTTEN: f64 = 1e-16;
/// One causal pass against SciPy. Measured 7e-15.
pub const CAUSAL: f64 = 1e-13;
/// Gain of a cascade against Butterworth's formula, corners from 5e-4. Measured 3.5e-11, at order 10.
pub const GAIN: f64 = 4e-10;
/// Relative move of a corner by the rounding of a section's coefficients, times (corner/sample rate)^2. Measured
/// 1.2e-17: a1 and a2 round by 2e-16 and more, and what they leave of 1, (2 pi corner/sample rate)^2, feels it.
pub const CORNER_MOVED: f64 = 5e-17;
/// Gain in the pass band, where the formula is 1 exactly: ten sections' rounding.
pub const UNIT_GAIN: f64 = 10.0 * f64::EPSILON;
/// A constant through a settled filter, of itself. Measured 0; the margin is for a sine that rounds otherwise.
pub const CONSTANT_KEPT: f64 = 1e-13;
/// What a filter at rest misses of the first sample of a constant, at least. Order 8 at 5e-4 shows (pi 5e-4)^8 = 4e-23.
pub const TRANSIENT: f64 = 0.999_999;
/// Order 8 at a corner of 5e-4, the corner off by 1 %: what the narrow check would see, at least. Measured 2e-3.
pub const NARROW_CORNER_OFF: f64 = 1e-4;

/// Detrending against SciPy, of the peak. Measured 4e-15.
pub const DETREND: f64 = 1e-13;
/// Detrending twice against once, and a line against itself, of the peak before. Measured 2e-16.
pub const PROJECTION: f64 = 1e-14;
/// A line under a motion between rests, found again. Measured 5e-16.
pub const LINE_BETWEEN_RESTS: f64 = 1e-14;
/// What the least-squares line takes off a one-sided motion instead, of its peak, at least. Measured 0.4.
pub const LINE_THROUGH_MOTION: f64 = 0.1;

/// Hampel against sorting: the same samples, picked, not computed; the records differ by their sines' last digits.
pub const HAMPEL: f64 = 8.0 * f64::EPSILON;
/// Sigmas at which a straight line is still untouched at a cut-off window: 2/1.4826, at four samples a side.
pub const HAMPEL_LINE_SIGMAS: f64 = 1.35;

/// Savitzky-Golay against SciPy, of the peak. Measured 2e-13. Reference-limited: SciPy solves powers by least squares.
pub const SAVITZKY_GOLAY: f64 = 2e-12;
/// Slope weights against fractions, of the largest. Measured 5e-16; SciPy 1.7e-9 at 401 samples.
pub const SLOPE_WEIGHTS: f64 = 1e-14;
/// Bandwidth against fractions and Brent's method, relative. Measured 3e-16.
pub const BANDWIDTH: f64 = 1e-14;
/// Slope and value of a polynomial up to the order, of the peak. Measured 4e-14.
pub const POLYNOMIAL: f64 = 1e-12;
/// The next degree up, which a window of 61 samples out of 90 cannot follow, of the peak, at least.
/// Measured 0.67 at order 1 to 0.012 at order 6.
pub const POLYNOMIAL_BEYOND: f64 = 0.005;
/// A sine through the differentiator at its bandwidth against the root of a half. Measured 2e-14.
pub const GAIN_BY_SINE: f64 = 1e-12;

/// First-order instruments against SciPy's `lsim`, of the peak. Measured 4e-15.
pub const FIRST_ORDER: f64 = 1e-13;
/// High-pass undone after done, of the peak, corners 2e-5 to 1e-1 of the sample rate. Measured 2.2e-15.
pub const UNDONE: f64 = 2e-14;
/// The same with the corner taken 1 % wrong, at least: 1 % of (2 pi 0.02 Hz) times the integral over 5 s, about 1.
pub const UNDONE_CORNER_OFF: f64 = 2e-3;
/// Low-pass plus high-pass against their input, of the peak: one subtraction and one addition.
pub const COMPLEMENT: f64 = 2.0 * f64::EPSILON;
/// Constant through a low-pass with ratio r = h/tau, of itself, times r: where a step r (u - x) no longer moves x.
pub const LOW_PASS_STALL: f64 = f64::EPSILON;
/// First-order hold's measured order against 2. Measured 3e-4.
pub const HOLD_ORDER: f64 = 2e-3;
/// First-order hold's error over (2 pi f h)^2/12, against 1. Measured 3e-4.
pub const HOLD_FACTOR: f64 = 2e-3;
/// Gyroscope of 10 Hz undone at 1 to 5 Hz, of the amplitude, ends included. Measured 6e-5.
pub const UNDONE_GYROSCOPE: f64 = 1e-4;
/// The same where no window is cut off. Measured 1.02e-5.
pub const UNDONE_GYROSCOPE_INTERIOR: f64 = 2e-5;
/// The same left alone at 1 Hz, at least: f/corner = 0.1, of which the lag alone makes 0.0995.
pub const GYROSCOPE_LEFT_ALONE: f64 = 0.09;
/// White noise of an undone gyroscope's record (10 Hz at 1 kHz, 21 samples, order 4) over that before. Measured 1.77.
pub const UNDONE_NOISE: f64 = 2.0;
/// The same with five samples, at least: tau/h = 16 times the weights' norm, 0.95.
pub const UNDONE_NOISE_SHORT: f64 = 10.0;

/// Spline against SciPy, even, jittered, steps from 0.5 to 42 000, 4 and 5 samples, of the peak. Measured 1.5e-15: the
/// records' sines differ by as much, SciPy is 2e-16 from 50 digits.
pub const SPLINE: f64 = 2e-14;
/// Two stamps off by a hundredth of a step, of the peak, at least. Measured 1.9e-6, jittered 1.2e-5, others 1e-4.
pub const SPLINE_STAMP_OFF: f64 = 1e-6;
/// A sine halfway between samples against the closed form of the cardinal spline. Measured 3.4e-10: rounding, 1e-16,
/// over an error of 4e-8 and, at half the frequency, the extremum between two samples.
pub const SPLINE_GAIN: f64 = 1e-8;
/// The same against the leading term (2 pi f/F)^4/384, over the phase's square, of which the next term is a quarter.
pub const SPLINE_LEADING_TERM: f64 = 0.3;
/// Order of that error against 4, down to 1/20 of the sample rate. Measured 2.7e-2 there, falling with the square.
pub const SPLINE_ORDER: f64 = 3e-2;
/// The table in `resample.rs`: share of the sample rate, error between samples, error within the first step.
/// Measured 4.06e-8, 4.39e-7; 2.60e-5, 2.74e-4; 4.47e-4, 4.37e-3.
pub const SINE_READ: [(f64, f64, f64); 3] = [
    (0.01, 4.1e-8, 4.5e-7),
    (0.05, 2.7e-5, 2.8e-4),
    (0.1, 4.5e-4, 4.5e-3),
];
/// Share of that table which is reached, at least.
pub const TABLE_IS_TIGHT: f64 = 0.9;
/// Fall of a sample's influence from step to step against 2 + sqrt 3. Measured 4e-16; the other end is 1e-15 away.
pub const SPLINE_FALL: f64 = 1e-12;
/// A cubic on jittered samples, of the peak. Measured 3e-16.
pub const CUBIC_READ: f64 = 1e-14;
/// A quartic, at least. Measured 2e-6.
pub const QUARTIC_READ: f64 = 1e-6;
/// Samples read back at times that were rounded, of the peak: eps times 300 samples times their slope. Measured 4e-15.
pub const SAMPLE_READ: f64 = 300.0 * f64::EPSILON;
/// Zero-phase filter over a stream against the whole record, of the peak. Measured 2e-15.
pub const ZERO_PHASE_STREAM: f64 = 1e-13;
/// Delay of half a step against the leading term of the error, over the phase's square. Measured 0.21.
pub const DELAY_LEADING_TERM: f64 = 0.3;
/// Error in the first step over the one halfway between two samples inside. Measured 4.1: 945/225 halfway.
pub const DELAY_AT_ENDS: f64 = 5.0;
/// A sine of 1/20 of the sample rate at delays up to 0.08 of a step: below its error halfway.
pub const DELAY_AT_A_TWENTIETH: f64 = 4.7e-6;
/// Error of a delay d left alone, of 2 pi f d, at least: (2 pi f d)^2/24 are missing.
pub const LEFT_ALONE: f64 = 0.99;
/// Spline of a sum against the sum of splines, of the peak. Measured 4e-16.
pub const SPLINE_SUM: f64 = 1e-14;

/// Welch's density against SciPy, of the peak. Measured 5e-16.
pub const WELCH_OF_PEAK: f64 = 1e-14;
/// Each line of it, of itself. Measured 1.6e-13, on lines 1e-5 of the peak.
pub const WELCH_OF_ITSELF: f64 = 2e-12;
/// Frequencies of the lines: one rounding.
pub const LINE_HZ: f64 = f64::EPSILON;
/// Segments that begin one sample later, of the peak, at least. Measured 1.3e-3 over 22 segments.
pub const WELCH_ELSEWHERE: f64 = 5e-4;
/// Transform against 50 digits and SciPy, of the root of the sum of squares. Measured 1.3e-16; SciPy is 8e-17 away.
pub const FOURIER: f64 = 2e-15;
/// Transform against the plain sum up to 2048 samples, likewise. Measured 2.4e-16.
pub const FOURIER_AGAINST_SUM: f64 = 3e-15;
/// The same with one sample off by 1e-6, at least. Measured 2.4e-9 at 2048 samples.
pub const FOURIER_SAMPLE_OFF: f64 = 1e-9;
/// Sum of the lines against the mean square. Measured 2e-15.
pub const PARSEVAL: f64 = 2e-14;
/// A sine on a line and beside it, of the line. Measured 9e-16.
pub const SINE_ON_A_LINE: f64 = 1e-14;
/// A sine two lines off and further, of the line: the square of rounding. Measured 1.3e-28.
pub const SINE_OFF_THE_LINE: f64 = 1e-26;
/// Level of white noise over 200 000 samples. Measured 4e-3; its standard deviation is sqrt(2/200 000) = 3e-3.
pub const WHITE_LEVEL: f64 = 0.01;
/// Scatter of a line over 568 records against 1.03/sqrt(segments). Measured 1e-2; its standard deviation is 3e-2.
pub const WHITE_SCATTER: f64 = 0.1;

/// Noise floor against NumPy, of itself. Measured 2e-13: third differences of a record of 50 times its noise.
pub const NOISE_FLOOR: f64 = 2e-12;
/// Mean of 400 noise floors of 1000 samples against what is told. Measured 3e-3; its standard deviation is 2.4e-3.
pub const NOISE_BIAS: f64 = 0.01;
/// Their scatter against 1.5/sqrt(1000). Measured 4e-2; its standard deviation is 3.5e-2.
pub const NOISE_SCATTER: f64 = 0.1;
/// Noise floor of a sine against the formula. Measured 1.7e-3, of which 1.6e-3 is 1.05 for 1.0484.
pub const SINE_AS_NOISE: f64 = 4e-3;
/// Noise floor of noise and sine over the root of the sum of squares, at least. Measured 0.868 where both are equal.
pub const NOISE_BESIDE_A_SINE: f64 = 0.86;
/// What one wild sample in a hundred raises the noise floor to. Measured 1.05.
pub const NOISE_AMONG_WILD: f64 = 1.06;
/// The standard deviation instead, at least. Measured 2.7e4.
pub const DEVIATION_AMONG_WILD: f64 = 1e4;
/// Noise floor behind a converter, away from the root of noise and rounding squared, in steps: half of the third in
/// which it is told.
pub const CONVERTER_STEP: f64 = 1.0 / 6.0;

/// L a . b against a . L^T b, of |L a| |b|: rounding of a few hundred products. Measured 5e-16.
pub const TRANSPOSED: f64 = 1e-13;
/// The same with an operation that is its own transpose but for the ends, at least. Measured 9e-4 to 7e-2.
pub const ENDS_LEFT_OUT: f64 = 1e-6;

/// Noise of a filtered record's ends against that of the parabola fitted there, over 400 ends: 5 % is the deviation of that ratio.
/// Measured 0.1.
pub const END_NOISE: f64 = 0.15;
/// A line and the ends of a parabola through a filter that is continued for five delays, of the peak. Measured 1e-3.
pub const CONTINUED_LINE: f64 = 1e-2;
/// A filter that delays by less than three samples, continued or as SciPy has it, of the peak. Measured 1e-3.
pub const WIDE_FILTER: f64 = 1e-2;
