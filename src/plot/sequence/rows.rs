//! What a message sequence chart shows, gathered from the records: who takes part, and one row for each
//! thing that happens among them.

use crate::{plot::Selection, report::table::figure};
use soifra_runtime::{Event, Record, Time};
use std::collections::BTreeMap;

/// Somebody with a lifeline: an agent, or the parameters.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Participant {
    Agent(String),
    Parameters,
}

/// One row of a chart.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Row {
    pub t: Time,
    pub what: What,
}

/// What happens in a row; participants by index.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum What {
    Arrow(Arrow),
    /// A service was started or stopped.
    Service {
        of: usize,
        running: bool,
        text: String,
    },
    /// An agent died, came back, or else.
    Life {
        of: usize,
        turn: Turn,
        text: String,
    },
    /// A conversation is over for an agent.
    Over {
        of: usize,
        text: String,
    },
}

/// What becomes of an agent's life.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Turn {
    Dead,
    Restarted,
    Other,
}

/// The same message or change of a parameter, once or several times with nothing between.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Arrow {
    pub from: usize,
    pub to: usize,
    pub label: String,
    pub count: u64,
    /// When it came last.
    pub last: Time,
    /// So many were dropped, the last of them for this reason.
    pub dropped: u64,
    pub why: String,
}

impl Arrow {
    /// Whether nothing of it arrived.
    pub(super) fn is_lost(&self) -> bool {
        self.dropped >= self.count
    }
}

/// A text that is longer is cut.
const LONGEST: usize = 200;
/// A message can be dropped long after it was sent: from a mailbox that is full. So many are remembered.
const REMEMBERED: usize = 1 << 16;
/// Registers of a parameter that are written.
const REGISTERS: usize = 6;

/// The rows of a chart, while records come in.
#[derive(Debug)]
pub(super) struct Rows<'s> {
    selection: &'s Selection,
    limit: usize,
    /// In order of first appearance.
    pub participants: Vec<Participant>,
    index: BTreeMap<Participant, usize>,
    pub rows: Vec<Row>,
    /// Rows beyond the limit.
    pub cut: u64,
    /// The last of them, if it is an arrow.
    last_cut: Option<(Participant, Participant, String)>,
    /// Rows of messages, by the number of their record.
    sent: BTreeMap<u64, usize>,
}

impl<'s> Rows<'s> {
    pub(super) fn new(selection: &'s Selection, limit: usize) -> Self {
        Rows {
            selection,
            limit,
            participants: Vec::new(),
            index: BTreeMap::new(),
            rows: Vec::new(),
            cut: 0,
            last_cut: None,
            sent: BTreeMap::new(),
        }
    }

    /// Takes the next record.
    pub(super) fn take(&mut self, record: &Record) {
        // A message that is drawn may be dropped after the time that is asked for.
        if let Event::Delivery { agent, message, dropped: Some(why), .. } = &record.event {
            self.drop(*message, agent, why);
        }
        let s = self.selection;
        if !s.has_time(record.t) {
            return;
        }
        let (t, apart) = (record.t, s.has_conversation(None));
        match &record.event {
            Event::Acl { performative, sender, receiver, content, reason, thread, .. }
                if s.has_conversation(thread.conversation_id.as_deref())
                    && (s.has_agent(sender) || s.has_agent(receiver)) =>
            {
                let mut label = performative.clone();
                content.iter().for_each(|c| label += &format!(" {c}"));
                reason.iter().for_each(|r| label += &format!(": {r}"));
                let row = self.arrow(t, agent(sender), agent(receiver), &label);
                if let Some(row) = row {
                    self.sent.insert(record.n, row);
                    if self.sent.len() > REMEMBERED {
                        self.sent.pop_first();
                    }
                }
            }
            Event::Param { agent: by, param, registers } if apart && s.has_agent(by) => {
                let label = format!("{param} = {}", value(registers));
                self.arrow(t, agent(by), Participant::Parameters, &label);
            }
            Event::Service { agent: of, service, running, subgoal, .. } if apart && s.has_agent(of) => {
                let mut text = format!("{} {service}", if *running { '▸' } else { '▪' });
                subgoal.iter().for_each(|s| text += &format!(" for {s}"));
                let (running, text) = (*running, clean(&text));
                self.push(t, of, |of| What::Service { of, running, text });
            }
            Event::Life { agent: of, status, reason, .. } if apart && s.has_agent(of) => {
                let turn = match status.as_str() {
                    "dead" => Turn::Dead,
                    "restarted" => Turn::Restarted,
                    _ => Turn::Other,
                };
                let text = if reason.is_empty() { status.clone() } else { format!("{status}: {reason}") };
                let text = clean(&text);
                self.push(t, of, |of| What::Life { of, turn, text });
            }
            Event::Conversation { agent: of, conversation_id, state, over: true, .. }
                if s.has_conversation(Some(conversation_id)) && s.has_agent(of) =>
            {
                let text = clean(&format!("{conversation_id} over: {state}"));
                self.push(t, of, |of| What::Over { of, text });
            }
            _ => {}
        }
    }

