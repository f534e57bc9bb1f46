//! `sixaxis inspect` from the outside: files in, table, JSON, page and exit code out.

use std::fmt::Write as _;
use std::fs;
use std::path::Path;

use serde_json::Value;
use sixaxis_recordings::{Block, Layout, create};

use crate::program::{Folder, code, run, sixaxis, stdout, text};

const FOREIGN: &str = concat!(
    env!("CARGO_MANIFEST_DIR"),
    "/../recordings/tests/foreign/files"
);

fn json(arguments: &[&str]) -> Value {
    let mut all = vec!["inspect", "--json"];
    all.extend(arguments);
    serde_json::from_slice(&run(&all).stdout).expect("JSON")
}

fn kinds(file: &Value) -> Vec<(String, String)> {
    file["noticed"]
        .as_array()
        .expect("a list")
        .iter()
        .map(|n| {
            (
                n["kind"].as_str().expect("text").to_owned(),
                n["channels"][0].as_str().unwrap_or_default().to_owned(),
            )
        })
        .collect()
}

/// Noise in [-0.5, 0.5) from the sample's number: the same in Rust and NumPy, to the last bit.
fn noise(k: u64, seed: u64) -> f64 {
    let mut x = (k * 2_654_435_761 + seed * 40_503) & 0xffff_ffff;
    x ^= x >> 16;
    x = (x * 0x045d_9f3b) & 0xffff_ffff;
    x ^= x >> 16;
    x = (x * 0x045d_9f3b) & 0xffff_ffff;
    x ^= x >> 16;
    x as f64 / 4_294_967_296.0 - 0.5
}

/// 20 s at 1 kHz: a sine with hum, a clipped sine, a ramp in a unit that nobody knows, and the first with its sign turned; time
/// stamps that jitter, with a gap.
fn defective() -> String {
    let mut text = String::from("time [s],a [V],b [V],c [furlong],d [V]\n");
    let step = 20.0 / 65_536.0;
    let turn = std::f64::consts::TAU;
    for k in 0..20_000u64 {
        let t = k as f64 / 1000.0;
        let a = 2.0 * (turn * 3.125 * t).sin()
            + 0.02 * (turn * 50.0 * t).sin()
            + 0.01 * noise(k, 1)
            + 0.3;
        let a = (a / step).round() * step;
        let b = (11.0 * (turn * 2.0 * t).sin() + 0.01 * noise(k, 2)).min(10.0);
        let b = (b / step).round() * step;
        let c = 1.5 * k as f64 / 20_000.0 + 0.1 * noise(k, 3);
        let gap = if k >= 12_000 { 0.25 } else { 0.0 };
        let stamp = t + 2e-5 * noise(k, 4) + gap;
        let _ = writeln!(text, "{stamp},{a},{b},{c},{}", -a);
    }
    text
}

#[track_caller]
fn near(value: &Value, expected: f64, relative: f64) {
    let value = value.as_f64().expect("a number");
    assert!(
        (value - expected).abs() <= relative * expected.abs(),
        "{value} is not {expected}"
    );
}

