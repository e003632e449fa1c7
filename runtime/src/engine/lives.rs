//! Who is alive. Units of a dead agent are not released, and what is sent to it is dropped.

use super::{Engine, cast::Cast};
use crate::Event;
use serde::{Deserialize, Serialize};

/// Which agents are dead, by instance.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
pub(crate) struct Lives(Vec<bool>);

impl Lives {
    /// Everybody lives.
    pub fn new(cast: &Cast) -> Self {
        Lives(vec![false; cast.instances.len()])
    }

    /// Whether these are lives of as many agents.
    pub fn fits(&self, other: &Lives) -> bool {
        self.0.len() == other.0.len()
    }
}

impl Engine<'_> {
    /// Whether the agent of a unit is dead.
    pub(super) fn is_dead(&self, unit: u32) -> bool {
        let instance = self.cast.units[unit as usize].instance;
        self.lives.0.get(instance as usize).is_some_and(|dead| *dead)
    }

    /// An agent dies: what it was about to do at this instant is not done any more.
    pub(super) fn kill(&mut self, instance: u32, why: &str, cause: Option<u64>) {
        let (Some(dead), Some(&who)) =
            (self.lives.0.get_mut(instance as usize), self.cast.instances.get(instance as usize))
        else {
            return;
        };
        if std::mem::replace(dead, true) {
            return;
        }
        let units = &self.cast.units;
        self.releases.retain(|r| units[r.unit as usize].instance != instance);
        let agent = &self.mission.graph.agents[who.agent as usize].name;
        let robot = &self.scene.robots[who.robot as usize].name;
        self.recorder.record(self.now, cause, || Event::Life {
            robot: who.robot,
            agent: format!("{agent}@{robot}"),
            status: "dead".into(),
            reason: why.to_string(),
        });
    }
}
