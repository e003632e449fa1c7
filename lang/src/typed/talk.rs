//! What is said in conversations.

use super::Checker;
use crate::{ast::*, code, decls::unknown};
use soifra_graph::{Diagnostic, Expr as GExpr, Name, Op, Open, Reply, Role, StmtKind as GStmtKind, Type};

impl Checker<'_> {
    /// `open conversation performative content to agents within T`
    pub(super) fn open(
        &mut self,
        conversation: &Ident,
        performative: &Ident,
        [content, to, within]: [Option<&Expr>; 3],
    ) -> Option<GStmtKind> {
        let Some(i) = self.conversations.position(&conversation.name) else {
            let names: Vec<Name> = self.conversations.iter().map(|c| c.name.clone()).collect();
            let known = names.iter().map(|n| &**n);
            let d = unknown(code::UNKNOWN_NAME, "conversation", &conversation.name, conversation.span, known);
            self.report(d);
            return None;
        };
        let carried = self.carried(i, performative)?;
        let first = self.conversations[i].states.first();
        let opens = |p: &str| first.is_some_and(|s| s.move_of(Role::Initiator, p).is_some());
        if !opens(&performative.name) {
            let known = first.into_iter().flat_map(|s| &s.moves).map(|m| format!("`{}`", m.performative));
            let known = known.collect::<Vec<_>>().join(" or ");
            let d = Diagnostic::error(
                code::MESSAGE,
                format!("`{}` does not open `{}`", performative.name, conversation.name),
            )
            .at(performative.span, "cannot come first");
            self.report(d.hint(format!("its protocol begins with {known}")));
            return None;
        }
        let first = first.cloned();
        let content = self.message_content(performative, carried.as_ref(), content)?;
        let to = self.expr(to?, None)?;
        let fits = match &to.ty {
            Type::Agent => true,
            Type::List(item, _) => **item == Type::Agent,
            _ => false,
        };
        if !fits {
            self.report(
                Diagnostic::error(code::MISMATCH, format!("Agent is wanted, this is {}", to.ty))
                    .at(to.span, to.ty.to_string())
                    .hint(format!("ask the directory: `to offering({})`", conversation.name)),
            );
            return None;
        }
        let waits = first
            .as_ref()
            .and_then(|s| s.move_of(Role::Initiator, &performative.name))
            .and_then(|m| self.conversations[i].states.get(m.target as usize))
            .is_some_and(|s| s.holds_timeout(Role::Initiator));
        if let (Some(w), false) = (within, waits) {
            let d = Diagnostic::error(code::MESSAGE, "nobody waits here")
                .at(w.span, "longest wait for an answer")
                .hint("give the state that it leads to a time-out in the protocol: `after … -> …`");
            self.report(d);
            return None;
        }
        let within = match within {
            Some(w) => Some(self.typed(w, &Type::Quantity(soifra_graph::Dim::TIME))?),
            None => None,
        };
        let performative = performative.name.clone();
        Some(GStmtKind::Open(Box::new(Open { conversation: i as u32, performative, content, to, within })))
    }

    /// `reply performative content in conversation`
    pub(super) fn reply(
        &mut self,
        performative: &Ident,
        content: Option<&Expr>,
        reason: Option<String>,
        thread: Option<&Expr>,
    ) -> Option<GStmtKind> {
        let thread = match thread {
            Some(t) => self.expr(t, None)?,
            None => match self.body.thread {
                Some((i, local)) => {
                    let ty = Type::Conversation(self.conversations[i as usize].name.clone());
                    GExpr::new(Op::Local(local), Vec::new(), ty, performative.span)
                }
                None => {
                    self.report(
                        Diagnostic::error(code::MESSAGE, "reply to whom?")
                            .at(performative.span, "no conversation is at hand")
                            .hint("keep `conversation` in a state when its message comes, and write `reply … in STATE`"),
                    );
                    return None;
                }
            },
        };
        let Type::Conversation(name) = &thread.ty else {
            let d =
                Diagnostic::error(code::MISMATCH, format!("a conversation is wanted, this is {}", thread.ty))
                    .at(thread.span, thread.ty.to_string());
            self.report(match &thread.ty {
                Type::Option(_) => d.hint("take it out first: `when STATE is some(c) => reply … in c`"),
                _ => d.hint("in a unit `on CONVERSATION …` it is called `conversation`"),
            });
            return None;
        };
        let i = self.conversations.position(name)?;
        let carried = self.carried(i, performative)?;
        let content = self.message_content(performative, carried.as_ref(), content)?;
        let reply = Reply {
            conversation: i as u32,
            performative: performative.name.clone(),
            content,
            reason,
            thread,
        };
        Some(GStmtKind::Reply(Box::new(reply)))
    }

    /// What a message carries, as its protocol wants it.
    #[allow(
        clippy::option_option,
        reason = "outer: whether it is right, inner: whether there is one; 2026-11"
    )]
    fn message_content(
        &mut self,
        performative: &Ident,
        wanted: Option<&Name>,
        given: Option<&Expr>,
    ) -> Option<Option<GExpr>> {
        match (wanted, given) {
            (Some(record), Some(e)) => Some(Some(self.typed(e, &Type::Record(record.clone()))?)),
            (None, None) => Some(None),
            (Some(record), None) => {
                self.report(
                    Diagnostic::error(code::MESSAGE, format!("`{}` carries {record}", performative.name))
                        .at(performative.span, "nothing is said")
                        .hint(format!("write `{} {record}(…)`", performative.name)),
                );
                None
            }
            (None, Some(e)) => {
                self.report(
                    Diagnostic::error(code::MESSAGE, format!("`{}` carries nothing", performative.name))
                        .at(e.span, "too much")
                        .hint("leave it out; a reason can be given as a text"),
                );
                None
            }
        }
    }
}
