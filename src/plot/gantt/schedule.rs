//! Who ran when, gathered from the records.

use super::{
    lane::{Kind, Lane},
    window::Window,
};
use crate::plot::Selection;
use soifra_runtime::{Event, Record, Time};
use std::collections::BTreeMap;

/// What a lane belongs to: robot, agent, and the name of a unit or device.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
enum Key {
    Unit(u32, String, String),
    Device(u32, String, String),
}

/// The lanes of a schedule, while records come in.
#[derive(Debug)]
pub(super) struct Schedule<'s> {
    selection: &'s Selection,
    pub window: Window,
    /// In order of first appearance.
    pub lanes: Vec<Lane>,
    index: BTreeMap<Key, usize>,
    /// Lane of the unit that a core runs, and since when.
    cores: BTreeMap<(u32, u32), (usize, Time)>,
    /// Who uses a device, and since when; by lane.
    devices: BTreeMap<usize, (String, Time)>,
    /// Time of the last record.
    last: Time,
}

impl<'s> Schedule<'s> {
    pub(super) fn new(selection: &'s Selection) -> Self {
        Schedule {
            selection,
            window: Window::new(selection.from, selection.to),
            lanes: Vec::new(),
            index: BTreeMap::new(),
            cores: BTreeMap::new(),
            devices: BTreeMap::new(),
            last: Time::ZERO,
        }
    }

    /// Takes the next record.
    pub(super) fn take(&mut self, record: &Record) {
        let t = record.t;
        self.last = t;
        match &record.event {
            Event::Switch { robot, core, agent, unit } => {
                self.stop(*robot, *core, t);
                let (Some(agent), Some(unit)) = (agent, unit) else { return };
                if let Some(i) = self.unit(*robot, agent, unit) {
                    self.lanes[i].ran = true;
                    if self.lanes[i].kind == Kind::NoCore {
                        self.lanes[i].kind = Kind::Core(*core);
                    }
                    self.cores.insert((*robot, *core), (i, t));
                }
            }
            Event::Activation { robot, agent, unit, release, start, finish, skipped } => {
                self.activation(*robot, agent, unit, [*release, *start], *finish, skipped.is_some());
            }
            Event::Completion { robot, agent, unit, release, .. } => {
                if let Some(i) = self.unit(*robot, agent, unit) {
                    self.lanes[i].complete(&mut self.window, *release, t);
                }
            }
            Event::Miss { robot, agent, unit, release, deadline } => {
                if let Some(i) = self.unit(*robot, agent, unit) {
                    self.lanes[i].miss(&mut self.window, *release, *deadline);
                }
            }
            Event::Deferral { robot, agent, unit, until } => {
                if let Some(i) = self.unit(*robot, agent, unit) {
                    self.lanes[i].defer(&mut self.window, t, *until);
                }
            }
            Event::Device { robot, agent, device, unit, waiting } => {
                let key = Key::Device(*robot, agent.clone(), device.clone());
                if let Some(i) = self.lane(key, Kind::Device) {
                    self.lanes[i].ran = true;
                    self.used(i, unit.as_deref(), t);
                    self.lanes[i].queue(&mut self.window, t, *waiting);
                }
            }
            _ => {}
        }
    }

    fn activation(
        &mut self,
        robot: u32,
        agent: &str,
        unit: &str,
        [release, start]: [Time; 2],
        finish: Option<Time>,
        skipped: bool,
    ) {
        // Most units take no time: they have no lane.
        let takes = !skipped && finish.is_none_or(|f| f > start);
        let i = if takes { self.unit(robot, agent, unit) } else { self.known(robot, agent, unit) };
        let Some(lane) = i.and_then(|i| self.lanes.get_mut(i)) else { return };
        match finish {
            _ if skipped => lane.skip(&mut self.window, release),
            Some(finish) if takes => {
                lane.bar(&mut self.window, start, finish, "");
                lane.complete(&mut self.window, release, finish);
            }
            Some(_) => {}
            None => {
                lane.ran = true;
                lane.release(&mut self.window, release);
                lane.open = Some(release);
            }
        }
    }

    /// A core stops running what it ran.
    fn stop(&mut self, robot: u32, core: u32, t: Time) {
        if let Some((i, since)) = self.cores.remove(&(robot, core)) {
            self.lanes[i].bar(&mut self.window, since, t, "");
        }
    }

    /// A device is used by a unit from now on, or by none.
    fn used(&mut self, lane: usize, unit: Option<&str>, t: Time) {
        if let Some((user, since)) = self.devices.remove(&lane) {
            if unit == Some(user.as_str()) {
                self.devices.insert(lane, (user, since));
                return;
            }
            self.lanes[lane].bar(&mut self.window, since, t, &user);
        }
        if let Some(unit) = unit {
            self.devices.insert(lane, (unit.to_string(), t));
        }
    }

    /// What is still running ran until the last record.
    pub(super) fn finish(&mut self) {
        let last = self.last;
        for (i, since) in std::mem::take(&mut self.cores).into_values() {
            self.lanes[i].bar(&mut self.window, since, last, "");
        }
        for (i, (user, since)) in std::mem::take(&mut self.devices) {
            self.lanes[i].bar(&mut self.window, since, last, &user);
        }
        for lane in &mut self.lanes {
            if let Some(release) = lane.open.take() {
                lane.wait(&mut self.window, release, last);
            }
        }
    }

    /// The lane of a unit, if it has one.
    fn known(&self, robot: u32, agent: &str, unit: &str) -> Option<usize> {
        self.index.get(&Key::Unit(robot, agent.into(), unit.into())).copied()
    }

    /// The lane of a unit, unless its agent is not wanted.
    fn unit(&mut self, robot: u32, agent: &str, unit: &str) -> Option<usize> {
        self.lane(Key::Unit(robot, agent.into(), unit.into()), Kind::NoCore)
    }

    fn lane(&mut self, key: Key, kind: Kind) -> Option<usize> {
        if let Some(i) = self.index.get(&key) {
            return Some(*i);
        }
        let (Key::Unit(robot, agent, name) | Key::Device(robot, agent, name)) = &key;
        if !self.selection.has_agent(agent) {
            return None;
        }
        let name = format!("{}.{name}", agent.split('@').next().unwrap_or_default());
        self.lanes.push(Lane { robot: *robot, name, kind, ..Lane::default() });
        self.index.insert(key, self.lanes.len() - 1);
        Some(self.lanes.len() - 1)
    }
}
