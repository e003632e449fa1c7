//! Has every conversation partners, is everything that is said heard, and can nobody wait for ever?

use super::walk;
use crate::{
    code,
    conversation::{
        self as analysis, Action, Explored, Fault, Finding, MOST, Move, Party, Protocol, Queues, Silence,
        State, Step,
    },
};
use soifra_graph::{
    Agent, Component, Conversation, Diagnostic, Expr, Graph, Name, Op, Role, Severity, Span, Stmt, StmtKind,
    Talk, Trigger, Unit, Value,
};

/// Checks every conversation that agents of robots and hosts have.
pub fn check(g: &Graph) -> Vec<Diagnostic> {
    let mut out = Vec::new();
    let used = super::used_agents(g);
    let agents: Vec<&Agent> = g.agents.iter().zip(&used).filter(|(_, u)| **u).map(|(a, _)| a).collect();
    for (i, c) in g.conversations.iter().enumerate() {
        let of = Speakers::new(c, i as u32, &agents);
        let structure = structure(c);
        let sound = structure.is_empty();
        out.extend(structure);
        if of.openers.is_empty() && of.offerers.is_empty() {
            continue;
        }
        let partners = of.partners();
        let complete = partners.is_empty();
        out.extend(partners);
        if !complete {
            continue;
        }
        out.extend(of.unheard());
        if sound {
            out.extend(of.stuck(&g.faults));
        }
    }
    out
}

/// What a protocol's states already tell.
fn structure(c: &Conversation) -> Vec<Diagnostic> {
    let names = Names::new(c);
    let state = |i: u32| c.states.get(i as usize);
    let at = |i: u32| state(i).map_or(c.at, |s| s.at);
    let name = |i: u32| state(i).map_or("?", |s| &*s.name);
    let mut out = Vec::new();
    for f in analysis::faults(&names.protocol) {
        out.push(match f {
            Fault::Unreachable { state } => Diagnostic::error(
                code::PROTOCOL,
                format!("state `{}` of `{}` cannot be reached", name(state), c.protocol),
            )
            .at(at(state), "nothing leads here")
            .hint("add a message that leads here, or remove it"),
            Fault::Endless { state } => Diagnostic::error(
                code::PROTOCOL,
                format!("from state `{}` of `{}` no end is reached", name(state), c.protocol),
            )
            .at(at(state), "no way out leads to a state without messages")
            .hint("let a message or a time-out lead to a last state: `state done`"),
            Fault::Ambiguous { state, role, message } => {
                Diagnostic::error(code::PROTOCOL, format!("`{}` leads to two states", names.message(message)))
                    .at(at(state), format!("the {} says it twice here", word(role)))
                    .hint("keep one of them, or use another performative")
            }
            Fault::Livelock { states, .. } => {
                let first = states.first().copied().unwrap_or(0);
                Diagnostic::error(code::PROTOCOL, format!("time-outs of `{}` go round in a ring", c.protocol))
                    .at(at(first), "comes back here without a message")
                    .hint("let one of them lead to a last state")
            }
        });
    }
    // A ring has no end: told once.
    let mut seen = std::collections::BTreeSet::new();
    out.retain(|d: &Diagnostic| seen.insert(d.position()));
    out
}

fn word(role: analysis::Role) -> &'static str {
    match role {
        analysis::Role::Initiator => "initiator",
        analysis::Role::Participant => "participant",
    }
}

/// The protocol as the analysis wants it: messages are numbered.
struct Names {
    messages: Vec<Name>,
    protocol: Protocol,
}

impl Names {
    fn new(c: &Conversation) -> Self {
        let mut messages: Vec<Name> = Vec::new();
        let mut number = |n: &Name| {
            messages.iter().position(|m| m == n).unwrap_or_else(|| {
                messages.push(n.clone());
                messages.len() - 1
            }) as u32
        };
        let role = |r: Role| match r {
            Role::Initiator => analysis::Role::Initiator,
            Role::Participant => analysis::Role::Participant,
        };
        let state = |s: &soifra_graph::ProtocolState| State {
            moves: s
                .moves
                .iter()
                .map(|m| Move { by: role(m.by), message: number(&m.performative), target: m.target })
                .collect(),
            timeout: s.timeout.as_ref().map(|t| t.1),
        };
        let states = c.states.iter().map(state).collect();
        Names { messages, protocol: Protocol { states } }
    }

