//! Welch's density, the transform under it, and the noise floor.

use core::f64::consts::{PI, TAU};

use sixaxis_core::dsp::spectrum::{Fourier, MIN_NOISE_SAMPLES, noise_floor, welch};
use sixaxis_core::{Error, Result};

use crate::golden;
use crate::tolerance;
use crate::{Noise, check_above, check_below, distance, record, sine, thinned};

/// Normal by Box and Muller, of unit standard deviation.
fn normal(noise: &mut Noise) -> f64 {
    let radius = (-2.0 * (noise.next() + 0.5).max(f64::MIN_POSITIVE).ln()).sqrt();
    radius * (TAU * noise.next()).cos()
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

fn standard_deviation(values: &[f64]) -> f64 {
    let mean = mean(values);
    mean_square(&values.iter().map(|x| x - mean).collect::<Vec<_>>()).sqrt()
}

fn mean_square(values: &[f64]) -> f64 {
    mean(&values.iter().map(|x| x * x).collect::<Vec<_>>())
}

#[test]
fn ref_scipy_welch() -> Result<()> {
    let cases = [
        (
            (3000, 256, 1000.0, 3, 22),
            golden::WELCH_256,
            golden::WELCH_256_HZ,
        ),
        (
            (100, 64, 250.0, 1, 2),
            golden::WELCH_64,
            golden::WELCH_64_HZ,
        ),
        (
            (128, 128, 1000.0, 3, 1),
            golden::WELCH_ONE,
            golden::WELCH_ONE_HZ,
        ),
    ];
    for ((samples, segment, rate_hz, stride, segments), densities, frequencies_hz) in cases {
        let ours = welch(&record(samples, 1000.0), segment, rate_hz)?;
        let thin = thinned(&ours.densities, stride);
        check_below(
            "density",
            distance(&thin, densities),
            tolerance::WELCH_OF_PEAK,
        );
        let of_itself = thin
            .iter()
            .zip(densities)
            .map(|(a, b)| (a / b - 1.0).abs())
            .fold(0.0, f64::max);
        check_below("each line", of_itself, tolerance::WELCH_OF_ITSELF);
        let away = distance(&thinned(&ours.frequencies_hz, stride), frequencies_hz);
        check_below("frequencies", away, tolerance::LINE_HZ);
        assert_eq!(ours.segments, segments);
        assert_eq!(ours.densities.len(), segment / 2 + 1);
        // Control: one sample more at the front, so that every segment begins elsewhere.
        let shifted = welch(&record(samples + 1, 1000.0)[1..], segment, rate_hz)?;
        let away = distance(&thinned(&shifted.densities, stride), densities);
        check_above("segments elsewhere", away, tolerance::WELCH_ELSEWHERE);
    }
    Ok(())
}

/// Largest distance of two spectra, of the root of the sum of all lines' squares.
fn spectral_distance(ours: &[f64], reference: &[f64], scale: f64) -> f64 {
    assert_eq!(ours.len(), reference.len());
    let away = ours.chunks(2).zip(reference.chunks(2)).map(|(a, b)| {
        let d = (a[0] - b[0]).hypot(a[1] - b[1]);
        if d.is_nan() { f64::INFINITY } else { d }
    });
    away.fold(0.0, f64::max) / scale
}

/// The transform as pairs, from 0 to half the sample rate.
fn transformed(series: &[f64]) -> Result<Vec<f64>> {
    let mut packed = series.to_vec();
    Fourier::new(series.len())?.transform(&mut packed)?;
    let half = packed[1];
    packed[1] = 0.0;
    packed.extend([half, 0.0]);
    Ok(packed)
}

/// Root of the sum of |X|^2 from 0 to half the sample rate.
fn norm(pairs: &[f64]) -> f64 {
    pairs.iter().map(|x| x * x).sum::<f64>().sqrt()
}

#[test]
fn ref_exact_transform() -> Result<()> {
    let ours = transformed(&record(256, 1000.0))?;
    let thin: Vec<f64> = ours.chunks(2).step_by(4).flatten().copied().collect();
    let away = spectral_distance(&thin, golden::FOURIER_256_EXACT, norm(&ours));
    check_below("256 samples", away, tolerance::FOURIER);
    Ok(())
}

#[test]
fn ref_scipy_transform() -> Result<()> {
    let ours = transformed(&record(4096, 1000.0))?;
    let thin: Vec<f64> = ours.chunks(2).step_by(64).flatten().copied().collect();
    let away = spectral_distance(&thin, golden::FOURIER_4096, norm(&ours));
    check_below("4096 samples", away, tolerance::FOURIER);
    Ok(())
}

/// The definition, its angles reduced in whole numbers.
fn by_definition(series: &[f64]) -> Vec<f64> {
    let n = series.len();
    (0..=n / 2)
        .flat_map(|k| {
            let (mut re, mut im) = (0.0, 0.0);
            for (i, x) in series.iter().enumerate() {
                let (sine, cosine) = (TAU * ((i * k) % n) as f64 / n as f64).sin_cos();
                re += x * cosine;
                im -= x * sine;
            }
            [re, im]
        })
        .collect()
}

#[test]
fn inv_transform_is_its_definition_at_every_length() -> Result<()> {
    for bits in 2..=11 {
        let mut noise = Noise(golden::SEED + bits);
        let series: Vec<f64> = (0..1 << bits).map(|_| noise.next()).collect();
        let (ours, defined) = (transformed(&series)?, by_definition(&series));
        check_below(
            &format!("{} samples", series.len()),
            spectral_distance(&ours, &defined, norm(&defined)),
            tolerance::FOURIER_AGAINST_SUM,
        );
        // Control: one sample off by a part in a million.
        let mut off = series.clone();
        off[1] += 1e-6;
        check_above(
            "one sample off",
            spectral_distance(&transformed(&off)?, &defined, norm(&defined)),
            tolerance::FOURIER_SAMPLE_OFF,
        );
    }
    Ok(())
}

#[test]
fn inv_density_adds_up_to_the_mean_square() -> Result<()> {
    // One segment: then it is the weighted mean square about the mean, exactly.
    let (n, rate_hz) = (512, 1000.0);
    let series = record(n, rate_hz);
    let ours = welch(&series, n, rate_hz)?;
    let weights: Vec<f64> = (0..n)
        .map(|k| 0.5 - 0.5 * (TAU * k as f64 / n as f64).cos())
        .collect();
    let middle = mean(&series);
    let weighted: Vec<f64> = series
        .iter()
        .zip(&weights)
        .map(|(x, w)| w * (x - middle))
        .collect();
    let expected = mean_square(&weighted) / mean_square(&weights);
    let total = ours.densities.iter().sum::<f64>() * rate_hz / n as f64;
    check_below(
        "sum of the lines",
        (total / expected - 1.0).abs(),
        tolerance::PARSEVAL,
    );
    Ok(())
}

#[test]
fn inv_sine_on_a_line() -> Result<()> {
    let (segment, rate_hz, line, amplitude) = (256, 512.0, 20, 3.0);
    let frequency_hz = line as f64 * rate_hz / segment as f64;
    let series: Vec<f64> = sine(2000, frequency_hz, rate_hz)
        .iter()
        .map(|x| amplitude * x)
        .collect();
    let ours = welch(&series, segment, rate_hz)?;
    let expected = amplitude * amplitude / 2.0 / (1.5 * rate_hz / segment as f64);
    check_below(
        "on the line",
        (ours.densities[line] / expected - 1.0).abs(),
        tolerance::SINE_ON_A_LINE,
    );
    for (k, density) in ours.densities.iter().enumerate() {
        if k.abs_diff(line) > 1 {
            let share = density / expected;
            assert!(share < tolerance::SINE_OFF_THE_LINE, "line {k}: {share:e}");
        }
    }
    // Neighbours hold a quarter each.
    check_below(
        "beside the line",
        (ours.densities[line + 1] / expected - 0.25).abs(),
        tolerance::SINE_ON_A_LINE,
    );
    Ok(())
}

#[test]
fn inv_white_noise_is_flat() -> Result<()> {
    let (segment, rate_hz, sigma) = (64, 1000.0, 0.3);
    let mut noise = Noise(golden::SEED);
    let series: Vec<f64> = (0..200_000).map(|_| sigma * normal(&mut noise)).collect();
    let ours = welch(&series, segment, rate_hz)?;
    // The two lowest lines lack what went with the mean; the last has no negative twin.
    let lines = &ours.densities[2..segment / 2];
    let level = sigma * sigma / (rate_hz / 2.0);
    check_below(
        "level",
        (mean(lines) / level - 1.0).abs(),
        tolerance::WHITE_LEVEL,
    );
    // Scatter from record to record, in records of ten segments.
    let samples = 5 * segment + segment / 2;
    let scatter: Vec<f64> = series
        .chunks_exact(samples)
        .map(|record| welch(record, segment, rate_hz))
        .map(|spectrum| spectrum.map(|s| (s.densities[16] / level, s.segments)))
        .map(|line| {
            line.map(|(density, segments)| {
                assert_eq!(segments, 10);
                density
            })
        })
        .collect::<Result<_>>()?;
    let predicted = 1.03 / 10.0_f64.sqrt();
    check_below(
        "scatter over the predicted, less 1",
        (standard_deviation(&scatter) / predicted - 1.0).abs(),
        tolerance::WHITE_SCATTER,
    );
    Ok(())
}

#[test]
fn inv_spectrum_refuses() -> Result<()> {
    let series = record(300, 1000.0);
    // Control: what is just not refused.
    assert_eq!(welch(&series, 8, 1000.0)?.densities.len(), 5);
    assert_eq!(welch(&series[..256], 256, 1000.0)?.segments, 1);
    assert!(noise_floor(&series[..MIN_NOISE_SAMPLES])? > 0.0);
    for segment in [0, 1, 4, 7, 100, 255, usize::MAX] {
        assert!(matches!(
            welch(&series, segment, 1000.0),
            Err(Error::OutOfRange {
                name: "segment",
                ..
            })
        ));
    }
    for rate_hz in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(matches!(
            welch(&series, 64, rate_hz),
            Err(Error::OutOfRange {
                name: "sample_rate_hz",
                ..
            })
        ));
    }
    // A length that no memory holds is refused before it is asked for.
    for segment in [512, 1 << (usize::BITS - 1)] {
        assert!(matches!(
            welch(&series, segment, 1000.0),
            Err(Error::TooFewSamples { needed, got: 300, .. }) if needed == segment
        ));
    }
    let mut gap = series.clone();
    gap[299] = f64::NAN;
    // In the part of the record that no segment reaches, too.
    for stage in [
        welch(&gap, 256, 1000.0).map(|_| ()),
        noise_floor(&gap).map(|_| ()),
    ] {
        assert!(matches!(stage, Err(Error::NotFinite { sample: 299, .. })));
    }
    let huge: Vec<f64> = sine(300, 130.0, 1000.0).iter().map(|x| x * 1e308).collect();
    for stage in [
        welch(&huge, 64, 1000.0).map(|_| ()),
        noise_floor(&huge).map(|_| ()),
    ] {
        assert!(matches!(stage, Err(Error::Overflow { .. })));
    }
    for length in [0, 1, 2, 6, 100] {
        assert!(matches!(
            Fourier::new(length),
            Err(Error::OutOfRange { name: "length", .. })
        ));
    }
    assert!(matches!(
        Fourier::new(64)?.transform(&mut [0.0; 32]),
        Err(Error::LengthMismatch {
            expected: 64,
            got: 32,
            ..
        })
    ));
    assert!(matches!(
        noise_floor(&series[..MIN_NOISE_SAMPLES - 1]),
        Err(Error::TooFewSamples { .. })
    ));
    Ok(())
}

