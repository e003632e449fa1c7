//! Protocols and conversations: a conversation is a protocol with records for its contents and durations for
//! its time-outs.

use crate::{
    ast, code,
    decls::unknown,
    modules::Program,
    typed::{Body, Checker, Place},
};
use soifra_graph::{
    Conversation, Diagnostic, Dim, Expr, Name, Op, ProtocolMove, ProtocolState, Role, Span, Type,
};

impl<'a> Checker<'a> {
    /// Every protocol by itself, then every conversation.
    pub(super) fn conversations(&mut self, program: &Program) {
        for p in self.decls.protocols.values().copied() {
            let before = self.errors.len();
            self.protocol(p);
            if self.errors.len() > before {
                self.poison(&p.name.name);
            }
        }
        for c in self.decls.conversations.clone() {
            match self.conversation(c, program) {
                Some(lowered) => self.conversations.push(lowered),
                None => self.poison(&c.name.name),
            }
        }
    }

    /// Names of a protocol's states, roles, performatives and contents.
    fn protocol(&mut self, p: &'a ast::Protocol) {
        self.distinct(p.states.iter().map(|s| &s.name));
        self.distinct(p.contents.iter().chain(p.params.iter().map(|(n, _)| n)));
        let names: Vec<&str> = p.states.iter().map(|s| &*s.name.name).collect();
        for (i, s) in p.states.iter().enumerate() {
            for m in &s.moves {
                if role(&m.by.name).is_none() {
                    let d = unknown(
                        code::UNKNOWN_NAME,
                        "role",
                        &m.by.name,
                        m.by.span,
                        ["initiator", "participant"],
                    );
                    self.report(d);
                } else if i == 0 && role(&m.by.name) != Some(Role::Initiator) {
                    self.report(
                        Diagnostic::error(code::PROTOCOL, "a participant cannot begin")
                            .at(m.by.span, "speaks in the first state")
                            .at(s.name.span, "nobody has said anything yet")
                            .hint("the initiator opens a conversation: begin with one of its messages"),
                    );
                }
                self.performative(&m.performative);
                let known = p.contents.iter().map(|c| &c.name).chain(self.decls.records.keys());
                if let Some(c) = &m.content
                    && !known.clone().any(|k| *k == c.name)
                {
                    let d = unknown(code::UNKNOWN_NAME, "content", &c.name, c.span, known.map(|k| &**k));
                    self.report(d);
                }
                self.state_of(&names, &m.target);
            }
            for (_, to) in &s.timeouts {
                self.state_of(&names, to);
            }
            if let [_, (second, _), ..] = s.timeouts.as_slice() {
                self.report(
                    Diagnostic::error(code::PROTOCOL, format!("state `{}` has two time-outs", s.name.name))
                        .at(second.span, "the second")
                        .hint("keep the one that comes first"),
                );
            }
        }
    }

    fn state_of(&mut self, names: &[&str], to: &ast::Ident) {
        if !names.contains(&&*to.name) {
            let d = unknown(code::UNKNOWN_NAME, "state", &to.name, to.span, names.iter().copied());
            self.report(d);
        }
    }