/// The numbers are those of NumPy 2.4 and SciPy 1.17 for the same samples: min, max, mean, std, noise floor by its formula,
/// `scipy.signal.welch(a, 1/mean step, nperseg=4096)`, `corrcoef`, and `diff` of the time stamps.
#[test]
fn ref_numbers_of_numpy_and_scipy() {
    let folder = Folder::new("numbers");
    let file = folder.write("defective.csv", defective());
    let document = json(&[&file, "--spectra"]);
    let found = &document["files"][0];
    let group = &found["groups"][0];
    let [a, b, c] = [0, 1, 2].map(|k| &group["channels"][k]);
    // A last bit of a sine may differ from library to library and turn a rounding of 20,000; means feel that at 1e-6.
    near(&a["minimum"], -1.717_529_296_875, 1e-12);
    near(&a["maximum"], 2.317_810_058_593_75, 1e-12);
    near(&a["mean"], 0.310_201_705_932_617_2, 1e-7);
    near(&a["standard_deviation"], 1.414_209_107_935_99, 1e-7);
    near(&a["noise_floor"], 0.003_035_155_649_570_180_5, 1e-6);
    near(&b["noise_floor"], 0.002_630_468_229_627_49, 1e-6);
    near(&c["noise_floor"], 0.029_948_166_667_784_694, 1e-9);
    near(&c["mean"], 0.749_977_917_472_239_3, 1e-12);
    // The tenths are told to the nearest of 1,250 bins.
    near(&c["drift"], 1.349_321_736_172_481_9, 1e-3);
    near(&a["smallest_step"], 20.0 / 65_536.0, 1e-9);
    near(&a["bits_used"], 13.690_871_009_292_3, 1e-9);
    assert!(c["bits_used"].is_null());
    assert!(c["absent"]["bits_used"].is_string());
    let rate = 1.0 / 0.000_999_999_162_195_771_5;
    near(&group["sample_rate_hz"], rate, 1e-9);
    let densities = &a["spectrum"]["densities"];
    for (line, density) in [
        (1, 6.636_256_505_585_412e-4),
        (13, 5.185_677_061_615_324_5),
        (205, 5.214_202_473_300_605e-4),
    ] {
        near(&densities[line], density * 1000.0 / rate, 1e-5);
    }
    near(&a["dominant"]["frequency"], 3.125, 1e-3);
    near(&a["dominant"]["amplitude"], 2.0, 5e-3);
    near(&a["mains"][0]["frequency"], 50.0, 1e-3);
    near(&a["mains"][0]["amplitude"], 0.02, 2e-2);
    let top = &b["flat_top"];
    assert_eq!(top["value"], 10.0);
    assert_eq!(top["samples"], 2760);
    assert_eq!(top["longest_run"], 69);
    assert_eq!(top["first_sample"], 91);
    assert_eq!(top["at_round_limit"], true);
    assert!(b["flat_bottom"].is_null());
    let stamps = &group["time_stamps"];
    near(&stamps["jitter_rms_s"], 8.153_431_727_470_456e-6, 1e-6);
    near(&stamps["jitter_max_s"], 1.999_370_920_298_458_4e-5, 1e-6);
    assert_eq!(stamps["gaps"], 1);
    assert_eq!(stamps["first_gaps"][0]["sample"], 12_000);
    assert_eq!(stamps["first_gaps"][0]["missing"], 250);
    let r = &group["correlations"]["coefficients"];
    near(&r[0][1], -2.346_121_925_519_904_4e-4, 1e-3);
    near(&r[0][3], -1.0, 1e-12);
    let expected = [
        ("gap", "time"),
        ("clipped", "b"),
        ("drift", "c"),
        ("mains", "a"),
        ("opposite", "a"),
    ];
    assert_eq!(
        kinds(found),
        expected.map(|(kind, channel)| (kind.to_owned(), channel.to_owned()))
    );
}

#[test]
fn every_foreign_file_is_read_or_refused_with_its_name() {
    let mut read = 0;
    for kind in ["text", "tdms", "parquet", "numpy", "matlab"] {
        let files: Vec<String> = fs::read_dir(Path::new(FOREIGN).join(kind))
            .expect("lists")
            .map(|entry| entry.expect("an entry").path().display().to_string())
            .filter(|path| !path.ends_with(".json") && !path.ends_with(".expected"))
            .collect();
        assert!(!files.is_empty());
        let mut arguments = vec!["inspect", "--json"];
        arguments.extend(files.iter().map(String::as_str));
        let output = run(&arguments);
        assert!(matches!(code(&output), 0 | 1), "{kind}");
        let document: Value = serde_json::from_slice(&output.stdout).expect("JSON");
        let found = document["files"].as_array().expect("a list");
        assert_eq!(found.len(), files.len());
        for (file, path) in found.iter().zip(&files) {
            match file["error"].as_str() {
                Some(error) => assert!(error.starts_with(path.as_str()), "{error}"),
                None => {
                    assert!(!file["groups"].as_array().expect("a list").is_empty());
                    read += 1;
                }
            }
        }
    }
    assert!(read > 80, "{read} files were read");
}