#[test]
fn ref_numpy_noise_floor() -> Result<()> {
    for (samples, expected) in [32, 200, 1001, 5000].into_iter().zip(golden::NOISE_FLOOR) {
        let ours = noise_floor(&record(samples, 1000.0))?;
        check_below(
            &format!("{samples} samples"),
            (ours / expected - 1.0).abs(),
            tolerance::NOISE_FLOOR,
        );
    }
    let mut wild = record(150, 1000.0);
    for x in wild.iter_mut().step_by(10) {
        *x += 5.0;
    }
    check_below(
        "wild",
        (noise_floor(&wild)? / golden::NOISE_FLOOR_WILD[0] - 1.0).abs(),
        tolerance::NOISE_FLOOR,
    );
    Ok(())
}

#[test]
fn inv_noise_floor_of_known_noise() -> Result<()> {
    let mut noise = Noise(golden::SEED);
    let n = 1000;
    let floors = |draw: &mut dyn FnMut() -> f64| -> Result<Vec<f64>> {
        (0..400)
            .map(|_| noise_floor(&(0..n).map(|_| draw()).collect::<Vec<_>>()))
            .collect()
    };
    let of_normal = floors(&mut || normal(&mut noise))?;
    check_below(
        "normal, bias",
        (mean(&of_normal) - 1.0).abs(),
        tolerance::NOISE_BIAS,
    );
    let scatter = standard_deviation(&of_normal) * f64::from(n).sqrt();
    check_below(
        "normal, scatter over 1.5, less 1",
        (scatter / 1.5 - 1.0).abs(),
        tolerance::NOISE_SCATTER,
    );
    let of_uniform = floors(&mut || 12.0_f64.sqrt() * noise.next())?;
    check_below(
        "uniform, bias less 5.5 %",
        (mean(&of_uniform) - 1.055).abs(),
        tolerance::NOISE_BIAS,
    );
    Ok(())
}

