//! Missions and the platforms on which they work.

use super::{Refusal, table::table as lines};
use crate::files;
use serde::Serialize;
use soifra_graph::{Diagnostic, Severity};
use soifra_lang::CheckOptions;

/// A mission on a platform.
#[derive(Debug, Clone, Serialize)]
pub struct Cell {
    /// Mission.
    pub mission: String,
    /// Platform of every robot.
    pub platform: String,
    /// Whether it passes every check there.
    pub sound: bool,
    /// What stands against it: code and title.
    pub reasons: Vec<Reason>,
}

/// Why a mission does not work on a platform.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Reason {
    /// Code.
    pub code: &'static str,
    /// Title.
    pub title: String,
}

/// Every mission of a source on every platform that is known there. Nothing for a graph file, which is bound
/// to its platforms, and for a source without a mission.
pub fn cells(path: &str) -> Result<Vec<Cell>, Refusal> {
    if crate::graph_file::is_graph(path) {
        return Ok(Vec::new());
    }
    let text = files::read_text(path)?;
    let check = |options: &CheckOptions| soifra_lang::check(path, &text, &mut files::Loader, options);
    let all = check(&CheckOptions::default());
    let mut out = Vec::new();
    for mission in &all.missions {
        for platform in &all.platforms {
            let (mission, platform) = (mission.clone(), platform.clone());
            let options = CheckOptions {
                platform: Some(platform.clone()),
                mission: Some(mission.clone()),
                ..CheckOptions::default()
            };
            let found = check(&options).diagnostics;
            let errors = found.into_iter().filter(|d| d.severity == Severity::Error);
            let mut reasons: Vec<Reason> = errors.map(reason).collect();
            reasons.dedup();
            out.push(Cell { mission, platform, sound: reasons.is_empty(), reasons });
        }
    }
    Ok(out)
}

fn reason(d: Diagnostic) -> Reason {
    Reason { code: d.code, title: d.title }
}

/// The cells for people: a table, then the reasons.
pub fn table(cells: &[Cell]) -> String {
    let mut platforms: Vec<&str> = Vec::new();
    let mut missions: Vec<&str> = Vec::new();
    for c in cells {
        if !platforms.contains(&c.platform.as_str()) {
            platforms.push(&c.platform);
        }
        if !missions.contains(&c.mission.as_str()) {
            missions.push(&c.mission);
        }
    }
    if missions.is_empty() {
        return String::new();
    }
    let on = |mission: &str, platform: &str| {
        let cell = cells.iter().find(|c| c.mission == mission && c.platform == platform);
        cell.map_or("", |c| if c.sound { "yes" } else { "no" }).to_string()
    };
    let row = |mission: &&str| {
        std::iter::once((*mission).to_string()).chain(platforms.iter().map(|p| on(mission, p))).collect()
    };
    let header: Vec<&str> = std::iter::once("mission").chain(platforms.iter().copied()).collect();
    let rows: Vec<Vec<String>> = missions.iter().map(row).collect();
    let mut out = lines(&header, &rows);
    for c in cells.iter().filter(|c| !c.sound) {
        out += &format!("  {} on {}:\n", c.mission, c.platform);
        for r in &c.reasons {
            out += &format!("    {} {}\n", r.code, r.title);
        }
    }
    out
}
