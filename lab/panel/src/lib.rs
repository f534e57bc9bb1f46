//! The virtual instrument: acquisition, preprocessing, identification and decoupling as one live front panel, a page that this
//! program serves and any browser shows.
//!
//! A sample passes through the files in this order:
//!
//! | file | holds |
//! |---|---|
//! | [`source`] | where samples come from: simulated laboratory, TCP port, standard input, growing file, recording |
//! | [`columns`] | what is kept of a sample |
//! | [`acquisition`] | the one thread that takes every sample |
//! | [`statistics`] | range, noise, clipping, rest |
//! | [`chain`], [`stages`], [`decoding`], [`departures`] | stages and decoder, the truth beside them |
//! | [`recorder`] | recordings that survive the program's death |
//! | [`pyramid`], [`history`] | ten minutes of all columns, at any zoom |
//! | [`day`] | trials collected, checked and calibrated |
//! | [`board`], [`picture`], [`spectrum`] | what is left for browsers |
//! | [`control`] | what a browser may say |
//! | [`server`] | page and WebSocket |
//!
//! The acquisition waits for nobody: browsers, disk and calibration each have threads of their own, and what a browser cannot take
//! are pictures, never samples.

pub mod acquisition;
pub mod board;
pub mod chain;
pub mod columns;
pub mod control;
pub mod day;
pub mod decoding;
pub mod departures;
pub mod history;
pub mod picture;
pub mod pyramid;
pub mod recorder;
pub mod server;
pub mod source;
pub mod spectrum;
pub mod stages;
pub mod statistics;

use std::net::{SocketAddr, TcpListener};
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::mpsc::{channel, sync_channel};
use std::thread::Builder;

use anyhow::{Context, Result, ensure};
use sixaxis_calibration::calibration::Calibration;
use sixaxis_recordings::session::{Entry, Session};
use sixaxis_reference::laboratory::plan::Engine;

use board::{Board, Post};
use day::{Day, Plan};
use server::Server;
use server::guard::Guard;
use source::laboratory::LiveLaboratory;
use source::{Begin, Event, WAITING};

/// Commands that may wait for the simulated laboratory.
const LAB_COMMANDS: usize = 64;

/// Where samples come from.
#[derive(Debug, Clone)]
pub enum SourceChoice {
    /// The simulated laboratory.
    Laboratory(source::settings::Settings),
    /// A TCP port on the loopback address.
    Port(SocketAddr),
    /// Standard input.
    StandardInput,
    /// A growing file.
    Follow(PathBuf),
    /// A recording, so many times as fast as it was made.
    Play(PathBuf, f64),
}

/// What the panel is to be.
#[derive(Debug, Clone)]
pub struct Options {
    /// Where samples come from.
    pub source: SourceChoice,
    /// Samples per second, where a file does not say.
    pub rate_hz: Option<f64>,
    /// Where browsers connect; a port of 0 is any that is free.
    pub listen: SocketAddr,
    /// The token; none for one that is drawn.
    pub token: Option<String>,
    /// Folder of everything that is written.
    pub out: PathBuf,
    /// Sensor, converter, gains, rig and day; none for the paper's sensor.
    pub session: Option<Session>,
    /// What the session says of the file that is played or followed, if it has it.
    pub entry: Option<Entry>,
    /// A calibration to decode with.
    pub calibration: Option<Calibration>,
    /// Is told what the page notes: a stream that begins, is refused or ends, rows that are passed over.
    pub tell: fn(&str),
}

/// A panel that is running.
pub struct Panel {
    /// The link to open.
    pub link: String,
    /// Where senders connect, for a source of that kind.
    pub input: Option<SocketAddr>,
    board: Arc<Board>,
    acquisition: Option<std::thread::JoinHandle<()>>,
}

impl Panel {
    /// Waits until the instrument is shut down: for ever, where nobody does that.
    pub fn wait(&mut self) {
        if let Some(thread) = self.acquisition.take() {
            let _ = thread.join();
        }
    }
}

impl Drop for Panel {
    fn drop(&mut self) {
        self.board.end();
        self.wait();
    }
}

