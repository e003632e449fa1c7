//! The directory facilitator: who offers which service.

use super::cast::Cast;
use crate::Mission;
use serde::{Deserialize, Serialize};
use soifra_graph::Name;

/// Services and who offers them, in order of registration.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Directory {
    services: Vec<(Name, Vec<u32>)>,
}

impl Directory {
    /// Everybody who offers a conversation at the start. What is offered to the planner is registered by
    /// messages.
    pub fn new(mission: &Mission, cast: &Cast) -> Self {
        let mut d = Directory::default();
        for (i, who) in cast.instances.iter().enumerate() {
            let offers = &mission.graph.agents[who.agent as usize].offers;
            for offer in offers.iter().filter(|o| o.unit.is_none()) {
                d.register(&offer.name, i as u32);
            }
        }
        d
    }

    /// Registers an agent for a service; once.
    pub fn register(&mut self, service: &Name, agent: u32) {
        match self.services.iter_mut().find(|(n, _)| n == service) {
            Some((_, agents)) if agents.contains(&agent) => {}
            Some((_, agents)) => agents.push(agent),
            None => self.services.push((service.clone(), vec![agent])),
        }
    }

    /// An agent offers nothing any more.
    pub fn deregister(&mut self, agent: u32) {
        for (_, agents) in &mut self.services {
            agents.retain(|a| *a != agent);
        }
    }

    /// An agent does not offer a service any more.
    pub fn withdraw(&mut self, service: &str, agent: u32) {
        for (_, agents) in self.services.iter_mut().filter(|(n, _)| **n == *service) {
            agents.retain(|a| *a != agent);
        }
    }

    /// Those who offer a service.
    pub fn search(&self, service: &str) -> impl Iterator<Item = u32> {
        let found = self.services.iter().find(|(n, _)| **n == *service);
        found.map(|(_, agents)| agents.as_slice()).unwrap_or_default().iter().copied()
    }

    /// Whether all are agents of a run with so many.
    pub fn fits(&self, instances: usize) -> bool {
        self.services.iter().flat_map(|(_, agents)| agents).all(|a| (*a as usize) < instances)
    }
}