#[test]
fn inv_sine_passes_for_little_noise() -> Result<()> {
    // A whole number of samples to a period: the same few phases again and again.
    for (period, share) in [(100.0, 0.035), (20.0, 0.18), (10.0, 0.23)] {
        let formula = 1.05 * (2.0 * (PI / period).sin()).powi(3) / 20.0_f64.sqrt();
        let mut farthest = 0.0_f64;
        for phase in 0..64 {
            let phase = TAU * f64::from(phase) / 64.0 / period;
            let motion: Vec<f64> = (0..2000)
                .map(|k| (TAU * f64::from(k) / period + phase).sin())
                .collect();
            farthest = farthest.max((noise_floor(&motion)? / formula - 1.0).abs());
        }
        check_below("by the phase", farthest, share);
        check_above("by the phase", farthest, 0.8 * share);
    }
    for share in [0.01, 0.05, 0.1] {
        // Not quite a whole number of samples to a period, so that all phases occur.
        let share: f64 = share * 1.00123;
        let motion = sine(50_000, share, 1.0);
        let told = 1.05 * (2.0 * (TAU * share / 2.0).sin()).powi(3) / 20.0_f64.sqrt();
        let alone = noise_floor(&motion)?;
        check_below(
            "no noise, over the formula, less 1",
            (alone / told - 1.0).abs(),
            tolerance::SINE_AS_NOISE,
        );
        for ratio in [0.3, 1.0, 3.0, 100.0] {
            let mut noise = Noise(golden::SEED);
            let sigma = ratio * told;
            let noisy: Vec<f64> = motion
                .iter()
                .map(|x| x + sigma * normal(&mut noise))
                .collect();
            let share = noise_floor(&noisy)? / sigma.hypot(told);
            check_below(
                "of the root of the sum of squares",
                share,
                1.0 + tolerance::NOISE_BIAS,
            );
            check_above(
                "of the root of the sum of squares",
                share,
                tolerance::NOISE_BESIDE_A_SINE,
            );
            check_above(
                "standard deviation instead",
                standard_deviation(&noisy) / sigma,
                1.0,
            );
        }
    }
    Ok(())
}