    /// Draws an arrow, or counts it to the one before. Gives its row unless that is cut.
    fn arrow(&mut self, t: Time, from: Participant, to: Participant, label: &str) -> Option<usize> {
        let label = clean(label);
        if self.cut == 0 && self.repeats(&from, &to, &label) {
            self.again(t);
        } else if self.rows.len() < self.limit {
            let (from, to) = (self.participant(from), self.participant(to));
            let arrow = Arrow { from, to, label, count: 1, last: t, dropped: 0, why: String::new() };
            self.rows.push(Row { t, what: What::Arrow(arrow) });
        } else {
            let arrow = Some((from, to, label));
            if self.last_cut != arrow {
                self.cut += 1;
                self.last_cut = arrow;
            }
            return None;
        }
        self.rows.len().checked_sub(1)
    }

    /// Whether an arrow is that of the last row.
    fn repeats(&self, from: &Participant, to: &Participant, label: &str) -> bool {
        let Some(Row { what: What::Arrow(a), .. }) = self.rows.last() else { return false };
        a.label == label && self.index.get(from) == Some(&a.from) && self.index.get(to) == Some(&a.to)
    }

    fn again(&mut self, t: Time) {
        if let Some(Row { what: What::Arrow(a), .. }) = self.rows.last_mut() {
            a.count += 1;
            a.last = t;
        }
    }

    /// Adds a row about an agent, unless that is cut.
    fn push(&mut self, t: Time, of: &str, what: impl FnOnce(usize) -> What) {
        if self.rows.len() >= self.limit {
            self.cut += 1;
            self.last_cut = None;
        } else {
            let of = self.participant(agent(of));
            self.rows.push(Row { t, what: what(of) });
        }
    }

    fn participant(&mut self, who: Participant) -> usize {
        if let Some(i) = self.index.get(&who) {
            return *i;
        }
        self.participants.push(who.clone());
        self.index.insert(who, self.participants.len() - 1);
        self.participants.len() - 1
    }

    /// A message to an agent did not arrive.
    fn drop(&mut self, message: u64, receiver: &str, reason: &str) {
        let Some(row) = self.sent.get(&message).and_then(|row| self.rows.get_mut(*row)) else { return };
        if let What::Arrow(a) = &mut row.what
            && self.index.get(&agent(receiver)) == Some(&a.to)
        {
            a.dropped += 1;
            a.why = clean(reason);
            self.sent.remove(&message);
        }
    }
}

fn agent(name: &str) -> Participant {
    Participant::Agent(clean(name))
}

/// A text that can be written in a line.
fn clean(text: &str) -> String {
    let mut out: String = text.chars().take(LONGEST).map(|c| if c.is_control() { ' ' } else { c }).collect();
    if text.chars().nth(LONGEST).is_some() {
        out.push('…');
    }
    out
}

/// A parameter's value: one register is a number, several are a list.
fn value(registers: &[f64]) -> String {
    match registers {
        [x] => figure(Some(*x)),
        _ => {
            let mut parts: Vec<String> = registers.iter().take(REGISTERS).map(|x| figure(Some(*x))).collect();
            if registers.len() > REGISTERS {
                parts.push("…".into());
            }
            format!("({})", parts.join(", "))
        }
    }
}
