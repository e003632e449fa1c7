//! Devices: so many uses at a time, others wait, first come, first served.
//!
//! What a unit sends after `use` is sent when the use is over. How long a use takes is known when the unit
//! evaluates its statements; how long it waits is not.

use super::{
    Engine,
    commit::put_off,
    log::{Item, Log},
    queue::Scheduled,
};
use crate::{Event, Time};
use serde::{Deserialize, Serialize};
use std::collections::VecDeque;

/// A use of a device.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(crate) struct DeviceUse {
    pub unit: u32,
    pub time: Time,
    /// What is sent afterwards.
    pub log: Log,
    pub record: Option<u64>,
}

/// A device.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub(crate) struct DeviceState {
    in_use: u32,
    waiting: VecDeque<DeviceUse>,
}

/// The most uses that wait for a device; what comes then is not done, and the trace says so.
const MOST_WAITING: usize = 65_536;

impl DeviceState {
    /// Whether it can be the state of a device of a run with so many units.
    pub fn fits(&self, units: usize) -> bool {
        self.waiting.iter().all(|u| u.fits(units))
    }
}

impl DeviceUse {
    /// Whether it can be a use in a run with so many units.
    pub fn fits(&self, units: usize) -> bool {
        (self.unit as usize) < units && self.log.items.iter().all(Item::is_output)
    }
}

impl Engine<'_> {
    /// Applies items of an activation in order. What leaves the agent after a use of a device waits for that.
    pub(super) fn apply_all(&mut self, unit: u32, items: &[Item], log: &Log, record: Option<u64>) {
        for (i, item) in items.iter().enumerate() {
            let Item::Use { device, seconds } = item else {
                self.apply(unit, item, log, record);
                continue;
            };
            let mut later = Log::default();
            for item in &items[i + 1..] {
                if item.is_output() {
                    put_off(item, log, &mut later);
                } else {
                    self.apply(unit, item, log, record);
                }
            }
            let time = Time::from_seconds(seconds.max(0.0)).unwrap_or(Time::ZERO);
            self.ask_device(*device, DeviceUse { unit, time, log: later, record });
            return;
        }
    }

    /// A unit asks for a device of its agent.
    fn ask_device(&mut self, device: u32, wanted: DeviceUse) {
        let instance = self.cast.units[wanted.unit as usize].instance;
        let at = self.cast.instances[instance as usize].devices + device;
        let Some(info) = self.cast.devices.get(at as usize).copied().filter(|d| d.instance == instance)
        else {
            return;
        };
        let state = &mut self.devices[at as usize];
        if state.in_use < info.capacity {
            self.occupy(at, wanted);
        } else if state.waiting.len() < MOST_WAITING {
            let unit = wanted.unit;
            state.waiting.push_back(wanted);
            self.trace_device(at, Some(unit));
        } else {
            let robot = self.cast.instances[instance as usize].robot;
            let agent = self.agent_name(instance);
            let text = format!("more than {MOST_WAITING} uses wait for a device");
            self.recorder.record(self.now, wanted.record, || Event::Fault {
                robot: Some(robot),
                agent,
                text,
            });
        }
    }

    fn occupy(&mut self, device: u32, by: DeviceUse) {
        self.devices[device as usize].in_use += 1;
        let (at, unit) = (self.now + by.time, by.unit);
        self.queue.put(at, Scheduled::DeviceFree { device, by });
        self.trace_device(device, Some(unit));
    }

    /// A use is over: what follows is sent, and the next begins.
    pub(super) fn device_free(&mut self, device: u32, by: DeviceUse) {
        let Some(state) = self.devices.get_mut(device as usize) else { return };
        state.in_use = state.in_use.saturating_sub(1);
        match state.waiting.pop_front() {
            Some(next) => self.occupy(device, next),
            None => self.trace_device(device, None),
        }
        self.apply_all(by.unit, &by.log.items, &by.log, by.record);
    }

    /// Who has come to a device, begun to use it, or left it; and how many wait.
    fn trace_device(&mut self, device: u32, unit: Option<u32>) {
        if !self.recorder.on() {
            return;
        }
        let info = self.cast.devices[device as usize];
        let who = self.cast.instances[info.instance as usize];
        let named = &self.mission.graph.agents[who.agent as usize].devices;
        let name =
            named.get((device - who.devices) as usize).map_or_else(String::new, |d| d.name.to_string());
        let waiting = self.devices[device as usize].waiting.len() as u32;
        let unit = unit.map(|u| self.names(u).1);
        let (robot, agent) = (who.robot, self.agent_name(info.instance));
        let event = Event::Device { robot, agent, device: name, unit, waiting };
        self.recorder.record(self.now, None, || event);
    }
}
