//! What a program declares beside agents: types, parameters, interfaces, topics.

use crate::{
    ast::{self, MissionMember as M},
    code,
    typed::{Body, Checker, Place},
};
use soifra_graph::{Diagnostic, Name, Param, Topic, Type, Value, component::WORLD_ROLES};
use std::collections::BTreeSet;

impl<'a> Checker<'a> {
    /// Enums, then records in an order that finds rings.
    pub(super) fn types(&mut self) {
        for (name, e) in &self.decls.enums {
            self.distinct(e.variants.iter());
            let variants = e.variants.iter().map(|v| v.name.clone()).collect();
            self.add_enum(name, variants);
        }
        for name in self.decls.records.keys() {
            self.types
                .records
                .insert(name.clone(), soifra_graph::Record { name: name.clone(), fields: Vec::new() });
        }
        for (name, r) in &self.decls.records {
            self.distinct(r.fields.iter().map(|(n, _)| n));
            let mut fields = Vec::new();
            for (n, t) in &r.fields {
                match self.resolve_type(t, None) {
                    Some(ty) => fields.push((n.name.clone(), ty)),
                    None => self.poison(&n.name),
                }
            }
            self.types.records.insert(name.clone(), soifra_graph::Record { name: name.clone(), fields });
        }
        for (name, r) in &self.decls.records {
            if self.holds_itself(name) {
                let d = Diagnostic::error(code::RECURSION, format!("record `{name}` holds itself"))
                    .at(r.name.span, "its size would have no end")
                    .hint("take the field out that leads back");
                self.report(d);
                r.fields.iter().for_each(|(n, _)| self.poison(&n.name));
                self.types
                    .records
                    .insert(name.clone(), soifra_graph::Record { name: name.clone(), fields: Vec::new() });
            }
        }
    }

    /// Whether a record holds itself, directly or through others.
    pub(super) fn holds_itself(&self, name: &Name) -> bool {
        fn inside(t: &Type, out: &mut Vec<Name>) {
            match t {
                Type::Record(n) => out.push(n.clone()),
                Type::List(t, _) | Type::Option(t) => inside(t, out),
                _ => {}
            }
        }
        let mut seen: BTreeSet<Name> = BTreeSet::new();
        let mut waiting = vec![name.clone()];
        while let Some(outer) = waiting.pop() {
            let mut parts = Vec::new();
            if let Some(r) = self.types.records.get(&outer) {
                r.fields.iter().for_each(|(_, t)| inside(t, &mut parts));
            }
            if parts.contains(name) {
                return true;
            }
            waiting.extend(parts.into_iter().filter(|p| seen.insert(p.clone())));
        }
        false
    }

    pub(super) fn params(&mut self, mission: Option<&'a ast::Mission>) -> Vec<Param> {
        let own = mission
            .into_iter()
            .flat_map(|m| &m.members)
            .filter_map(|m| if let M::Param(p) = m { Some(p) } else { None });
        let list: Vec<&ast::Param> = self.decls.params.iter().copied().chain(own).collect();
        self.distinct(list.iter().map(|p| &p.name));
        if let Some(m) = mission {
            for member in &m.members {
                if let M::Constant(k) = member {
                    self.mission_lets.insert(k.name.name.clone(), k);
                }
            }
        }
        // Service parameters need the list of implementations before their default is looked up.
        for name in self.decls.interfaces.keys() {
            let variants = self
                .decls
                .function_order
                .iter()
                .filter(|f| self.decls.functions[*f].implements.as_ref().is_some_and(|i| i.name == *name))
                .cloned()
                .collect();
            self.add_enum(name, variants);
        }
        let mut out = Vec::new();
        for p in list {
            let ty = match &p.ty {
                Some(t) => match self.resolve_type(t, Some(&p.name)) {
                    Some(ty) => Some(ty),
                    None => {
                        self.poison(&p.name.name);
                        continue;
                    }
                },
                None => None,
            };
            let (value, _) = self.in_body(Body::new(Place::Constant), |c| match &ty {
                Some(t) => c.typed(&p.value, t),
                None => c.expr(&p.value, None),
            });
            let Some(value) = value else {
                // The name stays known, so that its uses are not errors of their own.
                match ty {
                    Some(ty) => self.params.push((p.name.name.clone(), ty, p.name.span)),
                    None => self.poison(&p.name.name),
                }
                continue;
            };
            let ty = value.ty.clone();
            let Some(default) = self.fold_constant(&value, "a parameter's default") else {
                self.params.push((p.name.name.clone(), ty, p.name.span));
                continue;
            };
            if let Some(ast::TypeRef { kind: ast::TypeKind::Service(i), .. }) = &p.ty {
                self.services.insert(self.params.len() as u32, i.name.clone());
            }
            self.params.push((p.name.name.clone(), ty.clone(), p.name.span));
            out.push(Param { name: p.name.name.clone(), ty, default, at: p.name.span });
        }
        out
    }

    pub(super) fn interfaces_and_services(&mut self, _: Option<&'a ast::Mission>) {
        self.interfaces();
        // Every function is lowered, used or not: mistakes show at once.
        for (name, f) in &self.decls.functions {
            let before = self.errors.len();
            self.function(name, f.name.span);
            self.forget_repeated(before);
        }
    }

    pub(super) fn topics(&mut self) {
        for t in self.decls.topics.clone() {
            let known = self.topics.len();
            self.topic(t);
            if self.topics.len() == known {
                self.poison(&t.name.name);
            }
        }
    }

    pub(super) fn topic(&mut self, t: &'a ast::Topic) {
        let Some(ty) = self.resolve_type(&t.ty, None) else { return };
        if !matches!(ty, Type::Record(_)) {
            self.report(
                Diagnostic::error(code::MISMATCH, format!("messages are records, this is {ty}"))
                    .at(t.ty.span, ty.to_string())
                    .hint("declare a `record` with the fields of the message"),
            );
            return;
        }
        let channel: ast::Ident = ast::Ident { name: "channel".into(), span: t.name.span };
        let (model, args): (&ast::Ident, &[ast::Arg]) = match &t.channel {
            Some((m, a)) => (m, a),
            None => (&channel, &[]),
        };
        let Some(channel) =
            self.channel(&"topic".into(), t.name.name.clone(), None, model, args, t.name.span)
        else {
            return;
        };
        let capacity = match channel.args.iter().find(|(n, _)| &**n == "capacity") {
            Some((_, e)) => match self.fold_constant(e, "the capacity of a topic") {
                Some(Value::Int(n)) if (1..=1024).contains(&n) => n as u32,
                Some(_) => {
                    self.report(
                        Diagnostic::error(code::RANGE, "a capacity out of range")
                            .at(e.span, "1 to 1024 are possible")
                            .hint("how many senders are heard at most?"),
                    );
                    return;
                }
                None => return,
            },
            None => 16,
        };
        self.topics.push(Topic { ty, channel });
        self.topic_capacity.push(capacity);
    }

    /// Everything in files without a mission: agents, profiles and worlds stand by themselves.
    pub(super) fn lone_items(&mut self) {
        self.lower_agents();
        for p in self.decls.platforms.values() {
            self.profile(p);
        }
        for w in self.decls.worlds.values() {
            for e in self.extended(w, true) {
                self.component(e, WORLD_ROLES);
            }
        }
    }
}