    fn message(&self, number: u32) -> &str {
        self.messages.get(number as usize).map_or("?", |m| m)
    }
}

/// An agent and what it says of a conversation.
struct Speaker<'g> {
    agent: &'g Agent,
    /// Performatives that it says, and where.
    says: Vec<(&'g Name, Span)>,
    /// Units for what may happen in it.
    hears: Vec<(&'g Unit, &'g Talk, u32)>,
}

/// Who has a conversation.
struct Speakers<'g> {
    c: &'g Conversation,
    openers: Vec<Speaker<'g>>,
    offerers: Vec<Speaker<'g>>,
}

impl<'g> Speakers<'g> {
    fn new(c: &'g Conversation, index: u32, agents: &[&'g Agent]) -> Self {
        let (mut openers, mut offerers) = (Vec::new(), Vec::new());
        for a in agents {
            let (mut says, mut opens) = (Vec::new(), false);
            for s in a.units.iter().flat_map(walk::statements) {
                match &s.kind {
                    StmtKind::Open(o) if o.conversation == index => {
                        opens = true;
                        says.push((&o.performative, s.at));
                    }
                    StmtKind::Reply(r) if r.conversation == index => says.push((&r.performative, s.at)),
                    _ => {}
                }
            }
            let hears: Vec<_> = a
                .units
                .iter()
                .filter_map(|u| match &u.trigger {
                    Trigger::Talk { conversation, what, thread, .. } if *conversation == index => {
                        Some((u, what, *thread))
                    }
                    _ => None,
                })
                .collect();
            let offers = a.offers.iter().any(|o| o.name == c.name);
            if opens {
                openers.push(Speaker { agent: a, says: says.clone(), hears: hears.clone() });
            }
            if offers {
                offerers.push(Speaker { agent: a, says, hears });
            } else if !(opens || says.is_empty() && hears.is_empty()) {
                // Takes part without a part: told below.
                openers.push(Speaker { agent: a, says, hears });
            }
        }
        Speakers { c, openers, offerers }
    }

    /// Conversations that nobody opens, or nobody offers.
    fn partners(&self) -> Vec<Diagnostic> {
        let name = &self.c.name;
        let opening = |s: &&Speaker<'_>| {
            let first = self.c.states.first();
            s.says.iter().any(|(p, _)| first.is_some_and(|f| f.move_of(Role::Initiator, p).is_some()))
        };
        let mut out = Vec::new();
        match (self.openers.iter().find(opening), self.offerers.first()) {
            (Some(o), None) => {
                let at = o.says.first().map_or(o.agent.span, |s| s.1);
                out.push(
                    Diagnostic::error(code::NOBODY, format!("nobody offers `{name}`"))
                        .at(at, "opened here")
                        .hint(format!(
                            "add `offers {name}` to the agent that answers, and let a robot or host run it"
                        )),
                );
            }
            (None, Some(p)) => {
                let offer = p.agent.offers.iter().find(|o| o.name == *name);
                out.push(
                    Diagnostic::error(code::NOBODY, format!("nobody opens `{name}`"))
                        .at(offer.map_or(p.agent.span, |o| o.span), "offered here")
                        .hint(format!("add `open {name} … to offering({name})` to the agent that wants it")),
                );
            }
            (None, None) => {
                let speaker = self.openers.first();
                let at = speaker.map_or(self.c.at, |s| s.agent.span);
                out.push(
                    Diagnostic::error(code::NOBODY, format!("nobody opens or offers `{name}`"))
                        .at(at, "takes part in it")
                        .hint(format!(
                            "one agent offers it, another opens it: `offers {name}`, `open {name} …`"
                        )),
                );
            }
            (Some(_), Some(_)) => {}
        }
        out
    }

    /// Contents that are said to an agent that does not listen, and messages that are awaited from agents
    /// that do not say them.
    fn unheard(&self) -> Vec<Diagnostic> {
        let mut out: Vec<Diagnostic> = Vec::new();
        let sides = [
            (Role::Initiator, &self.openers, &self.offerers),
            (Role::Participant, &self.offerers, &self.openers),
        ];
        for (role, speakers, listeners) in sides {
            let of_role = |p: &Name| {
                self.c.states.iter().flat_map(|s| &s.moves).find(|m| m.by == role && m.performative == *p)
            };
            for s in speakers {
                for (p, at) in &s.says {
                    let Some(m) = of_role(p) else { continue };
                    let Some(record) = &m.content else { continue };
                    for l in listeners {
                        let listens = l.hears.iter().any(|(_, what, _)| matches!(what, Talk::Message { performative, .. } if performative == *p));
                        if !listens {
                            out.push(
                                Diagnostic::error(
                                    code::UNREAD_TOPIC,
                                    format!(
                                        "`{}` does not listen to {p} {record} of `{}`",
                                        l.agent.name, self.c.name
                                    ),
                                )
                                .at(*at, "said here")
                                .at(l.agent.span, "has no unit for it")
                                .hint(format!("add a unit `on {} {p}(m)` to it", self.c.name)),
                            );
                        }
                    }
                }
            }
            for l in listeners {
                for (u, what, _) in &l.hears {
                    let Talk::Message { performative: p, .. } = what else { continue };
                    if of_role(p).is_none() || speakers.is_empty() {
                        continue;
                    }
                    let heard_of_other = speakers.iter().any(|s| s.says.iter().any(|(q, _)| *q == p));
                    let by_runtime = **p == *"not_understood" || **p == *"failure";
                    if !heard_of_other && !by_runtime {
                        out.push(
                            Diagnostic::error(
                                code::UNPUBLISHED_TOPIC,
                                format!("nobody says {p} in `{}`", self.c.name),
                            )
                            .at(u.span, "waits for it")
                            .hint(format!("add `reply {p} …` to the agent that answers, or remove the unit")),
                        );
                    }
                }
            }
        }
        let mut seen = std::collections::BTreeSet::new();
        out.retain(|d| seen.insert((d.code, d.position(), d.title.clone())));
        out
    }

    /// Explores what every opener can have with every offerer.
    fn stuck(&self, faults: &[Component]) -> Vec<Diagnostic> {
        let names = Names::new(self.c);
        let number = |name: &str| {
            let e = self.c.channel.args.iter().find(|(n, _)| &**n == name).map(|(_, e)| e);
            e.and_then(Expr::as_const).and_then(Value::number)
        };
        // What is not known before the run may be anything.
        let lossy = number("loss").is_none_or(|l| l > 0.0);
        let capacity = number("capacity").map_or(1, |c| (c as usize).clamp(1, 16));
        let mut out = self.stuck_with(&names, Queues { capacity: [capacity; 2], lossy });
        // What gets stuck only by a declared fault may be what the fault is there to show.
        if let Some(fault) = faults.iter().find(|f| drops(f, &self.c.name)).filter(|_| !lossy) {
            for mut d in self.stuck_with(&names, Queues { capacity: [capacity; 2], lossy: true }) {
                if !out.iter().any(|o| o.code == d.code && o.position() == d.position()) {
                    d.severity = Severity::Warning;
                    out.push(d.at(fault.at, "this fault loses messages of it"));
                }
            }
        }
        out
    }

    /// As [`Self::stuck`], with such queues between them.
    fn stuck_with(&self, names: &Names, queues: Queues) -> Vec<Diagnostic> {
        let mut out: Vec<Diagnostic> = Vec::new();
        for a in &self.openers {
            for b in &self.offerers {
                let parties =
                    [self.party(names, a, Role::Initiator), self.party(names, b, Role::Participant)];
                let explored = analysis::explore(&names.protocol, &parties, queues, MOST);
                for d in self.told(names, [a, b], &explored) {
                    if !out.iter().any(|o| o.code == d.code && o.position() == d.position()) {
                        out.push(d);
                    }
                }
            }
        }
        out
    }

    /// What an agent's program does in each state of its copy.
    fn party(&self, names: &Names, s: &Speaker<'_>, role: Role) -> Party {
        let (mut can, mut silent) = (Vec::new(), Vec::new());
        for (i, state) in self.c.states.iter().enumerate() {
            let own = state.moves.iter().filter(|m| m.by == role);
            let says = |m: &&soifra_graph::ProtocolMove| s.says.iter().any(|(p, _)| **p == m.performative);
            let number = |m: &soifra_graph::ProtocolMove| {
                names.messages.iter().position(|n| *n == m.performative).map(|n| n as u32)
            };
            can.push(own.clone().filter(says).filter_map(number).collect());
            silent.push(self.may_be_silent(s, role, i as u32));
        }
        Party { can, silent }
    }

    /// Whether the agent may come into a state in which it is to speak, and neither speak at once on every
    /// path nor keep the conversation for later.
    fn may_be_silent(&self, s: &Speaker<'_>, role: Role, state: u32) -> bool {
        let leading = self.c.states.iter().flat_map(|s| &s.moves);
        let leading: Vec<_> = leading.filter(|m| m.by == role.other() && m.target == state).collect();
        leading.iter().any(|m| {
            let mut units = s.hears.iter().filter(
                |(_, what, _)| matches!(what, Talk::Message { performative, .. } if *performative == m.performative),
            );
            units.next().is_some_and(|(unit, _, thread)| {
                let statements = walk::statements(unit);
                let replies = statements.iter().any(|s| speaks(s, *thread));
                replies && !kept(unit, *thread) && !answers(body(unit), *thread)
            })
        })
    }

    /// The unit of a speaker that a message into a state releases.
    fn unit_into(&self, s: &Speaker<'_>, state: u32) -> Option<Span> {
        let moves = self.c.states.iter().flat_map(|s| &s.moves).filter(|m| m.target == state);
        let names: Vec<&Name> = moves.map(|m| &m.performative).collect();
        s.hears.iter().find_map(|(u, what, _)| match what {
            Talk::Message { performative, .. } if names.contains(&performative) => Some(u.span),
            _ => None,
        })
    }

    fn told(&self, names: &Names, speakers: [&Speaker<'_>; 2], e: &Explored) -> Vec<Diagnostic> {
        let who = |r: analysis::Role| &*speakers[r.index()].agent.name;
        let state = |i: u32| self.c.states.get(i as usize);
        let at = |i: u32| state(i).map_or(self.c.at, |s| s.at);
        let name = |i: u32| state(i).map_or("?", |s| &*s.name);
        let mut out = Vec::new();
        for f in &e.findings {
            match f {
                Finding::Stuck { waits, witness } => {
                    if waits.iter().any(|w| w.unexpected.is_some()) {
                        continue;
                    }
                    let to_speak = |w: &&analysis::Wait| w.silence != Silence::OthersTurn;
                    let Some(w) = waits.iter().find(to_speak).or(waits.first()) else { continue };
                    let title = format!(
                        "`{}` can wait for ever in state `{}` of `{}`",
                        who(w.role),
                        name(w.state),
                        self.c.name
                    );
                    let label = why(names, who(w.role), who(w.role.other()), w);
                    let speaker = speakers[w.role.index()];
                    // What is to be mended comes first.
                    let mut d = Diagnostic::error(code::STUCK, title);
                    d = match w.silence {
                        Silence::Chosen | Silence::Unable => {
                            let unit = self.unit_into(speaker, w.state);
                            d.at(unit.unwrap_or(speaker.agent.span), label)
                                .at(at(w.state), "is to speak in this state")
                        }
                        _ => d.at(at(w.state), label),
                    };
                    d = d.at(self.c.at, history(names, &who, witness));
                    out.push(d.hint(match w.silence {
                        Silence::Unable => "let it say one of the messages of this state, or give the state a time-out: `after 5 s -> …`",
                        Silence::Chosen => "answer on every path, or give the state a time-out: `after 5 s -> …`",
                        _ => "give the state a time-out: `after 5 s -> …`",
                    }));
                }
                Finding::Unexpected { role, state: s, message, witness } => out.push(
                    Diagnostic::error(
                        code::STUCK,
                        format!(
                            "`{}` may come when `{}` does not expect it",
                            names.message(*message),
                            who(*role)
                        ),
                    )
                    .at(
                        at(*s),
                        format!("is in this state, which does not have `{}`", names.message(*message)),
                    )
                    .at(self.c.at, history(names, &who, witness))
                    .hint(format!(
                        "add `{}` to the state, or let nobody say it there",
                        names.message(*message)
                    )),
                ),
                Finding::NotProven { seen } => out.push(
                    Diagnostic::warning(code::STUCK, format!("`{}` is not proven to end", self.c.name))
                        .at(self.c.at, format!("{seen} situations were looked at, there are more"))
                        .hint("fewer states, or a smaller `capacity` of its channel"),
                ),
            }
        }
        out
    }
}

