//! Conversations that can get stuck and ones that cannot. Protocols are written as text, and findings compared
//! as text.

mod fipa;
mod naive;
mod queues;
mod random;
mod structure;
mod turns;

use super::*;
use std::fmt::Write;

/// A protocol with the names of its states and messages.
pub struct Named {
    pub protocol: Protocol,
    states: Vec<String>,
    messages: Vec<String>,
}

/// Reads lines like `called: P propose proposed, P refuse refused, after expired`. `I` and `P` are the roles;
/// the first line is the initial state; a state without a line is final.
pub fn protocol(text: &str) -> Named {
    let mut n = Named { protocol: Protocol::default(), states: Vec::new(), messages: Vec::new() };
    let lines: Vec<(&str, &str)> = text.lines().filter_map(|l| l.trim().split_once(':')).collect();
    for (name, _) in &lines {
        n.state(name);
    }
    for (name, moves) in lines {
        let at = n.state(name) as usize;
        for m in moves.split(',').filter(|m| !m.trim().is_empty()) {
            match m.split_whitespace().collect::<Vec<_>>()[..] {
                ["after", target] => n.protocol.states[at].timeout = Some(n.state(target)),
                [by, message, target] => {
                    let by = if by == "I" { Role::Initiator } else { Role::Participant };
                    let (message, target) = (number(&mut n.messages, message), n.state(target));
                    n.protocol.states[at].moves.push(Move { by, message, target });
                }
                _ => panic!("{m}"),
            }
        }
    }
    n
}

/// The place of a name in a list, which it is added to when it is new.
fn number(names: &mut Vec<String>, name: &str) -> u32 {
    let at = names.iter().position(|n| n == name).unwrap_or_else(|| {
        names.push(name.to_string());
        names.len() - 1
    });
    at as u32
}

/// Queues with one capacity.
pub fn queues(capacity: usize, lossy: bool) -> Queues {
    Queues { capacity: [capacity; 2], lossy }
}

fn letter(role: Role) -> &'static str {
    match role {
        Role::Initiator => "I",
        Role::Participant => "P",
    }
}

impl Named {
    fn state(&mut self, name: &str) -> u32 {
        let i = number(&mut self.states, name.trim());
        self.protocol.states.resize(self.states.len(), State::default());
        i
    }

    /// The number of a state.
    pub fn at(&self, name: &str) -> usize {
        self.states.iter().position(|s| s == name).unwrap_or_else(|| panic!("no state {name}"))
    }

    /// Programs that make every move.
    pub fn willing(&self) -> [Party; 2] {
        Role::BOTH.map(|r| Party::willing(&self.protocol, r))
    }

    /// What programs that make every move can come to, when all of it can be visited.
    pub fn explored(&self, capacity: usize, lossy: bool) -> Explored {
        let e = explore(&self.protocol, &self.willing(), queues(capacity, lossy), MOST);
        assert!(e.complete);
        e
    }

    /// Findings of programs that make every move, each in one line.
    pub fn findings(&self, capacity: usize, lossy: bool) -> Vec<String> {
        self.explored(capacity, lossy).findings.iter().map(|f| self.line(f)).collect()
    }

    /// Findings of other programs, when nothing is lost.
    pub fn findings_of(&self, parties: &[Party; 2]) -> Vec<String> {
        let e = explore(&self.protocol, parties, queues(1, false), MOST);
        assert!(e.complete);
        e.findings.iter().map(|f| self.line(f)).collect()
    }

    /// Mistakes of the protocol, each in one line.
    pub fn faults(&self) -> Vec<String> {
        let state = |i: &u32| self.states[*i as usize].as_str();
        let line = |f: &Fault| match f {
            Fault::Unreachable { state: s } => format!("{} is not reached", state(s)),
            Fault::Endless { state: s } => format!("{} does not end", state(s)),
            Fault::Ambiguous { state: s, role, message } => {
                format!("{} says {} twice in {}", letter(*role), self.messages[*message as usize], state(s))
            }
            Fault::Livelock { states, roles } => {
                let names: Vec<&str> = states.iter().map(state).collect();
                format!("{} in {}", roles.iter().map(|r| letter(*r)).collect::<String>(), names.join(" "))
            }
        };
        faults(&self.protocol).iter().map(line).collect()
    }

    /// Who waits where, why it does not send, for what, and what stands in the way.
    fn wait(&self, w: &Wait) -> String {
        let message = |m: u32| self.messages[m as usize].as_str();
        let state = self.states[w.state as usize].as_str();
        let mut out = format!(" {} in {state} ({:?})", letter(w.role), w.silence);
        for m in &w.awaited {
            let _ = write!(out, " {}", message(*m));
        }
        if let Some(m) = w.unexpected {
            let _ = write!(out, " not {}", message(m));
        }
        out
    }

    /// A finding with its witness: `I!m` is sent, `P?m` received, `P-m` dropped, `P*m` lost, `I~` timed out.
    fn line(&self, f: &Finding) -> String {
        let state = |i: u32| self.states[i as usize].as_str();
        let message = |i: u32| self.messages[i as usize].as_str();
        let mut out = String::new();
        let witness = match f {
            Finding::NotProven { seen } => return format!("not proven: {seen}"),
            Finding::Unexpected { role, state: s, message: m, witness } => {
                let _ = write!(out, "unexpected {} at {} in {}", message(*m), letter(*role), state(*s));
                witness
            }
            Finding::Stuck { waits, witness } => {
                out.push_str("stuck");
                for w in waits {
                    out.push_str(&self.wait(w));
                }
                witness
            }
        };
        out.push_str(" |");
        for s in witness {
            let by = letter(s.by);
            let _ = match s.action {
                Action::Sends(m) => write!(out, " {by}!{}", message(m)),
                Action::Receives(m) => write!(out, " {by}?{}", message(m)),
                Action::Drops(m) => write!(out, " {by}-{}", message(m)),
                Action::Loses(m) => write!(out, " {by}*{}", message(m)),
                Action::TimesOut => write!(out, " {by}~{}", state(s.state)),
            };
        }
        out
    }
}
