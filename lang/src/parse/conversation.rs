//! Protocols and conversations.

use super::{Builder, Cursor, Rule};
use crate::ast::*;
use pest::iterators::Pair;

type P<'i> = Pair<'i, Rule>;

impl Builder {
    pub fn protocol(&mut self, p: P<'_>) -> Protocol {
        let mut c = Cursor::new(p);
        let name = self.ident(&mut c);
        let contents = self.contents(&mut c);
        let params = self.params(&mut c);
        let states = c.all(Rule::protocol_state).into_iter().map(|p| self.protocol_state(p)).collect();
        Protocol { name, contents, params, states }
    }

    /// Names between angle brackets.
    fn contents(&mut self, c: &mut Cursor<'_>) -> Vec<Ident> {
        let list = c.take(Rule::protocol_contents).map(|p| Cursor::new(p).all(Rule::ident));
        list.unwrap_or_default().iter().map(|p| self.name(p)).collect()
    }

    fn protocol_state(&mut self, p: P<'_>) -> ProtocolState {
        let mut c = Cursor::new(p);
        let mut s = ProtocolState { name: self.ident(&mut c), moves: Vec::new(), timeouts: Vec::new() };
        while let Some(p) = c.any() {
            let rule = p.as_rule();
            let mut c = Cursor::new(p);
            if rule == Rule::protocol_timeout {
                s.timeouts.push((self.expr_in(&mut c), self.ident(&mut c)));
                continue;
            }
            let (by, performative) = (self.ident(&mut c), self.ident(&mut c));
            let third = self.ident(&mut c);
            let (content, target) = match c.take(Rule::ident) {
                Some(p) => (Some(third), self.name(&p)),
                None => (None, third),
            };
            s.moves.push(ProtocolMove { by, performative, content, target });
        }
        s
    }

    pub fn conversation(&mut self, p: P<'_>) -> Conversation {
        let mut c = Cursor::new(p);
        let (name, protocol) = (self.ident(&mut c), self.ident(&mut c));
        let contents = self.contents(&mut c);
        let args = c.take(Rule::args).map(|a| self.args(a)).unwrap_or_default();
        let channel = c.take(Rule::ident).map(|m| {
            let model = self.name(&m);
            (model, c.take(Rule::args).map(|a| self.args(a)).unwrap_or_default())
        });
        Conversation { name, protocol, contents, args, channel }
    }
}