/// Whether a fault loses messages of a conversation.
fn drops(fault: &Component, conversation: &str) -> bool {
    let of = fault.args.iter().find(|(n, _)| &**n == "of").and_then(|(_, e)| e.as_const());
    *fault.model == *"drop" && matches!(of, Some(Value::Text(t)) if **t == *conversation)
}

/// Why a side waits.
fn why(names: &Names, me: &str, other: &str, w: &analysis::Wait) -> String {
    let awaited: Vec<String> = w.awaited.iter().map(|m| format!("`{}`", names.message(*m))).collect();
    match w.silence {
        Silence::Unable => format!("`{me}` is to speak here and has nothing to say"),
        Silence::Chosen => format!("`{me}` does not answer on every path"),
        Silence::QueueFull => format!("the mailbox of `{other}` is full"),
        Silence::OthersTurn if awaited.is_empty() => "nothing is to come".into(),
        Silence::OthersTurn => format!("waits for {} of `{other}`", awaited.join(" or ")),
    }
}

/// How it came to that, in short.
fn history<'s>(names: &Names, who: &dyn Fn(analysis::Role) -> &'s str, witness: &[Step]) -> String {
    let step = |s: &Step| {
        let me = who(s.by);
        match s.action {
            Action::Sends(m) => format!("{me} says {}", names.message(m)),
            Action::Receives(m) => format!("{me} hears {}", names.message(m)),
            Action::Drops(m) => format!("{me} drops {}", names.message(m)),
            Action::Loses(m) => format!("{} is lost", names.message(m)),
            Action::TimesOut => format!("{me} has waited too long"),
        }
    };
    match witness.len() {
        0 => "from the beginning".into(),
        _ => witness.iter().map(step).collect::<Vec<_>>().join(", "),
    }
}