    fn conversation(&mut self, c: &'a ast::Conversation, program: &Program) -> Option<Conversation> {
        let Some(p) = self.decls.protocols.get(&c.protocol.name).copied() else {
            let known = self.decls.protocols.keys().map(|k| &**k);
            let d = unknown(code::UNKNOWN_NAME, "protocol", &c.protocol.name, c.protocol.span, known);
            let standard = ["request", "query", "subscribe", "contract_net"].contains(&&*c.protocol.name);
            let d = if standard { d.hint("add `import std.protocols`") } else { d };
            self.report(d);
            return None;
        };
        if self.poisoned.contains_key(&p.name.name) {
            return None;
        }
        let contents = self.contents(c, p)?;
        let mut params = Vec::new();
        for (n, t) in &p.params {
            params.push((n.name.clone(), self.resolve_type(t, None)?));
        }
        let (args, _) = self.in_body(Body::new(Place::Start), |s| {
            s.arguments(&c.protocol, &params, &c.args, c.protocol.span)
        });
        let args = args?;
        let index = |name: &Name| p.states.iter().position(|s| s.name.name == *name).map(|i| i as u32);
        let mut states = Vec::new();
        for s in &p.states {
            let mut moves = Vec::new();
            for m in &s.moves {
                let content = m.content.as_ref().map(|c| {
                    let given = contents.iter().find(|(n, _)| *n == c.name);
                    given.map_or_else(|| c.name.clone(), |(_, record)| record.clone())
                });
                moves.push(ProtocolMove {
                    by: role(&m.by.name)?,
                    performative: m.performative.name.clone(),
                    content,
                    target: index(&m.target.name)?,
                    at: Span { end: m.target.span.end, ..m.by.span },
                });
            }
            let timeout = match s.timeouts.first() {
                Some((after, to)) => Some((self.timeout(after, &params, &args)?, index(&to.name)?)),
                None => None,
            };
            states.push(ProtocolState { name: s.name.name.clone(), moves, timeout, at: s.name.span });
        }
        let model = ast::Ident { name: "channel".into(), span: c.name.span };
        let (model, channel): (&ast::Ident, &[ast::Arg]) = match &c.channel {
            Some((m, a)) => (m, a),
            None => (&model, &[]),
        };
        let channel =
            self.channel(&"conversation".into(), c.name.name.clone(), None, model, channel, c.name.span)?;
        let path = program.sources.get(c.name.span.file as usize).map_or("", |s| s.path.as_str());
        let file = path.rsplit('/').next().unwrap_or_default();
        Some(Conversation {
            name: c.name.name.clone(),
            protocol: p.name.name.clone(),
            ontology: file.strip_suffix(".soi").unwrap_or(file).into(),
            states,
            channel,
            at: c.name.span,
        })
    }

    /// The records that stand for the contents of a protocol.
    fn contents(&mut self, c: &'a ast::Conversation, p: &'a ast::Protocol) -> Option<Vec<(Name, Name)>> {
        if c.contents.len() != p.contents.len() {
            let names: Vec<&str> = p.contents.iter().map(|c| &*c.name).collect();
            self.report(
                Diagnostic::error(
                    code::ARGUMENTS,
                    format!("`{}` has {} contents, {} are given", p.name.name, names.len(), c.contents.len()),
                )
                .at(c.protocol.span, format!("wants records for {}", names.join(", ")))
                .hint(format!(
                    "write `{}<{}>` with records in their places",
                    p.name.name,
                    names.join(", ")
                )),
            );
            return None;
        }
        let mut out = Vec::new();
        for (given, wanted) in c.contents.iter().zip(&p.contents) {
            if !self.types.records.contains_key(&given.name) {
                let known: Vec<Name> = self.types.records.keys().cloned().collect();
                let known = known.iter().map(|k| &**k);
                let d = unknown(code::UNKNOWN_NAME, "record", &given.name, given.span, known);
                self.report(d);
                return None;
            }
            out.push((wanted.name.clone(), given.name.clone()));
        }
        Some(out)
    }

    /// A time-out with the arguments of the protocol written out.
    fn timeout(&mut self, e: &ast::Expr, params: &[(Name, Type)], args: &[Expr]) -> Option<Expr> {
        let mut body = Body::new(Place::Start);
        for (n, t) in params {
            body.bind(&ast::Ident { name: n.clone(), span: e.span }, t);
        }
        let (value, _) = self.in_body(body, |c| c.typed(e, &Type::Quantity(Dim::TIME)));
        Some(value?.replaced(&|op| match op {
            Op::Local(i) => args.get(*i as usize).cloned(),
            _ => None,
        }))
    }
}

fn role(name: &str) -> Option<Role> {
    match name {
        "initiator" => Some(Role::Initiator),
        "participant" => Some(Role::Participant),
        _ => None,
    }
}