#[test]
fn hostile_files_are_refused_and_do_not_stop_the_others() {
    let folder = Folder::new("hostile");
    let good = folder.write("one.csv", "t,u1\n0,1\n");
    let header = folder.write("header.csv", "t,u1,u2\n");
    let junk: Vec<u8> = (0..5000)
        .map(|k| (noise(k, 9) * 256.0) as i8 as u8)
        .collect();
    let bad = [
        folder.write("empty.csv", ""),
        folder.write("junk.csv", &junk),
        folder.write("junk.bin", &junk),
        folder.file("missing.csv"),
        text(&folder).to_owned(),
    ];
    let mut arguments = vec!["inspect"];
    arguments.extend(bad.iter().map(String::as_str));
    arguments.extend([header.as_str(), good.as_str()]);
    let output = run(&arguments);
    assert_eq!(code(&output), 1);
    let text = stdout(&output);
    assert!(text.contains("no samples in u1, u2") && text.contains("1 channel of 1 sample"));
    let errors = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(errors.lines().count(), bad.len(), "{errors}");
    for (line, file) in errors.lines().zip(&bad) {
        assert!(line.starts_with(&format!("error: {file}")), "{line}");
    }
    assert_eq!(code(&run(&["inspect", &good])), 0);
    // A picture never replaces a recording.
    assert_eq!(code(&run(&["inspect", &good, "--picture", &good])), 1);
    assert_eq!(fs::read_to_string(&good).expect("reads"), "t,u1\n0,1\n");
}

#[cfg(unix)]
#[test]
fn file_without_permission_is_refused() {
    use std::os::unix::fs::PermissionsExt;
    let folder = Folder::new("permission");
    let file = folder.write("closed.csv", "t,u1\n0,1\n");
    fs::set_permissions(&file, fs::Permissions::from_mode(0o000)).expect("closes");
    // The superuser reads it all the same.
    if fs::File::open(&file).is_err() {
        let output = run(&["inspect", &file]);
        assert_eq!(code(&output), 1);
        assert!(String::from_utf8_lossy(&output.stderr).contains("closed.csv"));
    }
}

#[test]
fn not_a_number_is_null_with_a_reason() {
    let folder = Folder::new("nan");
    let mut text = String::from("time [s],none [V],some [V]\n");
    for k in 0..300 {
        let some = if k == 137 {
            "nan".to_owned()
        } else {
            noise(k, 1).to_string()
        };
        let _ = writeln!(text, "{},nan,{some}", k as f64 / 100.0);
    }
    let file = folder.write("nan.csv", text);
    let document = json(&[&file]);
    let found = &document["files"][0];
    let [none, some] = [0, 1].map(|k| &found["groups"][0]["channels"][k]);
    assert_eq!(none["not_a_number"], 300);
    assert!(none["mean"].is_null());
    assert_eq!(none["absent"]["mean"], "no finite sample");
    assert_eq!(some["not_a_number"], 1);
    assert_eq!(some["first_not_finite"], 137);
    assert!(some["mean"].is_number() && some["noise_floor"].is_number());
    assert_eq!(kinds(found).len(), 2);
    assert_eq!(code(&run(&["inspect", &file])), 0);
    assert_eq!(code(&run(&["inspect", &file, "--strict"])), 4);
}

#[test]
fn simulated_session_is_healthy_and_its_sensor_is_found() {
    let folder = Folder::new("session");
    let day = folder.file("day");
    let simulate = "simulate --seed 3 --sensor random --engine rigid --format npz --out";
    let mut arguments: Vec<&str> = simulate.split(' ').collect();
    arguments.push(&day);
    assert_eq!(code(&run(&arguments)), 0);
    let session = folder.file("day/session.toml");
    let files: Vec<String> = [
        "static",
        "linear-01",
        "angular-05",
        "fast-10",
        "compound-02",
    ]
    .iter()
    .map(|name| folder.file(&format!("day/{name}.npz")))
    .collect();
    let mut arguments = vec!["inspect", "--strict", "--session", &session];
    arguments.extend(files.iter().map(String::as_str));
    let output = run(&arguments);
    let text = stdout(&output);
    assert_eq!(code(&output), 0, "{text}");
    assert_eq!(text.matches("nothing noticed").count(), files.len());
    assert_eq!(text.matches("nine limbs (u1 to u9)").count(), files.len());
    assert!(text.contains("sixaxis calibrate"));
}

