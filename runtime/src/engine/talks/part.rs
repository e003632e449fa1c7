//! What becomes of the conversations of an agent that has died.

use crate::{
    Event, Thread,
    engine::{Engine, queue::Scheduled},
    mission::code::TalkCode,
};
use soifra_graph::Role;

impl Engine<'_> {
    /// An agent that has died says nothing any more; whom it was talking with learns that from its platform.
    pub(in crate::engine) fn leave_talks(&mut self, instance: u32, cause: Option<u64>) {
        let all = self.talks.branches.iter();
        let of: Vec<(u64, Role)> = all
            .flat_map(|(n, b)| [(*n, Role::Initiator, b.peers[0]), (*n, Role::Participant, b.peers[1])])
            .filter(|(_, _, peer)| *peer == instance)
            .map(|(n, side, _)| (n, side))
            .collect();
        for (number, side) in of {
            if let Some(b) = self.talks.branches.get_mut(&number) {
                b.gone[side.index()] = true;
                self.ended.push(number);
                self.announce_gone(number, side, cause);
            }
        }
    }

    /// The platform of a dead agent tells the other side, after the delay of a message.
    pub(super) fn announce_gone(&mut self, number: u64, side: Role, cause: Option<u64>) {
        let Some(b) = self.talks.branches.get_mut(&number) else { return };
        let c = &self.mission.graph.conversations[b.conversation as usize];
        let other = side.other().index();
        if b.gone[other] || c.states[b.states[other] as usize].is_final() || b.entries[other] == 0 {
            return;
        }
        b.under_way += 1;
        let (peer, dead, id) = (b.peers[other], b.peers[side.index()], b.id.clone());
        let delay = self.channels[b.conversation as usize].delay;
        let record = if self.recorder.on() {
            let thread = Thread {
                conversation_id: Some(id),
                protocol: Some(c.protocol.to_string()),
                ontology: Some(c.ontology.to_string()),
                ..Thread::default()
            };
            let event = Event::Acl {
                robot: self.cast.instances[dead as usize].robot,
                performative: "failure".into(),
                sender: self.agent_name(dead),
                receiver: self.agent_name(peer),
                content: None,
                registers: Vec::new(),
                reason: Some("the agent is dead".into()),
                thread: Box::new(thread),
            };
            self.recorder.record(self.now, cause, || event)
        } else {
            None
        };
        self.queue.put(self.now + delay, Scheduled::PeerGone { branch: number, side, record });
    }

    /// A side learns that the other is dead: as a failure where its protocol has one, else it is over for it.
    pub(in crate::engine) fn peer_gone(&mut self, number: u64, dead: Role, record: Option<u64>) {
        let Some(b) = self.talks.branches.get_mut(&number) else { return };
        b.under_way = b.under_way.saturating_sub(1);
        self.ended.push(number);
        let side = dead.other();
        let c = &self.mission.graph.conversations[b.conversation as usize];
        let state = &c.states[b.states[side.index()] as usize];
        if b.gone[side.index()] || state.is_final() {
            return;
        }
        let (me, peer, conversation) = (b.peers[side.index()], b.peers[dead.index()], b.conversation);
        let failure = state.move_of(dead, "failure").filter(|m| m.content.is_none());
        if let Some(target) = failure.map(|m| m.target) {
            self.enter(number, side, target, None, record);
            let what = TalkCode::Message("failure".into());
            let letter = (Vec::new(), record.unwrap_or(0));
            let envelope = [f64::from(peer), number as f64];
            self.deliver_talk(me, conversation, envelope, &what, letter, record);
            return;
        }
        // Where the protocol has no word for it, the side goes where waiting in vain leads, else to an end.
        let end = c.states.iter().position(|s| s.is_final()).map(|s| s as u32);
        match state.timeout.as_ref().map(|t| t.1).or(end) {
            Some(state) => self.enter(number, side, state, None, record),
            None => b.gone[side.index()] = true,
        }
        self.release_talk(me, conversation, Some(number), peer, &TalkCode::Timeout, record);
    }
}
