//! The memory of a process, where the system tells it (Linux).
#![allow(dead_code, reason = "every bench uses a part of it")]

use std::{
    io::Read,
    process::{Command, Stdio},
};

/// Runs a program and returns its greatest resident set in MB. It must write more to its standard output than
/// a pipe holds: so it is still there, held up in its last act, when it is asked.
pub fn peak(program: &str, arguments: &[&str]) -> Option<f64> {
    let mut child = Command::new(program).args(arguments).stdout(Stdio::piped()).spawn().ok()?;
    let mut output = child.stdout.take()?;
    let status = format!("/proc/{}/status", child.id());
    let (mut most, mut chunk) = (None, [0; 4096]);
    while output.read(&mut chunk).is_ok_and(|n| n > 0) {
        let now = std::fs::read_to_string(&status).ok().and_then(|s| megabytes(&s, "VmHWM:"));
        most = now.or(most);
    }
    let ended = child.wait().ok()?;
    assert!(ended.success(), "{program} {arguments:?}: {ended}");
    most
}

/// The resident set of this process in MB.
pub fn resident() -> Option<f64> {
    megabytes(&std::fs::read_to_string("/proc/self/status").ok()?, "VmRSS:")
}

/// Of the lines of the system's file on a process.
fn megabytes(status: &str, key: &str) -> Option<f64> {
    let line = status.lines().find_map(|l| l.strip_prefix(key))?;
    let kilobytes: f64 = line.split_whitespace().next()?.parse().ok()?;
    Some(kilobytes / 1000.0)
}
