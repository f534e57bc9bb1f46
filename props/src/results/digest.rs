//! Digests of source code and of results, so that nobody takes the figures of other code for its own. 64-bit FNV-1a hashes: they
//! find changes that happen, not forgeries.

use std::io;
use std::path::{Path, PathBuf};

/// Offset and prime of the 64-bit FNV-1a hash.
const OFFSET: u64 = 0xcbf2_9ce4_8422_2325;
const PRIME: u64 = 0x0000_0100_0000_01b3;

/// The hash of some bytes, 16 hexadecimal digits.
pub fn of_bytes(bytes: impl IntoIterator<Item = u8>) -> String {
    let hash = bytes.into_iter().fold(OFFSET, |hash, byte| {
        (hash ^ u64::from(byte)).wrapping_mul(PRIME)
    });
    format!("{hash:016x}")
}

/// Digest of the Rust files below a folder, or of one file, of the workspace at `root`: their paths and texts in the order of the
/// paths. Empty lines and lines that are a comment do not count: they change no figure.
///
/// # Errors
/// If a source cannot be read.
pub fn of_sources(root: &Path, source: &str) -> io::Result<String> {
    Ok(digest(files(&root.join(source))?))
}

/// Names, within the folder, and texts of the Rust files below it; of one file, if it is one.
fn files(folder: &Path) -> io::Result<Vec<(String, String)>> {
    let mut paths = Vec::new();
    if folder.is_file() {
        paths.push(folder.to_owned());
    } else {
        sources(folder, &mut paths)?;
    }
    paths
        .iter()
        .map(|path| {
            let inside = path.strip_prefix(folder).unwrap_or(path);
            let name: Vec<_> = inside.iter().map(|part| part.to_string_lossy()).collect();
            Ok((name.join("/"), std::fs::read_to_string(path)?))
        })
        .collect()
}

/// All Rust files below a folder.
fn sources(folder: &Path, found: &mut Vec<PathBuf>) -> io::Result<()> {
    for entry in std::fs::read_dir(folder)? {
        let path = entry?.path();
        if path.is_dir() {
            sources(&path, found)?;
        } else if path.extension().is_some_and(|e| e == "rs") {
            found.push(path);
        }
    }
    Ok(())
}

/// Of names and texts, in whatever order they come.
fn digest(mut files: Vec<(String, String)>) -> String {
    files.sort();
    let code = files.iter().flat_map(|(name, text)| {
        let lines = text.lines().map(str::trim_end);
        let code = lines.filter(|line| !line.is_empty() && !line.trim_start().starts_with("//"));
        std::iter::once(&name[..]).chain(code)
    });
    of_bytes(code.flat_map(|line| line.bytes().chain([b'\n'])))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(files: &[(&str, &str)]) -> String {
        let owned = |(name, text): &(&str, &str)| ((*name).to_owned(), (*text).to_owned());
        digest(files.iter().map(owned).collect())
    }

    #[test]
    fn code_counts_and_comments_do_not() {
        let two = [
            ("a.rs", "let x = 1;\n"),
            ("b/c.rs", "// Why.\nlet y = 2;\n"),
        ];
        let known = of(&two);
        assert_eq!(known, of(&[two[1], two[0]]), "order");
        assert_eq!(
            known,
            of(&[two[0], ("b/c.rs", "let y = 2;\n\n/// What.\n")])
        );
        for other in [
            [("a.rs", "let x = 3;\n"), two[1]],
            [("d.rs", two[0].1), two[1]],
            [two[0], ("b/c.rs", "    let y = 2;\n")],
            [("a.rs", ""), ("b/c.rs", "let x = 1;\nlet y = 2;\n")],
        ] {
            assert_ne!(known, of(&other), "{other:?}");
        }
        // The hash itself: FNV-1a of "a\n".
        let by_hand = (OFFSET ^ 0x61).wrapping_mul(PRIME) ^ 0x0a;
        let by_hand = by_hand.wrapping_mul(PRIME);
        assert_eq!(of(&[("a", "")]), format!("{by_hand:016x}"));
    }
}