#[test]
fn inv_wild_values_hardly_raise_the_noise_floor() -> Result<()> {
    let mut noise = Noise(golden::SEED);
    let clean: Vec<f64> = (0..20_000).map(|_| normal(&mut noise)).collect();
    let mut wild = clean.clone();
    for x in wild.iter_mut().step_by(100) {
        *x += 1e6 * noise.next();
    }
    let raised = noise_floor(&wild)? / noise_floor(&clean)?;
    check_below("raised to", raised, tolerance::NOISE_AMONG_WILD);
    check_above(
        "standard deviation",
        standard_deviation(&wild),
        tolerance::DEVIATION_AMONG_WILD,
    );
    Ok(())
}

#[test]
fn inv_noise_floor_behind_a_converter() -> Result<()> {
    let mut noise = Noise(golden::SEED);
    let mut converted = |sigma: f64| -> Result<f64> {
        let series: Vec<f64> = sine(4000, 0.0005, 1.0)
            .iter()
            .map(|x| (3.0 * x + sigma * normal(&mut noise)).round())
            .collect();
        noise_floor(&series)
    };
    assert_eq!(converted(0.1)?, 0.0);
    for sigma in [0.5_f64, 0.7, 1.0, 2.0, 3.0] {
        // Rounding adds the variance of a uniform step.
        let told = converted(sigma)? - (sigma * sigma + 1.0 / 12.0).sqrt();
        check_below("steps away", told.abs(), tolerance::CONVERTER_STEP);
    }
    Ok(())
}