/// Starts the panel.
///
/// # Errors
/// An address that cannot be listened on; one beyond the loopback without a token of at least 16 characters; an output folder that cannot be
/// made; a file that cannot be played or followed.
pub fn start(options: Options) -> Result<Panel> {
    let loopback = options.listen.ip().is_loopback();
    if let Some(token) = &options.token {
        let plain = token
            .bytes()
            .all(|b| b.is_ascii_alphanumeric() || b"-_.~".contains(&b));
        ensure!(
            (16..=128).contains(&token.len()) && plain,
            "a token is 16 to 128 letters and digits"
        );
    }
    ensure!(
        loopback || options.token.is_some(),
        "--listen beyond the loopback address needs a --token"
    );
    std::fs::create_dir_all(&options.out)
        .with_context(|| format!("cannot create the output folder {}", options.out.display()))?;
    let mut notes = recorder::recover(&options.out);

    let listener =
        TcpListener::bind(options.listen).with_context(|| cannot_listen(options.listen))?;
    let address = listener.local_addr()?;
    let token = match options.token {
        Some(token) => token,
        None => Guard::random_token()?,
    };
    let link = format!("http://{address}/?token={token}");

    let (sender, events) = sync_channel(WAITING);
    let board = Arc::new(Board::default());
    let laboratory = match &options.source {
        SourceChoice::Laboratory(settings) => Some(*settings),
        _ => None,
    };
    let of_file = matches!(
        options.source,
        SourceChoice::Follow(_) | SourceChoice::Play(..)
    );
    if laboratory.is_none() && options.session.is_none() {
        notes.push(
            "no session states the amplifiers' gains: 1 N/V is taken for all (--session)"
                .to_owned(),
        );
    } else if of_file && options.entry.is_none() {
        notes.push(
            "the session has no such recording: gains are those of its [sensor], and gravity is taken not to turn in the sensor".to_owned(),
        );
    }
    let session = match (options.session, &laboratory) {
        (_, Some(settings)) => settings.session(),
        (Some(session), None) => session,
        (None, None) => source::settings::Settings {
            seed: 1,
            sample_rate_hz: 1000.0,
            trials_per_step: 1,
            engine: Engine::Rigid,
        }
        .session(),
    };
    let plan = match &laboratory {
        Some(settings) => Plan {
            session: session.clone(),
            entries: settings
                .day()
                .into_iter()
                .map(|(e, s)| (e, Some(s)))
                .collect(),
        },
        None => Plan::of_session(&session),
    };
    let channels = match (&options.entry, &options.calibration) {
        (
            Some(Entry {
                channels: Some(own),
                ..
            }),
            _,
        ) => own.clone(),
        (_, Some(calibration)) => calibration.channels.clone(),
        (_, None) => session.channels.clone(),
    };
    let begin = options.entry.map(|entry| Begin::of(&session, entry, None));

    let hello = serde_json::json!({ "hello": {
        "columns": columns::described(),
        "version": env!("CARGO_PKG_VERSION"),
        "laboratory": laboratory.is_some(),
        "file": options.calibration.is_some(),
        "out": options.out.display().to_string(),
        "wedges": sixaxis_reference::rig::run::WEDGES.map(|w| w.to_array()),
        "limb_length_m": session.sensor.geometry().limb_length_m,
        "half_edge_m": session.sensor.geometry().half_edge_m,
    }});
    board.post(Post::Hello, hello.to_string());
    let nothing = day::Outcome::recorded(&plan, &Default::default(), None);
    board.post(Post::Day, serde_json::json!({ "day": nothing }).to_string());

    let (jobs, to_do) = channel();
    let worker = Day::new(plan, &options.out);
    let to_acquisition = sender.clone();
    spawn("day", move || worker.run(&to_do, &to_acquisition))?;

    let (lab_sender, lab_commands) = sync_channel(LAB_COMMANDS);
    let setup = acquisition::Setup {
        out: options.out,
        session,
        channels: channels.clone(),
        calibration: options.calibration,
        laboratory: laboratory.is_some().then_some(lab_sender),
        day: jobs,
        tell: options.tell,
    };
    let to_source = sender.clone();
    let rate_hz = options.rate_hz;
    let mut input = None;
    match options.source {
        SourceChoice::Laboratory(settings) => {
            let live = LiveLaboratory::new(&settings);
            spawn("source", move || live.run(&lab_commands, &to_source))?;
        }
        SourceChoice::Port(address) => {
            ensure!(
                address.ip().is_loopback(),
                "samples are taken from the loopback address only"
            );
            let listener = TcpListener::bind(address).with_context(|| cannot_listen(address))?;
            input = Some(listener.local_addr()?);
            spawn("source", move || {
                source::stream::listen(&listener, &channels, &to_source)
            })?;
        }
        SourceChoice::StandardInput => {
            spawn("source", move || {
                source::stream::read(
                    &mut std::io::stdin().lock(),
                    "standard input",
                    None,
                    &channels,
                    &to_source,
                );
            })?;
        }
        SourceChoice::Follow(path) => {
            let follower = source::follow::Follower::open(&path, &channels, rate_hz)?;
            spawn("source", move || follower.run(&path, begin, &to_source))?;
        }
        SourceChoice::Play(path, speed) => {
            let player = source::play::Player::open(&path, &channels, rate_hz)?;
            spawn("source", move || player.run(speed, begin, &to_source))?;
        }
    }
    for note in notes {
        let _ = sender.send(Event::Note(note));
    }
    let of_thread = Arc::clone(&board);
    let acquisition = spawn("acquisition", move || {
        acquisition::run(&events, &of_thread, setup)
    })?;
    let of_thread = Arc::clone(&board);
    spawn("spectrum", move || spectrum::run(&of_thread))?;
    let server = Arc::new(Server::new(
        Guard::new(token, loopback),
        Arc::clone(&board),
        sender,
    ));
    spawn("server", move || server.serve(&listener))?;
    Ok(Panel {
        link,
        input,
        board,
        acquisition: Some(acquisition),
    })
}

fn spawn(name: &str, work: impl FnOnce() + Send + 'static) -> Result<std::thread::JoinHandle<()>> {
    let thread = Builder::new().name(name.to_owned()).spawn(work);
    thread.with_context(|| format!("cannot start the {name} thread"))
}

/// A port that another program has is the usual reason, and the remedy.
fn cannot_listen(address: SocketAddr) -> String {
    format!("cannot listen on {address}: another port may be free (--port, --tcp)")
}
