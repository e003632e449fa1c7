//! Which part of a trace is drawn: of whom, of which conversations, from when to when.

use crate::trace_file::TraceError;
use soifra_graph::did_you_mean;
use soifra_runtime::{Event, Record, Time};
use std::collections::BTreeSet;

use super::axis::TimeUnit;

/// Part of a trace.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Selection {
    /// Agents: `courier` of every robot, or `courier@r1`. None are all.
    pub agents: Vec<String>,
    /// Conversations. None are all, and everything that belongs to none.
    pub conversations: Vec<Conversation>,
    /// When it begins.
    pub from: Option<Time>,
    /// When it ends.
    pub to: Option<Time>,
}

/// Which conversations.
#[derive(Debug, Clone, PartialEq)]
pub enum Conversation {
    /// The one of this identifier.
    Of(String),
    /// All whose identifier begins so.
    Beginning(String),
}

/// Why nothing can be selected.
#[derive(Debug)]
pub enum SelectError {
    /// The trace cannot be read.
    Trace(TraceError),
    /// The trace knows nothing of that name.
    Unknown {
        /// `agent` or `conversation`.
        what: &'static str,
        /// As it was asked for.
        name: String,
        /// What there is.
        hint: String,
    },
}

/// So many conversations are remembered, to name the nearest when one is unknown.
const REMEMBERED: usize = 4096;
/// So many names are listed.
const LISTED: usize = 8;

impl Selection {
    /// What is asked for by name, looked up in the records of a trace.
    pub fn find(
        records: impl Iterator<Item = Result<Record, TraceError>>,
        agents: &[String],
        conversations: &[String],
    ) -> Result<Selection, SelectError> {
        let mut known = BTreeSet::new();
        let mut ids = BTreeSet::new();
        // Whether the whole identifier was seen, and whether one that begins so.
        let mut seen = vec![(false, false); conversations.len()];
        for record in records {
            let event = record.map_err(SelectError::Trace)?.event;
            for agent in agents_of(&event).into_iter().flatten().filter(|a| !a.is_empty()) {
                if !known.contains(agent) {
                    known.insert(agent.to_string());
                }
            }
            if let Some(id) = conversation_of(&event) {
                for (asked, (whole, begins)) in conversations.iter().zip(&mut seen) {
                    *whole |= id == asked;
                    *begins |= id.starts_with(asked.as_str());
                }
                if ids.len() < REMEMBERED && !ids.contains(id) {
                    ids.insert(id.to_string());
                }
            }
        }
        let unknown = |what, name: &String, names: &BTreeSet<String>| {
            Err(SelectError::Unknown { what, name: name.clone(), hint: hint(what, name, names) })
        };
        if let Some(name) = agents.iter().find(|a| !known.iter().any(|k| is_agent(k, a))) {
            // The name of an agent without its robot may be meant too.
            known.extend(known.clone().iter().filter_map(|k| Some(k.split_once('@')?.0.to_string())));
            return unknown("agent", name, &known);
        }
        let mut selection = Selection { agents: agents.to_vec(), ..Selection::default() };
        for (asked, seen) in conversations.iter().zip(seen) {
            selection.conversations.push(match seen {
                (true, _) => Conversation::Of(asked.clone()),
                (false, true) => Conversation::Beginning(asked.clone()),
                (false, false) => return unknown("conversation", asked, &ids),
            });
        }
        Ok(selection)
    }

    /// Whether an agent is in it.
    pub(super) fn has_agent(&self, agent: &str) -> bool {
        self.agents.is_empty() || self.agents.iter().any(|a| is_agent(agent, a))
    }

    /// Whether something of a conversation, or of none, is in it.
    pub(super) fn has_conversation(&self, id: Option<&str>) -> bool {
        self.conversations.is_empty()
            || id.is_some_and(|id| {
                self.conversations.iter().any(|c| match c {
                    Conversation::Of(c) => c == id,
                    Conversation::Beginning(c) => id.starts_with(c.as_str()),
                })
            })
    }

    /// Whether an instant is in it.
    pub(super) fn has_time(&self, t: Time) -> bool {
        self.from.is_none_or(|from| t >= from) && self.to.is_none_or(|to| t <= to)
    }

    /// What was asked for, in words; nothing when everything is in it.
    pub(super) fn told(&self) -> String {
        let mut parts = Vec::new();
        if !self.agents.is_empty() {
            parts.push(format!("of {}", self.agents.join(", ")));
        }
        if !self.conversations.is_empty() {
            let names = self.conversations.iter().map(|c| match c {
                Conversation::Of(id) => id.clone(),
                Conversation::Beginning(id) => format!("{id}…"),
            });
            parts.push(format!("conversation {}", names.collect::<Vec<_>>().join(", ")));
        }
        for (word, t) in [("from", self.from), ("to", self.to)] {
            parts.extend(t.map(|t| format!("{word} {}", TimeUnit::of(t).exact(t))));
        }
        parts.join(", ")
    }
}

/// Whether an agent is what `asked` names, with or without its robot.
fn is_agent(agent: &str, asked: &str) -> bool {
    agent == asked || agent.split_once('@').is_some_and(|(name, _)| name == asked)
}

fn hint(what: &str, name: &str, names: &BTreeSet<String>) -> String {
    if let Some(near) = did_you_mean(name, names.iter().map(String::as_str)) {
        return format!("did you mean `{near}`?");
    }
    let listed: Vec<&str> = names.iter().take(LISTED).map(String::as_str).collect();
    match names.len() {
        0 => format!("there is no {what} in this trace"),
        n if n > LISTED => format!("there are {}, …", listed.join(", ")),
        _ => format!("there are {}", listed.join(", ")),
    }
}

/// The agents that an event tells of.
fn agents_of(event: &Event) -> [Option<&str>; 2] {
    match event {
        Event::Acl { sender, receiver, .. } => [Some(sender), Some(receiver)],
        Event::Switch { agent, .. } => [agent.as_deref(), None],
        Event::Activation { agent, .. }
        | Event::Deferral { agent, .. }
        | Event::Completion { agent, .. }
        | Event::Miss { agent, .. }
        | Event::Rule { agent, .. }
        | Event::Transition { agent, .. }
        | Event::Node { agent, .. }
        | Event::State { agent, .. }
        | Event::Message { agent, .. }
        | Event::Conversation { agent, .. }
        | Event::Service { agent, .. }
        | Event::Life { agent, .. }
        | Event::Device { agent, .. }
        | Event::Delivery { agent, .. }
        | Event::Param { agent, .. }
        | Event::Note { agent, .. } => [Some(agent), None],
        _ => [None, None],
    }
}

fn conversation_of(event: &Event) -> Option<&str> {
    match event {
        Event::Acl { thread, .. } => thread.conversation_id.as_deref(),
        Event::Conversation { conversation_id, .. } => Some(conversation_id),
        _ => None,
    }
}
