//! placeholder
fn main() -> anyhow::Result<()> {
    let quick = std::env::args().any(|a| a == "--quick");
    let t = std::time::Instant::now();
    let r = sixaxis_reports::study::run(
        &sixaxis_reports::study::plan::Plan {
            seed: std::env::args()
                .nth(1)
                .and_then(|s| s.parse().ok())
                .unwrap_or(1),
            quick,
        },
        &sixaxis_reports::progress::Progress::shown(),
    )?;
    eprintln!("{:?}", t.elapsed());
    for b in &r.bars {
        println!(
            "{} {:<50} {:.3e} <= {:.1e} {} {}",
            if b.met { "ok  " } else { "MISS" },
            b.name,
            b.value,
            b.limit,
            b.unit,
            b.note
        );
    }
    std::fs::write("/tmp/results.json", serde_json::to_string_pretty(&r)?)?;
    Ok(())
}
