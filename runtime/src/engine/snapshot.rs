//! Snapshots: all that a run remembers from one instant to the next. From one of them a replay goes on as
//! if it had come there from the start.

use super::{
    Clock, Engine,
    actuate::Actuators,
    board::Kept,
    contacts::Contacts,
    cores::{CoreState, Tally},
    devices::DeviceState,
    directory::Directory,
    goals::Goals,
    lives::Lives,
    minds::Minds,
    planner::Planner,
    post::Waiting,
    queue::Agenda,
    report::FaultReport,
    sampled::Gathered,
    senses::Senses,
    talks::Talks,
    verdict::Track,
};
use crate::Time;
use serde::{Deserialize, Serialize};

/// The state of a run after everything that happens at an instant.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Snapshot {
    /// The instant.
    pub t: Time,
    /// Number of the next record.
    pub next: u64,
    polled: Time,
    params: Vec<f64>,
    minds: Minds,
    subgoals: Vec<u8>,
    clocks: Vec<Clock>,
    tallies: Vec<Tally>,
    cores: Vec<CoreState>,
    devices: Vec<DeviceState>,
    senses: Senses,
    boards: Vec<Kept>,
    mail: Waiting,
    talks: Talks,
    directory: Directory,
    lives: Lives,
    faults: Vec<FaultReport>,
    planner: Planner,
    agenda: Agenda,
    actuators: Actuators,
    contacts: Contacts,
    goals: Goals,
    tracks: Vec<Vec<Track>>,
    gathered: Vec<Gathered>,
    poses: Vec<Option<([f64; 7], f64)>>,
    /// In the order of the platform.
    movers: Vec<(String, [f64; 7])>,
}

/// World truth at a snapshot.
pub(crate) struct Truth<'s> {
    /// Pose and path length of each robot.
    pub poses: &'s [Option<([f64; 7], f64)>],
    /// In the order of the platform.
    pub movers: &'s [(String, [f64; 7])],
    pub contacts: &'s Contacts,
}

impl Snapshot {
    /// What was true, when the platform knew.
    pub(crate) fn truth(&self) -> Option<Truth<'_>> {
        let Snapshot { poses, movers, contacts, .. } = self;
        poses.iter().any(Option::is_some).then_some(Truth { poses, movers, contacts })
    }
}

impl Engine<'_> {
    /// Hands a snapshot to the trace when it wants one.
    pub(super) fn snapshot(&mut self) {
        // What a state means but does not hold cannot be kept in a snapshot: such runs replay from their start.
        if self.store.is_empty() && self.recorder.wants_snapshot(self.now) {
            let snapshot = Snapshot {
                t: self.now,
                next: self.recorder.next(),
                polled: self.polled,
                params: self.params.clone(),
                minds: self.minds.clone(),
                subgoals: self.subgoals.clone(),
                clocks: self.clocks.clone(),
                tallies: self.tallies.clone(),
                cores: self.cores.clone(),
                devices: self.devices.clone(),
                senses: self.senses.clone(),
                boards: self.boards.iter().map(|b| b.kept()).collect(),
                mail: self.mail.waiting(),
                talks: self.talks.clone(),
                directory: self.directory.clone(),
                lives: self.lives.clone(),
                faults: self.faults.clone(),
                planner: self.planner.clone(),
                agenda: self.queue.agenda(),
                actuators: self.actuators.clone(),
                contacts: self.contacts.clone(),
                goals: self.goals.clone(),
                tracks: self.judge.watches.iter().map(|w| w.tracks.clone()).collect(),
                gathered: self.judge.gathered.clone(),
                poses: self.poses.clone(),
                movers: self.platform.truth().map(|t| t.movers()).unwrap_or_default(),
            };
            self.recorder.snapshot(&snapshot);
        }
    }

    /// Goes on from a snapshot of a run of the same mission with the same settings; false when it is one of
    /// another.
    pub fn resume(&mut self, s: Snapshot) -> bool {
        let counts = |tracks: &[Vec<Track>]| tracks.iter().map(Vec::len).collect::<Vec<_>>();
        let tracks: Vec<_> = self.judge.watches.iter().map(|w| w.tracks.clone()).collect();
        let units = self.cast.units.len();
        let states: Vec<usize> = self.mission.graph.conversations.iter().map(|c| c.states.len()).collect();
        let fits = s.params.len() == self.params.len()
            && s.minds.fits(&self.minds, self.mission, &self.cast)
            && s.subgoals.len() == self.subgoals.len()
            && s.clocks.len() == self.clocks.len()
            && s.tallies.len() == self.tallies.len()
            && s.cores.len() == self.cores.len()
            && s.cores.iter().all(|c| c.fits(units))
            && s.devices.len() == self.devices.len()
            && s.devices.iter().all(|d| d.fits(units))
            && s.senses.fits(&self.senses)
            && s.boards.len() == self.boards.len()
            && s.mail.fits(units)
            && s.talks.fits(self.cast.instances.len(), &states)
            && s.directory.fits(self.cast.instances.len())
            && s.lives.fits(self.cast.instances.len(), units)
            && s.planner.fits(&self.planner, &self.pool)
            && s.actuators.fits(&self.actuators)
            && s.contacts.fits(&self.contacts)
            && s.goals.fits(&self.goals)
            && counts(&s.tracks) == counts(&tracks)
            && s.gathered.len() == self.judge.gathered.len()
            && s.poses.len() == self.poses.len();
        if !fits
            || !self.queue.resume(s.agenda, [self.cast.instances.len(), units, s.cores.len()])
            || !self.boards.iter_mut().zip(s.boards).all(|(board, kept)| board.resume(kept))
        {
            return false;
        }
        (self.now, self.polled) = (s.t, s.polled);
        (self.params, self.minds, self.subgoals, self.clocks) = (s.params, s.minds, s.subgoals, s.clocks);
        (self.tallies, self.cores) = (s.tallies, s.cores);
        self.devices = s.devices;
        (self.talks, self.directory) = (s.talks, s.directory);
        (self.lives, self.planner, self.faults) = (s.lives, s.planner, s.faults);
        self.mail.resume(s.mail);
        (self.senses, self.actuators) = (s.senses, s.actuators);
        (self.contacts, self.goals) = (s.contacts, s.goals);
        (self.poses, self.movers) = (s.poses, s.movers.into_iter().collect());
        for (watch, tracks) in self.judge.watches.iter_mut().zip(s.tracks) {
            watch.tracks = tracks;
        }
        self.judge.gathered = s.gathered;
        self.recorder.go_on(s.next);
        self.resumed = true;
        true
    }
}
