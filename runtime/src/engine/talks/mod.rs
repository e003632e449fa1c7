//! Conversations: who talks with whom, where each side's copy of the protocol stands, and what comes too late.
//!
//! The protocol is kept for the agents: a message that it does not have in the sender's state is not sent, one
//! that it does not have in the receiver's state is not handed over and answered with `not_understood`. A side
//! that waits longer than the protocol says goes where the time-out leads; what comes after that is dropped.

mod arrive;
mod part;

use super::{Engine, log::Opened, queue::Scheduled, troubles::Route};
use crate::{Event, Thread, Time, mission::code::TalkCode, seed::chance};
use serde::{Deserialize, Serialize};
use soifra_graph::{Name, Role};
use std::collections::BTreeMap;

/// A conversation between two agents.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct Branch {
    /// Index of the declaration.
    conversation: u32,
    /// As in messages: all that one message opened have the same. Empty without a trace.
    id: String,
    /// Those that were opened together.
    group: u64,
    /// Instances: initiator, participant.
    peers: [u32; 2],
    /// State of each side's copy.
    states: [u32; 2],
    /// Counts the states a side has been in, so that an old time-out is told from a new one.
    entries: [u32; 2],
    /// Messages of each side so far.
    said: [u32; 2],
    /// Number of the last message that reached each side, among those of the other; 0 before the first.
    heard: [u32; 2],
    /// Messages that have not arrived yet.
    under_way: u32,
    /// Sides whose agent has died.
    gone: [bool; 2],
}

/// What was opened with one message.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
struct Group {
    /// How many have not answered yet.
    waiting: u32,
    /// State that the initiator waits in.
    state: u32,
}

/// All conversations that go on.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub(crate) struct Talks {
    branches: BTreeMap<u64, Branch>,
    groups: BTreeMap<u64, Group>,
    next: u64,
    /// How many conversations each instance has opened.
    opened: BTreeMap<u32, u32>,
}

/// A message of a conversation under way.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) struct Utterance {
    pub branch: u64,
    /// Who said it.
    pub by: Role,
    pub performative: Name,
    /// Its number among those of who said it: what an answer refers to.
    said: u32,
    pub registers: Vec<f64>,
    /// Its record.
    pub record: u64,
    /// A fault has made its content unreadable.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub unreadable: bool,
}

/// What is said.
struct Speech<'s> {
    performative: &'s Name,
    registers: &'s [f64],
    /// Why, in words.
    reason: Option<&'s str>,
    /// How long to wait for an answer, in place of what the protocol says.
    limit: Option<Time>,
    cause: Option<u64>,
}

impl Talks {
    /// Whether these can be conversations of a mission with so many instances and declarations.
    pub fn fits(&self, instances: usize, states: &[usize]) -> bool {
        self.branches.values().all(|b| {
            let known = states.get(b.conversation as usize);
            b.peers.iter().all(|p| (*p as usize) < instances)
                && known.is_some_and(|n| b.states.iter().all(|s| (*s as usize) < *n))
        })
    }
}