#[test]
fn prop_noise_floor_knows_scale_but_no_offset() -> Result<()> {
    let mut draw = Noise(golden::SEED + 3);
    for round in 0..200 {
        let mut noise = Noise(golden::SEED + 100 + round);
        let n = MIN_NOISE_SAMPLES + (500.0 * (draw.next() + 0.5)) as usize;
        let series: Vec<f64> = (0..n).map(|_| noise.next()).collect();
        let floor = noise_floor(&series)?;
        let of = |map: &dyn Fn(f64, f64) -> f64| -> Result<f64> {
            let mapped: Vec<f64> = series
                .iter()
                .enumerate()
                .map(|(k, x)| map(*x, k as f64 / n as f64))
                .collect();
            Ok((noise_floor(&mapped)? / floor - 1.0).abs())
        };
        // To the bit: turned round, and by a power of two.
        assert_eq!(of(&|x, _| -x)?, 0.0);
        let power = 2.0_f64.powi((600.0 * draw.next()) as i32);
        let scaled: Vec<f64> = series.iter().map(|x| x * power).collect();
        assert_eq!(noise_floor(&scaled)?, floor * power);
        let offset = 200.0 * draw.next();
        // Each sample rounds by eps/2 of its size, a third difference by eight times that.
        let limit = 8.0 * f64::EPSILON * 400.0 / floor;
        let away = of(&|x, _| x + offset)?;
        assert!(away < limit, "offset {offset}: {away:e}");
        let away = of(&|x, t| x + offset * (1.0 + t + t * t))?;
        assert!(away < limit, "curve {offset}: {away:e}");
        let factor = 10.0_f64.powf(10.0 * draw.next());
        let scaled: Vec<f64> = series.iter().map(|x| x * factor).collect();
        let away = (noise_floor(&scaled)? / (floor * factor) - 1.0).abs();
        assert!(away < limit, "factor {factor}: {away:e}");
        // Control: noise of twice the size is told apart.
        assert!(of(&|x, _| 2.0 * x)? > limit);
    }
    Ok(())
}
