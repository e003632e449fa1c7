//! What happens when a message arrives, or does not.

use super::{Speech, Utterance};
use crate::{
    engine::{Engine, post::Letter},
    mission::code::{TalkCode, TriggerCode, UnitCode},
};
use soifra_graph::Role;
use std::sync::Arc;

impl Engine<'_> {
    /// A message arrives.
    pub(in crate::engine) fn hear(&mut self, u: Utterance) {
        let side = u.by.other();
        let Some(b) = self.talks.branches.get_mut(&u.branch) else { return };
        b.under_way = b.under_way.saturating_sub(1);
        self.ended.push(u.branch);
        let (conversation, peers) = (b.conversation, b.peers);
        let me = peers[side.index()];
        if b.gone[side.index()] || self.lives.is_dead(me) {
            b.gone[side.index()] = true;
            self.trace_utterance(&u, me, Some("the agent is dead"));
            self.announce_gone(u.branch, side, Some(u.record));
            return;
        }
        // The same message once more says nothing new.
        if b.heard[side.index()] == u.said {
            self.trace_utterance(&u, me, Some("a duplicate"));
            return;
        }
        let c = &self.mission.graph.conversations[conversation as usize];
        let state = &c.states[b.states[side.index()] as usize];
        if u.unreadable {
            self.not_understood(&u, side, me);
            return;
        }
        let Some(m) = state.move_of(u.by, &u.performative) else {
            let why = match state.is_final() {
                true => "the conversation is over".to_string(),
                false => format!("unexpected in state {}", state.name),
            };
            let over = state.is_final();
            let answer = state.move_of(side, "not_understood").map(|m| (&m.performative, m.target));
            self.trace_utterance(&u, me, Some(&why));
            if let (false, Some((performative, target))) = (over, answer) {
                let speech = Speech {
                    performative,
                    registers: &[],
                    reason: Some(&why),
                    limit: None,
                    cause: Some(u.record),
                };
                self.utter(u.branch, side, target, &speech);
            }
            return;
        };
        let target = m.target;
        let record = self.trace_utterance(&u, me, None);
        if let Some(b) = self.talks.branches.get_mut(&u.branch) {
            b.heard[side.index()] = u.said;
        }
        self.enter(u.branch, side, target, None, record);
        let what = TalkCode::Message(u.performative);
        let envelope = [f64::from(peers[u.by.index()]), u.branch as f64];
        self.deliver_talk(me, conversation, envelope, &what, (u.registers, u.record), record);
    }

    /// A message that nobody can read, by a fault: the receiver says so where its protocol lets it.
    pub(super) fn not_understood(&mut self, u: &Utterance, side: Role, me: u32) {
        let record = self.trace_utterance(u, me, Some("unreadable by a fault"));
        let Some(b) = self.talks.branches.get(&u.branch) else { return };
        let c = &self.mission.graph.conversations[b.conversation as usize];
        let state = &c.states[b.states[side.index()] as usize];
        let Some(heard) = state.move_of(u.by, &u.performative).map(|m| m.target) else { return };
        let Some(answer) = c.states[heard as usize].move_of(side, "not_understood") else { return };
        let (performative, target) = (&answer.performative, answer.target);
        self.enter(u.branch, side, heard, None, record);
        let reason = Some("unreadable");
        let speech = Speech { performative, registers: &[], reason, limit: None, cause: record };
        self.utter(u.branch, side, target, &speech);
    }

    /// A side has waited long enough.
    pub(in crate::engine) fn patience(&mut self, number: u64, side: Role, entry: u32) {
        let Some(b) = self.talks.branches.get(&number) else { return };
        if b.entries[side.index()] != entry || b.gone[side.index()] {
            return;
        }
        let (conversation, peers) = (b.conversation, b.peers);
        let c = &self.mission.graph.conversations[conversation as usize];
        let Some((_, target)) = c.states[b.states[side.index()] as usize].timeout else { return };
        self.enter(number, side, target, None, None);
        let me = peers[side.index()];
        let peer = peers[side.other().index()];
        self.release_talk(me, conversation, Some(number), peer, &TalkCode::Timeout, None);
    }

    pub(super) fn release_talk(
        &mut self,
        me: u32,
        conversation: u32,
        number: Option<u64>,
        peer: u32,
        what: &TalkCode,
        cause: Option<u64>,
    ) {
        let envelope = [f64::from(peer), number.unwrap_or(u64::MAX >> 12) as f64];
        self.deliver_talk(me, conversation, envelope, what, (Vec::new(), 0), cause);
    }

    /// Puts a letter into the mailboxes of the units that wait for it.
    pub(super) fn deliver_talk(
        &mut self,
        me: u32,
        conversation: u32,
        envelope: [f64; 2],
        what: &TalkCode,
        (registers, record): (Vec<f64>, u64),
        cause: Option<u64>,
    ) {
        let info = self.cast.instances[me as usize];
        let units = &self.mission.agents[info.agent as usize].units;
        let waits = |code: &UnitCode| {
            let TriggerCode::Talk { conversation: c, what: w } = &code.trigger else { return false };
            *c == conversation && w == what
        };
        let mut waiting =
            (info.units..).zip(units).filter(|(_, code)| waits(code)).map(|(unit, _)| unit).peekable();
        // Often nobody asks whether all have answered: then there is nothing to make.
        if waiting.peek().is_none() {
            return;
        }
        let topic = match what {
            TalkCode::Message(performative) => performative.clone(),
            TalkCode::Timeout => "timeout".into(),
            TalkCode::Settled => "settled".into(),
        };
        let capacity = self.channels[conversation as usize].capacity;
        let letter = Arc::new(Letter { topic, registers, record, capacity, envelope: Some(envelope) });
        for unit in waiting {
            self.put_letter(unit, letter.clone(), cause);
            self.open_mailbox(unit);
        }
    }
}
