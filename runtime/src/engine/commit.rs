//! Commits what activations did: in order of priority, robot, agent, unit, whatever thread evaluated them.

use super::{
    Clock, Engine,
    activate::{Outcome, Release},
    goals::word,
    log::{Item, Log},
    post::Letter,
    queue::Scheduled,
    report::FaultReport,
    troubles::Route,
};
use crate::{Event, Time, mission::code::TriggerCode};
use soifra_graph::eval::Fault;
use std::sync::Arc;

/// What is told to an agent of the same robot arrives after this time.
const TELL_DELAY: Time = Time(1_000);

/// Most letters told that may wait in a mailbox.
const TELL_CAPACITY: usize = 16;

impl Engine<'_> {
    /// `agent@robot`, and the name of a unit of it.
    pub(super) fn names(&self, unit: u32) -> (String, String) {
        let info = &self.cast.units[unit as usize];
        let who = &self.cast.instances[info.instance as usize];
        let agent = &self.mission.graph.agents[who.agent as usize];
        let robot = &self.scene.robots[who.robot as usize].name;
        (format!("{}@{robot}", agent.name), agent.units[info.unit as usize].name.to_string())
    }

    /// Commits one activation.
    pub(super) fn commit(&mut self, release: &Release, outcome: &mut Outcome, log: &Log) {
        if outcome.over {
            return;
        }
        // What was evaluated before its agent died in this wave is lost with it.
        if !self.reset.is_empty() && self.reset.contains(&self.cast.units[release.unit as usize].instance) {
            return;
        }
        let info = self.cast.units[release.unit as usize];
        let items = log.items.get(outcome.from as usize..outcome.to as usize).unwrap_or_default();
        if release.finish.is_some() {
            self.commit_answer(release, outcome, items, log);
            return;
        }
        let core = self.core_of(release.unit);
        let taken = if core.is_some() { Time::ZERO } else { self.execution_time(release.unit) };
        let finish = release.start + taken;
        if taken > Time::ZERO {
            self.clocks[release.unit as usize].busy = finish;
        }
        let record = self.trace_activation(release, outcome, items, core.is_none().then_some(finish));
        if let Some(fault) = outcome.fault.take() {
            self.unit_fault(release.unit, &fault, record);
            return;
        }
        if outcome.absent.is_none() {
            self.tallies[release.unit as usize].activations += 1;
        }
        if let Some(core) = core {
            let later = self.apply_inner(release.unit, items, log, record);
            self.begun(core, release.unit, outcome, record, later);
            return;
        }
        if outcome.absent.is_some() {
            self.clocks[release.unit as usize] =
                Clock { last: None, busy: Time::ZERO, ..self.clocks[release.unit as usize] };
            return;
        }
        if finish > release.release {
            self.done(release.unit, release.release, finish);
        }
        if finish - release.release > info.deadline {
            self.missed(release.unit, release.release, release.release + info.deadline, record);
        }
        // It may have died of that.
        if self.reset.contains(&info.instance) {
            return;
        }
        if taken == Time::ZERO {
            self.apply_all(release.unit, items, log, record);
            return;
        }
        let later = self.apply_inner(release.unit, items, log, record);
        if !later.items.is_empty() {
            self.queue.put(finish, Scheduled::Outputs { unit: release.unit, record, log: later });
        }
    }

    /// Applies what stays within the agent, and gives back what leaves it.
    fn apply_inner(&mut self, unit: u32, items: &[Item], log: &Log, record: Option<u64>) -> Log {
        let mut later = Log::default();
        for item in items {
            if item.is_output() {
                put_off(item, log, &mut later);
            } else {
                self.apply(unit, item, log, record);
            }
        }
        later
    }

    /// Commits what an anytime service answers.
    fn commit_answer(&mut self, release: &Release, outcome: &mut Outcome, items: &[Item], log: &Log) {
        match outcome.fault.take() {
            Some(fault) => self.unit_fault(release.unit, &fault, release.cause),
            None => self.apply_all(release.unit, items, log, release.cause),
        }
    }

    fn trace_activation(
        &mut self,
        release: &Release,
        outcome: &Outcome,
        items: &[Item],
        finish: Option<Time>,
    ) -> Option<u64> {
        if !self.recorder.on() {
            return None;
        }
        let info = self.cast.units[release.unit as usize];
        let who = self.cast.instances[info.instance as usize];
        let unit = &self.mission.agents[who.agent as usize].units[info.unit as usize];
        let group = &self.mission.groups[self.scene.robots[who.robot as usize].group as usize];
        let mut causes: Vec<u64> = release.cause.into_iter().collect();
        for &port in &unit.reads {
            let sensor = group.agents[who.binding as usize].sensors[port as usize];
            causes.extend(self.senses.record(who.robot, sensor, self.now));
        }
        causes.extend(items.iter().filter_map(|i| match i {
            Item::Heard(record) => Some(*record),
            _ => None,
        }));
        causes.sort_unstable();
        causes.dedup();
        let (agent, unit) = self.names(release.unit);
        let skipped = outcome.absent.map(|(port, reason)| {
            let sensor = &self.mission.graph.agents[who.agent as usize].sensors[port as usize].name;
            format!("no reading of {sensor}: {}", self.texts.get(reason))
        });
        let finish = if skipped.is_some() { Some(release.start) } else { finish };
        let event = Event::Activation {
            robot: who.robot,
            agent,
            unit,
            release: release.release,
            start: release.start,
            finish,
            skipped,
        };
        self.recorder.record(self.now, causes, || event)
    }

    /// Applies one item of an activation whose record is `cause`.
    pub(super) fn apply(&mut self, unit: u32, item: &Item, log: &Log, cause: Option<u64>) {
        let now = self.now;
        let info = self.cast.units[unit as usize];
        let who = self.cast.instances[info.instance as usize];
        let robot = who.robot;
        let mission = self.mission;
        match item {
            Item::Command { port, registers } => {
                let group = &mission.groups[self.scene.robots[robot as usize].group as usize];
                let binding = &group.agents[who.binding as usize];
                let route = binding.routes.get(info.unit as usize * binding.actuators + *port as usize);
                if let Some(&Some((channel, source))) = route {
                    let command = log.get(registers);
                    self.actuators.propose(now, robot, channel, source, command, info.lifetime, cause);
                }
            }
            Item::Publish { topic, registers } => self.send_out(unit, *topic, log.get(registers), cause),
            Item::Tell(told) => {
                let registers = log.get(&told.registers).to_vec();
                self.tell(unit, told, registers, cause);
            }
            Item::Open(o) => {
                self.open_talk(unit, o, log.get(&o.registers), log.get(&o.to), cause);
            }
            Item::Reply(r) => {
                let registers = log.get(&r.registers);
                self.reply_talk(unit, r.thread, &r.performative, r.reason.as_deref(), registers, cause);
            }
            Item::Raise(event) => {
                let agent = &mission.agents[who.agent as usize];
                for (u, code) in agent.units.iter().enumerate() {
                    if matches!(code.trigger, TriggerCode::Event(e) if e == *event) {
                        self.admit(who.units + u as u32, cause);
                    }
                }
            }
            Item::Govern(what) => self.govern(unit, what, cause),
            Item::SetParam { param, registers } => {
                let registers = log.get(registers).to_vec();
                let agent = if self.recorder.on() { self.names(unit).0 } else { String::new() };
                self.recorder.record(now, cause, || Event::Param {
                    agent,
                    param: mission
                        .graph
                        .params
                        .get(*param as usize)
                        .map_or_else(String::new, |p| p.name.to_string()),
                    registers: registers.clone(),
                });
                self.new_params.push((*param, registers));
            }
            Item::Subgoal { index, status } => {
                let s = &mission.agents[who.agent as usize].subgoals[*index as usize];
                let known = &mut self.subgoals[who.subgoals + *index as usize];
                let before = std::mem::replace(known, *status);
                self.goals.change(now, s.goal, robot, before, *status);
                self.recorder.record(now, cause, || Event::Goal {
                    goal: s.name.to_string(),
                    robot: Some(robot),
                    status: word(*status).to_string(),
                    reason: None,
                });
            }
            _ => self.trace_item(unit, item, log, cause),
        }
    }

    /// Items that are for the trace only.
    fn trace_item(&mut self, unit: u32, item: &Item, log: &Log, cause: Option<u64>) {
        if !self.recorder.on() {
            return;
        }
        let info = self.cast.units[unit as usize];
        let who = self.cast.instances[info.instance as usize];
        let robot = who.robot;
        let code = &self.mission.graph.agents[who.agent as usize];
        let (agent, unit) = self.names(unit);
        let event = match item {
            Item::Rule { rule, at } => {
                let guard = self.mission.written(*at).to_string();
                Event::Rule { robot, agent, unit, rule: *rule, guard }
            }
            Item::Transition { from, to } => {
                let name = |s: u32| match &code.units[info.unit as usize].kind {
                    soifra_graph::UnitKind::Machine(states) => states[s as usize].name.to_string(),
                    _ => String::new(),
                };
                Event::Transition { robot, agent, from: name(*from), to: name(*to), unit }
            }
            Item::Node { node, how } => {
                let label = match &code.units[info.unit as usize].kind {
                    soifra_graph::UnitKind::Plan { nodes, .. } => nodes[*node as usize].label.clone(),
                    _ => String::new(),
                };
                Event::Node { robot, agent, unit, node: *node, label, result: how.word().to_string() }
            }
            Item::State { state, registers } => {
                let state = code.states[*state as usize].name.to_string();
                Event::State { robot, agent, state, registers: log.get(registers).to_vec() }
            }
            Item::Note(text) => Event::Note { robot, agent, text: text.to_string() },
            _ => return,
        };
        self.recorder.record(self.now, cause, || event);
    }

    /// Publishes a message, unless a declared fault has something against it.
    fn send_out(&mut self, unit: u32, topic: u32, registers: &[f64], cause: Option<u64>) {
        let info = self.cast.units[unit as usize];
        let sender = info.instance;
        let robot = self.cast.instances[sender as usize].robot;
        if topic as usize >= self.boards.len() {
            return;
        }
        let now = self.now;
        let record = if self.recorder.on() {
            let (agent, _) = self.names(unit);
            let topic = self.mission.topics[topic as usize].name.to_string();
            let registers = registers.to_vec();
            self.recorder.record(now, cause, || Event::Message { robot, agent, topic, registers })
        } else {
            None
        };
        let fate = self.troubles.fate(Route::Topic(topic), self.seed, now, sender, 0);
        if fate.lost || fate.unreadable {
            let why = if fate.lost { "lost by a fault" } else { "unreadable by a fault" };
            let agent = self.agent_name(sender);
            let topic = self.mission.topics[topic as usize].name.to_string();
            let (message, dropped) = (record.unwrap_or(0), Some(why.to_string()));
            self.recorder.record(now, record, || Event::Delivery { robot, agent, topic, message, dropped });
            return;
        }
        for _ in 0..1 + u32::from(fate.twice) {
            if fate.late > Time::ZERO {
                let late = Scheduled::Publish { unit, topic, registers: registers.to_vec(), record };
                self.queue.put(now + fate.late, late);
            } else {
                self.publish(unit, topic, registers, record);
            }
        }
    }

    pub(super) fn publish(&mut self, unit: u32, topic: u32, registers: &[f64], record: Option<u64>) {
        let now = self.now;
        let info = self.cast.units[unit as usize];
        let sender = info.instance;
        let robot = self.cast.instances[sender as usize].robot;
        if topic as usize >= self.boards.len() {
            return;
        }
        let board = &mut self.boards[topic as usize];
        let receivers = &self.subscribers[topic as usize];
        let ranged = board.channel.range.is_some() && !receivers.is_empty();
        let truth = if board.placed() || ranged { self.platform.truth() } else { None };
        let bodies = self.scene.bodies().len();
        let place =
            |robot: u32| truth.filter(|_| (robot as usize) < bodies).map_or([0.0; 3], |t| t.position(robot));
        let here = place(robot);
        let number = board.publish(now, sender, registers, info.lifetime, record.unwrap_or(0), here);
        if receivers.is_empty() {
            return;
        }
        let range = board.channel.range.filter(|_| truth.is_some()).unwrap_or(f64::INFINITY);
        let (mut to, mut lost) = (Vec::new(), Vec::new());
        for &u in receivers {
            let receiver = self.cast.units[u as usize].instance;
            if receiver == sender {
                continue;
            }
            if range.is_finite() {
                let there = place(self.cast.instances[receiver as usize].robot);
                let d = [here[0] - there[0], here[1] - there[1], here[2] - there[2]];
                if d[0] * d[0] + d[1] * d[1] + d[2] * d[2] > range * range {
                    continue;
                }
            }
            if board.lost(sender, receiver, number) { lost.push(u) } else { to.push(u) }
        }
        let name = self.mission.topics[topic as usize].name.clone();
        let (delay, capacity) = (board.channel.delay, board.channel.capacity);
        let letter = Letter {
            topic: name,
            registers: registers.to_vec(),
            record: record.unwrap_or(0),
            capacity,
            envelope: None,
        };
        for u in lost {
            self.trace_delivery(u, &letter, Some("lost on the way"));
        }
        if !to.is_empty() {
            self.queue.put(now + delay, Scheduled::Deliver { letter: Arc::new(letter), to });
        }
    }

    fn tell(&mut self, unit: u32, told: &super::log::Told, registers: Vec<f64>, cause: Option<u64>) {
        let now = self.now;
        let info = self.cast.units[unit as usize];
        let who = self.cast.instances[info.instance as usize];
        let mission = self.mission;
        let sender = &mission.graph.agents[who.agent as usize].name;
        let robot = &self.scene.robots[who.robot as usize].name;
        // Only the trace says performative and content.
        let topic = match self.recorder.on() {
            true => format!("{} {}", told.performative, told.content).into(),
            false => told.content.clone(),
        };
        let record = self.recorder.record(now, cause, || Event::Acl {
            robot: who.robot,
            performative: told.performative.to_string(),
            sender: format!("{sender}@{robot}"),
            receiver: format!("{}@{robot}", told.to),
            content: Some(told.content.to_string()),
            registers: registers.clone(),
            reason: None,
            thread: Box::default(),
        });
        let letter =
            Letter { topic, registers, record: record.unwrap_or(0), capacity: TELL_CAPACITY, envelope: None };
        let letter = Arc::new(letter);
        let mut handled = false;
        for i in self.cast.of_robot(who.robot) {
            let receiver = &self.cast.instances[i];
            if mission.graph.agents[receiver.agent as usize].name != told.to {
                continue;
            }
            for (u, code) in mission.agents[receiver.agent as usize].units.iter().enumerate() {
                let TriggerCode::Told { performative, content, from } = &code.trigger else { continue };
                let wanted = *performative == told.performative && *content == told.content;
                if wanted && from.as_ref().is_none_or(|f| f == sender) {
                    let to = receiver.units + u as u32;
                    self.queue.put(now + TELL_DELAY, Scheduled::Hand { letter: letter.clone(), to });
                    handled = true;
                }
            }
        }
        if !handled {
            self.recorder.record(now, record, || Event::Delivery {
                robot: who.robot,
                agent: format!("{}@{robot}", told.to),
                topic: letter.topic.to_string(),
                message: letter.record,
                dropped: Some("nobody handles it".into()),
            });
        }
    }

    /// A delivery, or why there is none.
    pub(super) fn trace_delivery(
        &mut self,
        unit: u32,
        letter: &Letter,
        dropped: Option<&str>,
    ) -> Option<u64> {
        if !self.recorder.on() {
            return None;
        }
        let (agent, _) = self.names(unit);
        let robot = self.cast.instances[self.cast.units[unit as usize].instance as usize].robot;
        self.recorder.record(self.now, Some(letter.record), || Event::Delivery {
            robot,
            agent,
            topic: letter.topic.to_string(),
            message: letter.record,
            dropped: dropped.map(str::to_string),
        })
    }

    /// Something went wrong: the run will end with safe actions.
    pub(super) fn fault(&mut self, robot: Option<u32>, agent: &str, fault: &Fault, cause: Option<u64>) {
        let text = self.fault_text(fault);
        self.fail(robot, agent, text, cause);
    }

    /// What went wrong, where, and in which words of the sources.
    pub(super) fn fault_text(&self, fault: &Fault) -> String {
        let place = self.mission.place(fault.at);
        match (place.is_empty(), self.mission.written(fault.at)) {
            (true, _) => fault.to_string(),
            (false, "") => format!("{place}: {fault}"),
            (false, code) => format!("{place}: {fault} in `{}`", brief(code)),
        }
    }

    /// As [`Engine::fault`], in words.
    pub(super) fn fail(&mut self, robot: Option<u32>, agent: &str, text: String, cause: Option<u64>) {
        self.recorder.record(self.now, cause, || Event::Fault {
            robot,
            agent: agent.to_string(),
            text: text.clone(),
        });
        let who = match robot.and_then(|r| self.scene.robots.get(r as usize)) {
            _ if agent.contains('@') => format!("{agent}: "),
            Some(r) => format!("{} of {}: ", agent, r.name),
            None => String::new(),
        };
        self.note_fault(format!("{who}{text}"));
        if self.aborted.is_none() {
            self.aborted = Some(format!("{who}{text}"));
        }
    }

    /// Keeps a fault for the report.
    pub(super) fn note_fault(&mut self, text: String) {
        match self.faults.iter_mut().find(|f| f.text == text) {
            Some(f) => f.times += 1,
            None => self.faults.push(FaultReport { at_s: self.now.seconds(), text, times: 1 }),
        }
    }
}

/// The beginning of a piece of source, on one line.
fn brief(code: &str) -> String {
    let line = code.split_whitespace().collect::<Vec<_>>().join(" ");
    match line.char_indices().nth(60) {
        Some((cut, _)) => format!("{} …", &line[..cut]),
        None => line,
    }
}

/// Copies an output into a log of its own.
pub(super) fn put_off(item: &Item, from: &Log, to: &mut Log) {
    let mut item = item.clone();
    match &mut item {
        Item::Command { registers, .. }
        | Item::Publish { registers, .. }
        | Item::SetParam { registers, .. } => {
            *registers = to.keep(from.get(registers));
        }
        Item::Tell(told) => told.registers = to.keep(from.get(&told.registers)),
        Item::Open(o) => (o.registers, o.to) = (to.keep(from.get(&o.registers)), to.keep(from.get(&o.to))),
        Item::Reply(r) => r.registers = to.keep(from.get(&r.registers)),
        _ => {}
    }
    to.items.push(item);
}