#[test]
fn page_is_offline_and_has_every_channel() {
    let folder = Folder::new("page");
    let file = folder.write("defective.csv", defective());
    let page = folder.file("page.html");
    assert_eq!(code(&run(&["inspect", &file, "--picture", &page])), 0);
    let html = fs::read_to_string(&page).expect("written");
    for k in 1..=4 {
        assert!(html.contains(&format!("history-1-1-{k}")), "{k}");
        assert!(html.contains(&format!("spectrum-1-1-{k}")), "{k}");
    }
    assert!(!html.contains("src=\"http") && !html.contains("href=\"http"));
}

/// Nine channels of 1,200,000 samples are 86 MB as numbers; whoever held them all would need more than is allowed.
#[cfg(target_os = "linux")]
#[test]
fn long_recording_in_bounded_memory() {
    const ROWS: u64 = 1_200_000;
    const ALLOWED_KB: u64 = 80 * 1024;
    let folder = Folder::new("long");
    let path = folder.file("long.tdms");
    let layout = Layout::of_a_sensor(Some(10_000.0), false);
    let mut sink = create(Path::new(&path), &layout).expect("creates");
    let step = 20.0 / 65_536.0;
    for start in (0..ROWS).step_by(60_000) {
        let mut block = Block::new(9);
        for (channel, column) in block.columns.iter_mut().enumerate() {
            column.extend((start..start + 60_000).map(|k| {
                let x = 5.0 * (1e-3 * k as f64 + channel as f64).sin()
                    + 0.02 * noise(k, channel as u64);
                (x / step).round() * step
            }));
        }
        sink.write(&block).expect("writes");
    }
    sink.finish().expect("finishes");
    let started = std::time::Instant::now();
    let mut child = sixaxis().args(["inspect", &path]).spawn().expect("starts");
    let mut peak_kb = 0u64;
    while child.try_wait().expect("waits").is_none() {
        let status = fs::read_to_string(format!("/proc/{}/status", child.id())).unwrap_or_default();
        let now = status
            .lines()
            .find_map(|line| line.strip_prefix("VmHWM:"))
            .and_then(|rest| rest.split_whitespace().next()?.parse().ok());
        peak_kb = peak_kb.max(now.unwrap_or(0));
        std::thread::sleep(std::time::Duration::from_millis(10));
    }
    println!(
        "{:.2} s, VmHWM {} MB",
        started.elapsed().as_secs_f64(),
        peak_kb / 1024
    );
    assert!(peak_kb > 0 && peak_kb < ALLOWED_KB, "{peak_kb} kB");
}

#[test]
fn regress_names_and_unit_that_are_not_the_files_are_noticed() {
    let folder = Folder::new("inspect-names");
    let mut text = (1..=9)
        .map(|limb| format!("u{limb} [V]"))
        .collect::<Vec<_>>()
        .join(",");
    for k in 0..3000u64 {
        let row: Vec<String> = (0..9).map(|limb| noise(k, limb).to_string()).collect();
        write!(text, "\n{}", row.join(",")).expect("text");
    }
    let nameless = folder.write("other.csv", text.replace(" [V]", "").replace('u', "ch"));
    let strict = run(&["inspect", "--strict", &nameless]);
    assert_eq!(strict.status.code(), Some(4));
    assert!(stdout(&strict).contains("--channels names them"));
    let path = folder.write("run.csv", text);
    let noticed = |options: &[&str]| {
        let mut all = vec![&path[..], "--at-rest"];
        all.extend(options);
        let kinds = kinds(&json(&all)["files"][0]);
        let of = |kind: &str| kinds.iter().any(|(found, _)| found == kind);
        (of("names"), of("unit"))
    };
    assert_eq!(noticed(&[]), (false, false));
    assert_eq!(
        noticed(&["--channels", "u9,u8,u7,u6,u5,u4,u3,u2,u1", "--unit", "V"]),
        (false, false)
    );
    assert_eq!(noticed(&["--channels", "a,b,c,d,e,f,g,h,i"]), (true, false));
    assert_eq!(noticed(&["--unit", "mV"]), (false, true));
}
