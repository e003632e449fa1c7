//! An operator at standard input: one input a line, read by a thread of its own, so that waiting for a line
//! holds nothing up. What is not understood is told on standard error, and nothing comes of it.

use super::lines::{self, LONGEST, Line};
use crate::{compile, output, report};
use soifra_graph::did_you_mean;
use soifra_runtime::{Input, Mission, Operation, Scene};
use std::{
    sync::mpsc::{Receiver, RecvTimeoutError, TryRecvError, sync_channel},
    thread,
    time::Duration,
};

/// Lines that may wait. More are left where they come from, so that a flood of them takes no memory; and no
/// more are looked at between two instants.
const WAITING: usize = 64;

/// Characters of a line that are shown again.
const SHOWN: usize = 60;

/// What is possible.
const POSSIBLE: &str = "possible are `kill AGENT@ROBOT`, `set NAME=VALUE` and `stop`";

/// Whoever operates a run.
pub struct Operator<'m> {
    desk: Option<Desk<'m>>,
    lines: Option<Receiver<Line>>,
    /// One that ended a wait.
    first: Option<Line>,
}

/// Understands lines.
struct Desk<'m> {
    mission: &'m Mission,
    /// Everybody who can be killed.
    agents: Vec<String>,
}

impl<'m> Operator<'m> {
    /// Nobody: nothing is ever put in.
    pub fn nobody() -> Self {
        Operator { desk: None, lines: None, first: None }
    }

    /// Whoever writes lines to standard input.
    pub fn at_standard_input(mission: &'m Mission, scene: &Scene) -> Self {
        let (send, lines) = sync_channel(WAITING);
        let listen = move || lines::read(std::io::stdin().lock(), |line| send.send(line).is_ok());
        // Nobody waits for the thread: it may stand in a read that never returns.
        if let Err(e) = thread::Builder::new().name("operator".into()).spawn(listen) {
            output::note(&format!("warning[S9014]: standard input is not read: {e}"));
            return Operator::nobody();
        }
        Operator {
            desk: Some(Desk { mission, agents: mission.agents(scene) }),
            lines: Some(lines),
            first: None,
        }
    }

    /// Waits for so long, or until a line comes.
    pub fn wait(&mut self, at_most: Duration) {
        match &self.lines {
            Some(lines) => match lines.recv_timeout(at_most) {
                Ok(line) => self.first = Some(line),
                Err(RecvTimeoutError::Timeout) => {}
                Err(RecvTimeoutError::Disconnected) => self.lines = None,
            },
            None => thread::sleep(at_most),
        }
    }

    /// Takes the inputs that have come.
    pub fn take(&mut self, inputs: &mut Vec<Input>) {
        for _ in 0..WAITING {
            let Some(line) = self.next() else { return };
            match self.desk.as_ref().map(|d| d.read(&line)) {
                Some(Ok(input)) => inputs.extend(input),
                Some(Err(why)) => complain(&line, &why),
                None => {}
            }
        }
    }

    /// The run is over: what comes now comes too late.
    pub fn close(&mut self) {
        for _ in 0..WAITING {
            match self.next() {
                Some(Line::Text(text)) if text.trim().is_empty() => {}
                Some(line) => complain(&line, "the run is over"),
                None => break,
            }
        }
        self.lines = None;
    }

    fn next(&mut self) -> Option<Line> {
        if let Some(line) = self.first.take() {
            return Some(line);
        }
        match self.lines.as_ref()?.try_recv() {
            Ok(line) => Some(line),
            Err(TryRecvError::Empty) => None,
            Err(TryRecvError::Disconnected) => {
                self.lines = None;
                None
            }
        }
    }
}

/// Tells what is wrong with a line, in a line.
fn complain(line: &Line, why: &str) {
    let given = match line {
        Line::Text(text) | Line::TooLong(text) | Line::NotText(text) => {
            let mut shown: String = text.trim().chars().take(SHOWN).collect();
            if shown.len() < text.trim().len() {
                shown.push('…');
            }
            format!("operator input `{shown}`")
        }
        Line::Broken(_) => "standard input".to_string(),
    };
    output::note(&format!(
        "warning[S9028]: {}",
        report::clean(&format!("{given}: {why}")).replace('\n', " ")
    ));
}

impl Desk<'_> {
    /// What a line means; nothing, when it is blank.
    fn read(&self, line: &Line) -> Result<Option<Input>, String> {
        match line {
            Line::Text(text) if text.trim().is_empty() => Ok(None),
            Line::Text(text) => {
                let text = text.trim();
                self.operation(text).map(|operation| Some(Input { text: text.to_string(), operation }))
            }
            Line::TooLong(_) => Err(format!("a line of more than {LONGEST} bytes; {POSSIBLE}")),
            Line::NotText(_) => Err(format!("this is not UTF-8 text; {POSSIBLE}")),
            Line::Broken(why) => Err(format!("cannot be read any further: {why}")),
        }
    }

    fn operation(&self, text: &str) -> Result<Operation, String> {
        let (word, rest) = text.split_once(char::is_whitespace).unwrap_or((text, ""));
        let rest = rest.trim();
        match (word, rest) {
            ("stop", "") => Ok(Operation::Stop),
            ("kill", "") => Err(format!("an agent is wanted, as `kill {}`", self.example())),
            ("kill", agent) => self.kill(agent),
            ("set", setting) => self.set(setting),
            _ => Err(match did_you_mean(word, ["kill", "set", "stop"]) {
                Some(near) => format!("did you mean `{near}`? {POSSIBLE}"),
                None => POSSIBLE.to_string(),
            }),
        }
    }

    fn kill(&self, agent: &str) -> Result<Operation, String> {
        if self.agents.iter().any(|a| a == agent) {
            return Ok(Operation::Kill { agent: agent.to_string() });
        }
        let names = || self.agents.iter().map(String::as_str);
        // The robot was left out, or it is a slip of the keyboard.
        let of_robot = || names().find(|a| a.split('@').next() == Some(agent));
        Err(match of_robot().or_else(|| did_you_mean(agent, names())) {
            Some(near) => format!("there is no agent `{agent}`; did you mean `{near}`?"),
            None => format!("there is no agent `{agent}`; one is `{}`", self.example()),
        })
    }

    fn set(&self, setting: &str) -> Result<Operation, String> {
        let Some((name, value)) = setting.split_once('=').map(|(n, v)| (n.trim(), v.trim())) else {
            return Err("a parameter is set as `set NAME=VALUE`".into());
        };
        if name.is_empty() || value.is_empty() {
            return Err("a parameter is set as `set NAME=VALUE`".into());
        }
        let graph = self.mission.graph();
        let (index, value) = compile::setting(graph, "set", name, value).map_err(|refusal| {
            let d = refusal.findings.diagnostics.into_iter().next();
            d.map_or_else(String::new, |d| {
                let seen = d.labels.first().filter(|_| d.code == "S9010").map_or(d.title, |l| l.text.clone());
                d.hint.map_or(seen.clone(), |hint| format!("{seen}; {hint}"))
            })
        })?;
        let registers = self.mission.parameter(index, &value)?;
        Ok(Operation::Set { param: name.to_string(), registers })
    }

    fn example(&self) -> &str {
        self.agents.first().map_or("AGENT@ROBOT", String::as_str)
    }
}