fn body(u: &Unit) -> &[Stmt] {
    match &u.kind {
        soifra_graph::UnitKind::Service(body) => body,
        _ => &[],
    }
}

/// Whether a statement says something in the conversation at hand.
fn speaks(s: &Stmt, thread: u32) -> bool {
    matches!(&s.kind, StmtKind::Reply(r) if r.thread.op == Op::Local(thread))
}

/// Whether the conversation at hand is used for something else than to reply at once.
fn kept(u: &Unit, thread: u32) -> bool {
    let (mut named, mut replied) = (0usize, 0usize);
    walk::unit(u, &mut |e| named += usize::from(e.op == Op::Local(thread)));
    for s in walk::statements(u) {
        replied += usize::from(speaks(s, thread));
    }
    // Other behaviour than a plain service may come back to it at a later activation.
    named > replied || !matches!(u.kind, soifra_graph::UnitKind::Service(_))
}

/// Whether statements say something in the conversation at hand on every path.
fn answers(stmts: &[Stmt], thread: u32) -> bool {
    stmts.iter().any(|s| match &s.kind {
        StmtKind::Reply(_) => speaks(s, thread),
        StmtKind::If(_, a, b) => answers(a, thread) && answers(b, thread),
        StmtKind::IfSome { then, otherwise, .. } => answers(then, thread) && answers(otherwise, thread),
        StmtKind::Switch { arms, rest, .. } => {
            arms.iter().all(|(_, b)| answers(b, thread)) && rest.as_ref().is_none_or(|b| answers(b, thread))
        }
        StmtKind::Rules(rules) => {
            rules.iter().any(|r| r.guard.is_empty()) && rules.iter().all(|r| answers(&r.body, thread))
        }
        _ => false,
    })
}