impl Engine<'_> {
    /// Opens a conversation with each of some agents.
    pub(super) fn open_talk(
        &mut self,
        unit: u32,
        opened: &Opened,
        registers: &[f64],
        to: &[f64],
        cause: Option<u64>,
    ) {
        let (conversation, performative) = (opened.conversation, &opened.performative);
        let sender = self.cast.units[unit as usize].instance;
        let Some(c) = self.mission.graph.conversations.get(conversation as usize) else { return };
        let opening = c.states.first().and_then(|s| s.move_of(Role::Initiator, performative));
        let Some(target) = opening.map(|m| m.target) else { return };
        let count = self.talks.opened.entry(sender).or_default();
        *count += 1;
        let count = *count;
        // Only the trace says it.
        let id = match self.recorder.on() {
            true => format!("{}/{}/{count}", c.name, self.agent_name(sender)),
            false => String::new(),
        };
        let group = self.talks.next;
        let mut waiting = 0;
        for n in to {
            let peer = *n as u32;
            if *n < 0.0 || peer as usize >= self.cast.instances.len() || peer == sender {
                continue;
            }
            let branch = self.talks.next;
            self.talks.next += 1;
            waiting += 1;
            self.talks.branches.insert(
                branch,
                Branch {
                    conversation,
                    id: id.clone(),
                    group,
                    peers: [sender, peer],
                    states: [0, 0],
                    entries: [0, 0],
                    said: [0, 0],
                    heard: [0, 0],
                    under_way: 0,
                    gone: [false, false],
                },
            );
            let limit = opened.within.and_then(Time::from_seconds);
            let speech = Speech { performative, registers, reason: None, limit, cause };
            self.utter(branch, Role::Initiator, target, &speech);
        }
        if waiting > 0 && !c.states[target as usize].is_final() {
            self.talks.groups.insert(group, Group { waiting, state: target });
        } else {
            // Nobody was asked, or for nothing: everybody has answered.
            self.release_talk(sender, conversation, None, sender, &TalkCode::Settled, cause);
        }
    }

    /// Says something in a conversation that is going on.
    pub(super) fn reply_talk(
        &mut self,
        unit: u32,
        thread: f64,
        performative: &Name,
        reason: Option<&str>,
        registers: &[f64],
        cause: Option<u64>,
    ) {
        let me = self.cast.units[unit as usize].instance;
        let number = thread as u64;
        let side = self.talks.branches.get(&number).and_then(|b| {
            let at = b.peers.iter().position(|p| *p == me)?;
            Some(if at == 0 { Role::Initiator } else { Role::Participant })
        });
        let Some(side) = side else {
            self.unsaid(me, performative, "the conversation is over", cause);
            return;
        };
        let branch = &self.talks.branches[&number];
        let c = &self.mission.graph.conversations[branch.conversation as usize];
        let state = &c.states[branch.states[side.index()] as usize];
        match state.move_of(side, performative) {
            Some(m) => {
                let target = m.target;
                let speech = Speech { performative, registers, reason, limit: None, cause };
                self.utter(number, side, target, &speech);
            }
            None => {
                let why = match state.is_final() {
                    true => "the conversation is over".to_string(),
                    false => format!("{} does not say that in state {}", role(side), state.name),
                };
                self.unsaid(me, performative, &why, cause);
            }
        }
    }

    /// A message that is not sent.
    fn unsaid(&mut self, instance: u32, performative: &str, why: &str, cause: Option<u64>) {
        if self.recorder.on() {
            let robot = self.cast.instances[instance as usize].robot;
            let (agent, topic) = (self.agent_name(instance), performative.to_string());
            let message = cause.unwrap_or(0);
            let dropped = Some(format!("not sent: {why}"));
            let event = Event::Delivery { robot, agent, topic, message, dropped };
            self.recorder.record(self.now, cause, || event);
        }
    }

    /// Sends a message; the sender's copy goes on at once.
    fn utter(&mut self, number: u64, by: Role, target: u32, speech: &Speech<'_>) {
        let Speech { performative, registers, reason, limit, cause } = *speech;
        let Some(b) = self.talks.branches.get_mut(&number) else { return };
        let c = &self.mission.graph.conversations[b.conversation as usize];
        b.said[by.index()] += 1;
        let said = b.said[by.index()];
        let (conversation, peers) = (b.conversation, b.peers);
        let channel = &self.channels[conversation as usize];
        let (delay, loss) = (channel.delay, channel.loss);
        let after = limit.or(channel.timeouts.get(target as usize).copied().flatten());
        let holds = c.states[target as usize].holds_timeout(by);
        let reply_by = after.filter(|_| holds).map(|t| self.now + t);
        let from = peers[by.index()];
        let to = peers[by.other().index()];
        let record = if self.recorder.on() {
            let content = c.states.iter().flat_map(|s| &s.moves).find(|m| m.performative == *performative);
            let content = content.and_then(|m| m.content.as_ref()).map(|n| n.to_string());
            let heard = b.heard[by.index()];
            let thread = Thread {
                conversation_id: Some(b.id.clone()),
                protocol: Some(c.protocol.to_string()),
                ontology: Some(c.ontology.to_string()),
                reply_with: Some(mark(number, by, said)),
                in_reply_to: (heard > 0).then(|| mark(number, by.other(), heard)),
                reply_by,
            };
            let event = Event::Acl {
                robot: self.cast.instances[from as usize].robot,
                performative: performative.to_string(),
                sender: self.agent_name(from),
                receiver: self.agent_name(to),
                content,
                registers: registers.to_vec(),
                reason: reason.map(str::to_string),
                thread: Box::new(thread),
            };
            self.recorder.record(self.now, cause, || event)
        } else {
            None
        };
        self.enter(number, by, target, limit, record);
        let lost = loss > 0.0
            && chance(self.seed, 1 << 40 | u64::from(conversation), u64::from(from), number, u64::from(said))
                < loss;
        let utterance = Utterance {
            branch: number,
            by,
            performative: performative.clone(),
            said,
            registers: registers.to_vec(),
            record: record.unwrap_or(0),
            unreadable: false,
        };
        let fate = self.troubles.fate(Route::Talk(conversation), self.seed, self.now, from, number);
        if lost || fate.lost {
            let why = if lost { "lost on the way" } else { "lost by a fault" };
            self.trace_utterance(&utterance, to, Some(why));
            self.ended.push(number);
            return;
        }
        let utterance = Utterance { unreadable: fate.unreadable, ..utterance };
        for _ in 0..1 + u32::from(fate.twice) {
            if let Some(b) = self.talks.branches.get_mut(&number) {
                b.under_way += 1;
            }
            self.queue.put(self.now + delay + fate.late, Scheduled::Utter(utterance.clone()));
        }
    }

    /// A side's copy of the protocol goes into a state.
    fn enter(&mut self, number: u64, side: Role, state: u32, limit: Option<Time>, cause: Option<u64>) {
        let Some(b) = self.talks.branches.get_mut(&number) else { return };
        let before = std::mem::replace(&mut b.states[side.index()], state);
        b.entries[side.index()] += 1;
        let (entry, conversation, peers, group) = (b.entries[side.index()], b.conversation, b.peers, b.group);
        let c = &self.mission.graph.conversations[conversation as usize];
        let s = &c.states[state as usize];
        let me = peers[side.index()];
        if self.recorder.on() {
            let robot = self.cast.instances[me as usize].robot;
            let conversation_id = b.id.clone();
            let (agent, over) = (self.agent_name(me), s.is_final());
            let event =
                Event::Conversation { robot, agent, conversation_id, state: s.name.to_string(), over };
            self.recorder.record(self.now, cause, || event);
        }
        if s.holds_timeout(side) {
            let declared = self.channels[conversation as usize].timeouts[state as usize];
            if let Some(after) = limit.or(declared) {
                let due = self.now + after;
                self.queue.put(due, Scheduled::Patience { branch: number, by: side, entry });
            }
        }
        if side == Role::Initiator {
            let settled = match self.talks.groups.get_mut(&group) {
                Some(g) if before == g.state && state != g.state => {
                    g.waiting = g.waiting.saturating_sub(1);
                    g.waiting == 0
                }
                _ => false,
            };
            if settled {
                self.talks.groups.remove(&group);
                self.release_talk(me, conversation, Some(number), me, &TalkCode::Settled, cause);
            }
        }
        if s.is_final() {
            self.ended.push(number);
        }
    }

    /// Conversations that are over for both sides are forgotten when nothing of them is under way any more. Who
    /// never heard of one does not wait for its end.
    pub(super) fn forget_talks(&mut self) {
        if self.ended.is_empty() {
            return;
        }
        let mut ended = std::mem::take(&mut self.ended);
        for number in ended.drain(..) {
            let Some(b) = self.talks.branches.get(&number) else { continue };
            let c = &self.mission.graph.conversations[b.conversation as usize];
            let over = |s: u32| c.states[s as usize].is_final();
            let unaware = b.entries[Role::Participant.index()] == 0;
            let left = |side: usize| b.gone[side] || over(b.states[side]);
            if b.under_way == 0 && left(0) && (unaware || left(1)) {
                self.talks.branches.remove(&number);
            }
        }
        // Its room is used at the next instant.
        self.ended = ended;
    }

    fn trace_utterance(&mut self, u: &Utterance, to: u32, dropped: Option<&str>) -> Option<u64> {
        if !self.recorder.on() {
            return None;
        }
        let robot = self.cast.instances[to as usize].robot;
        let (agent, topic) = (self.agent_name(to), u.performative.to_string());
        let dropped = dropped.map(str::to_string);
        let event = Event::Delivery { robot, agent, topic, message: u.record, dropped };
        self.recorder.record(self.now, Some(u.record), || event)
    }

    /// `agent@robot`
    pub(super) fn agent_name(&self, instance: u32) -> String {
        let who = &self.cast.instances[instance as usize];
        let agent = &self.mission.graph.agents[who.agent as usize].name;
        format!("{agent}@{}", self.scene.robots[who.robot as usize].name)
    }
}

/// What a message is called in the trace, where an answer refers to it.
fn mark(number: u64, by: Role, said: u32) -> String {
    let side = if by == Role::Initiator { "i" } else { "p" };
    format!("{number}/{side}{said}")
}

fn role(side: Role) -> &'static str {
    match side {
        Role::Initiator => "the initiator",
        Role::Participant => "the participant",
    }
}
