use sixaxis_props::self_calibration::*;
fn main() {
    for s in 0..6 {
        let dur = if s < 3 { 4.0 } else { 60.0 };
        let t = std::time::Instant::now();
        let c = Case::random(s, dur);
        println!("made {:?}", t.elapsed());
        let p: Vec<_> = (0..9)
            .map(|i| {
                c.forces
                    .iter()
                    .map(|f| (f[i] - c.forces[0][i]).abs())
                    .fold(0.0, f64::max)
            })
            .collect();
        println!("peaks {p:?}");
        let clean = c.ratios(&c.voltage_v());
        match clean {
            Ok(r) => println!(
                "clean {:?} exc {:e} dev {:?}",
                errors(&r, &c.true_ln_ratio()),
                r.excitation,
                r.deviations()
            ),
            Err(e) => println!("{e}"),
        }
        let t = std::time::Instant::now();
        let u = c.noisy_v(NOISE_SHARE);
        println!("noise {:?}", t.elapsed());
        let t = std::time::Instant::now();
        match c.ratios(&u) {
            Ok(r) => {
                println!(
                    "noisy {:?}\n exc {:e} dev {:?} lag {} misfit {}",
                    errors(&r, &c.true_ln_ratio()),
                    r.excitation,
                    r.deviations(),
                    r.lag_one_z(),
                    r.misfit.z()
                )
            }
            Err(e) => println!("{e}"),
        }
        println!("fit {:?}", t.elapsed());
    }
}
