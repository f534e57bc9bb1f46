//! The program under test, and a place for what it writes.

use std::io::Write;
use std::ops::Deref;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

use sixaxis_reference::laboratory::session::SimulatedSession;
use sixaxis_reference::laboratory::write::write;

/// The program, with nothing to read.
pub fn sixaxis() -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_sixaxis"));
    command.stdin(Stdio::null());
    command
}

pub fn run(arguments: &[&str]) -> Output {
    sixaxis()
        .args(arguments)
        .output()
        .expect("the program starts")
}

/// Runs and expects success.
pub fn done(arguments: &[&str]) -> Output {
    let output = run(arguments);
    assert!(
        output.status.success(),
        "{arguments:?}: {}",
        stderr(&output)
    );
    output
}

/// A day that the rigid engine simulates with these options, in a folder of its own, and what the command says of it.
pub fn simulated(name: &str, options: &str) -> (Folder, String) {
    let folder = Folder::new(name);
    let mut arguments = vec!["simulate", "--engine", "rigid", "--out", text(&folder)];
    arguments.extend(options.split_whitespace());
    let said = stdout(&done(&arguments));
    (folder, said)
}

/// The gains of a simulated tumble, from what the command says of the day.
pub fn gains(said: &str) -> String {
    let gains = said.split("--gain ").nth(1).expect("says how to go on");
    gains.split_whitespace().next().expect("gains").to_owned()
}

/// Runs with a text on standard input.
pub fn fed(arguments: &[&str], input: &str) -> Output {
    let mut child = sixaxis()
        .args(arguments)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the program starts");
    let mut pipe = child.stdin.take().expect("a pipe");
    std::thread::scope(|scope| {
        // A program that refuses its input does not read it to the end.
        scope.spawn(move || drop(pipe.write_all(input.as_bytes())));
        child.wait_with_output().expect("the program ends")
    })
}

pub fn code(output: &Output) -> i32 {
    output.status.code().expect("no signal ended it")
}

pub fn stdout(output: &Output) -> String {
    String::from_utf8(output.stdout.clone()).expect("UTF-8")
}

pub fn stderr(output: &Output) -> String {
    String::from_utf8(output.stderr.clone()).expect("UTF-8")
}

pub fn text(path: &Path) -> &str {
    path.to_str().expect("a path in UTF-8")
}

/// A folder of one test's own, empty at first and gone when the test is over.
pub struct Folder(PathBuf);

impl Folder {
    pub fn new(name: &str) -> Self {
        let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
        let _ = std::fs::remove_dir_all(&path);
        std::fs::create_dir_all(&path).expect("a folder can be made");
        Self(path)
    }

    /// Path of a file in it, as an argument.
    pub fn file(&self, name: &str) -> String {
        text(&self.join(name)).to_owned()
    }

    /// Writes a file and returns its path as an argument.
    pub fn write(&self, name: &str, bytes: impl AsRef<[u8]>) -> String {
        std::fs::write(self.join(name), bytes).expect("it can be written");
        self.file(name)
    }
}

impl Deref for Folder {
    type Target = Path;

    fn deref(&self) -> &Path {
        &self.0
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

/// A played session on disk; its path is that of the session file.
pub struct Session {
    file: PathBuf,
    _folder: Folder,
}

impl Session {
    pub fn write(folder: &str, played: &SimulatedSession) -> Self {
        let folder = Folder::new(folder);
        let file = write(played, &folder, "npz").expect("a session is written");
        Self {
            file,
            _folder: folder,
        }
    }
}

impl Deref for Session {
    type Target = Path;

    fn deref(&self) -> &Path {
        &self.file
    }
}
