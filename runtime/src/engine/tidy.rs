//! Which objects of the store something still means.
//!
//! States and readings are of known types: of them the registers that are numbers of objects count. What is under way
//! (letters, messages put off, executions that are not done) does not say of which type it is, and any register of it
//! counts that could be such a number. At worst an object is kept a little longer; never is one lost that somebody will
//! be handed.

use super::{Engine, cores::CoreState, log::Log, queue::Scheduled};
use std::collections::BTreeSet;

impl Engine<'_> {
    /// Forgets images and other objects that nothing means any more.
    pub(super) fn tidy_store(&mut self) {
        if !self.store.has_grown() {
            return;
        }
        let mut used: BTreeSet<u64> = self.senses.opaque().map(|x| x as u64).collect();
        for who in &self.cast.instances {
            let opaque = &self.mission.agents[who.agent as usize].opaque;
            used.extend(
                opaque.iter().filter_map(|at| self.minds.states.get(who.states + at)).map(|x| *x as u64),
            );
        }
        let mut mean = |registers: &[f64]| {
            used.extend(registers.iter().filter(|x| self.store.get(**x).is_some()).map(|x| *x as u64));
        };
        self.mail.letters().for_each(|l| mean(&l.registers));
        self.queue.put_off().for_each(|s| s.registers().into_iter().for_each(&mut mean));
        self.cores.iter().flat_map(CoreState::registers).for_each(&mut mean);
        self.boards.iter().for_each(|b| mean(b.registers()));
        self.store.tidy(&used);
    }
}

impl Scheduled {
    /// Registers that will be handed to somebody.
    fn registers(&self) -> Option<&[f64]> {
        match self {
            Scheduled::Deliver { letter, .. } | Scheduled::Hand { letter, .. } => Some(&letter.registers),
            Scheduled::Outputs { log: Log { registers, .. }, .. } | Scheduled::Publish { registers, .. } => {
                Some(registers)
            }
            Scheduled::Utter(utterance) => Some(&utterance.registers),
            Scheduled::DeviceFree { .. }
            | Scheduled::Patience { .. }
            | Scheduled::Wake(_)
            | Scheduled::Late { .. }
            | Scheduled::Core { .. }
            | Scheduled::Deadline { .. }
            | Scheduled::Notice(_)
            | Scheduled::Kill(_)
            | Scheduled::Heard(_)
            | Scheduled::Post(_)
            | Scheduled::PeerGone { .. } => None,
        }
    }
}
