//! The schedule: which unit ran when on which core, from release to completion, and who used a device.

mod draw;
mod lane;
mod marks;
mod schedule;
mod window;

use super::{
    Drawing, Selection,
    page::{self, Ending},
};
use crate::trace_file::{Header, Reader, Trace, TraceError};
use lane::{Kind, Lane};
use schedule::Schedule;
use soifra_runtime::Time;
use std::{collections::BTreeMap, io::Read};

/// A schedule, ready to be drawn.
#[derive(Debug)]
pub struct Gantt {
    title: String,
    subtitle: String,
    groups: Vec<Group>,
    from: Time,
    to: Time,
    cut: usize,
}

/// Lanes of a core, or of what else a robot has.
#[derive(Debug)]
struct Group {
    heading: String,
    robot: usize,
    lanes: Vec<Lane>,
}

impl Gantt {
    /// The schedule of a trace in memory, of at most `limit` lanes.
    pub fn of(trace: &Trace, selection: &Selection, limit: usize) -> Gantt {
        let (mut schedule, mut ending) = (Schedule::new(selection), Ending::default());
        for record in &trace.records {
            ending.take(record);
            schedule.take(record);
        }
        Gantt::new(&trace.header, selection, schedule, &ending, trace.complete, limit)
    }

    /// The schedule of a trace of any length, which is read to its end with the memory of a chunk and of what
    /// is drawn.
    pub fn read<R: Read>(
        mut reader: Reader<R>,
        selection: &Selection,
        limit: usize,
    ) -> Result<Gantt, TraceError> {
        let (mut schedule, mut ending) = (Schedule::new(selection), Ending::default());
        for record in reader.by_ref() {
            let record = record?;
            ending.take(&record);
            schedule.take(&record);
        }
        Ok(Gantt::new(reader.header(), selection, schedule, &ending, reader.complete(), limit))
    }

    fn new(
        header: &Header,
        selection: &Selection,
        mut schedule: Schedule,
        ending: &Ending,
        complete: bool,
        limit: usize,
    ) -> Gantt {
        schedule.finish();
        let Schedule { window, lanes, .. } = schedule;
        let (from, to) = window.close(lanes.iter().filter_map(Lane::last).max().unwrap_or(ending.last));
        let (groups, cut) = group(header, lanes.into_iter().filter(Lane::is_shown), limit);
        let told = Selection { from: None, to: None, ..selection.clone() }.told();
        let what = if told.is_empty() { "schedule".into() } else { format!("schedule {told}") };
        Gantt {
            title: format!("{}: {what}", page::title(header)),
            subtitle: page::subtitle(header, ending, complete),
            groups,
            from,
            to,
            cut,
        }
    }

    /// The schedule as a picture.
    pub fn drawing(&self) -> Drawing {
        draw::draw(self)
    }

    fn lanes(&self) -> impl Iterator<Item = &Lane> {
        self.groups.iter().flat_map(|g| &g.lanes)
    }

    /// What is said of the lanes that were left out because there are more than the limit.
    pub fn rest(&self) -> Option<String> {
        match self.cut {
            0 => None,
            1 => Some("1 more lane is not drawn".into()),
            n => Some(format!("{n} more lanes are not drawn")),
        }
    }
}

/// Lanes by robot and core, and how many of them are beyond the limit. Robots are in order of first
/// appearance, and so are the lanes of a core.
fn group(header: &Header, lanes: impl Iterator<Item = Lane>, limit: usize) -> (Vec<Group>, usize) {
    let mut robots: Vec<u32> = Vec::new();
    let mut groups: BTreeMap<(usize, Kind, bool), Vec<Lane>> = BTreeMap::new();
    for lane in lanes {
        let place = robots.iter().position(|r| *r == lane.robot).unwrap_or_else(|| {
            robots.push(lane.robot);
            robots.len() - 1
        });
        groups.entry((place, lane.kind, !lane.ran)).or_default().push(lane);
    }
    let (mut room, mut cut, mut kept) = (limit, 0, Vec::new());
    for mut lanes in groups.into_values() {
        cut += lanes.len().saturating_sub(room);
        lanes.truncate(room);
        room -= lanes.len();
        if let Some(first) = lanes.first() {
            kept.push(Group { heading: heading(header, first), robot: first.robot as usize, lanes });
        }
    }
    (kept, cut)
}

/// Where the unit of a lane runs, or that it is a device.
fn heading(header: &Header, lane: &Lane) -> String {
    let robot = header.scene.robots.get(lane.robot as usize);
    let robot = robot.map_or_else(|| format!("robot number {}", lane.robot), |r| r.name.clone());
    match lane.kind {
        Kind::Core(core) => format!("{robot}, core {core}"),
        Kind::NoCore if lane.ran => format!("{robot}, no core"),
        Kind::NoCore => format!("{robot}, never ran"),
        Kind::Device => format!("{robot}, devices"),
    }
}
