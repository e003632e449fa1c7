//! Entries of profiles and worlds, and channels of topics.

use crate::{
    ast::{Arg, Entry, Expr as Written, Ident, Profile},
    code,
    decls::unknown,
    derived::{chain, same_entry},
    typed::{Body, Checker, Place},
};
use soifra_graph::{Component, Diagnostic, Name, Span, Type, component};

impl<'a> Checker<'a> {
    /// The entries of a profile with those of what it extends: own entries replace inherited ones of the
    /// same role and name.
    pub fn extended(&mut self, profile: &'a Profile, worlds: bool) -> Vec<&'a Entry> {
        let table = if worlds { &self.decls.worlds } else { &self.decls.platforms };
        let (code, what) =
            if worlds { (code::UNKNOWN_NAME, "world") } else { (code::UNKNOWN_PLATFORM, "platform") };
        let (chain, wrong) = chain(
            profile,
            |name| table.get(name).copied(),
            |base| unknown(code, what, &base.name, base.span, table.keys().map(|k| &**k)),
        );
        if let Some(d) = wrong {
            self.report(d);
        }
        let mut out: Vec<&Entry> = Vec::new();
        for p in chain.iter().rev() {
            let mut own: Vec<&Entry> = Vec::new();
            for e in &p.entries {
                let same = |o: &&&Entry| same_entry(o, e) && &*e.role.name != "safe";
                if let Some(first) = own.iter().find(same) {
                    self.report(
                        Diagnostic::error(code::DUPLICATE, "this is declared twice")
                            .at(e.span, "the second")
                            .at(first.span, "the first")
                            .hint("remove one, or give it another name"),
                    );
                    continue;
                }
                own.push(e);
            }
            // Safe actions are one ordered list: own ones replace the whole inherited list.
            if own.iter().any(|e| &*e.role.name == "safe") {
                out.retain(|o| &*o.role.name != "safe");
            }
            for e in own {
                match out.iter_mut().find(|o| same_entry(o, e) && &*e.role.name != "safe") {
                    Some(slot) => *slot = e,
                    None => out.push(e),
                }
            }
        }
        out
    }

    /// An entry as a component; `roles` are those that make sense where it stands.
    pub fn component(&mut self, e: &Entry, roles: &[&str]) -> Option<Component> {
        if !roles.contains(&&*e.role.name) {
            let d = unknown(
                code::UNKNOWN_MODEL,
                "kind of entry here",
                &e.role.name,
                e.role.span,
                roles.iter().copied(),
            );
            self.report(d);
            return None;
        }
        let named = component::NAMED_ROLES.contains(&&*e.role.name);
        match (&e.name, named) {
            (None, true) => {
                self.report(
                    Diagnostic::error(code::SYNTAX, format!("this {} has no name", e.role.name))
                        .at(e.role.span, "a name is wanted after it")
                        .hint(format!("write `{} NAME = {}(…)`", e.role.name, e.model.name)),
                );
                return None;
            }
            (Some(n), false) => {
                self.report(
                    Diagnostic::error(
                        code::SYNTAX,
                        format!("`{}` stands alone, it has no name", e.role.name),
                    )
                    .at(n.span, "leave this out")
                    .hint(format!("write `{} = {}(…)`", e.role.name, e.model.name)),
                );
                return None;
            }
            _ => {}
        }
        let name = e.name.as_ref().map_or_else(|| Name::from(""), |n| n.name.clone());
        self.channel(&e.role.name, name, e.count.as_ref(), &e.model, &e.args, e.span)
    }

    /// A component from its parts.
    pub fn channel(
        &mut self,
        role: &Name,
        name: Name,
        count: Option<&Written>,
        model: &Ident,
        args: &[Arg],
        span: Span,
    ) -> Option<Component> {
        let Some(found) = component::model(role, &model.name) else {
            let names = component::MODELS.iter().filter(|m| m.role == &**role).map(|m| &*m.signature.name);
            let d = unknown(code::UNKNOWN_MODEL, &format!("{role} model"), &model.name, model.span, names);
            self.report(d);
            return None;
        };
        let count = match count {
            Some(c) => Some(self.in_body(Body::new(Place::Start), |s| s.typed(c, &Type::Int)).0?),
            None => None,
        };
        let mut body =
            Body::new(if matches!(&**role, "topic" | "conversation") { Place::Start } else { Place::Scene });
        let index = Ident { name: "index".into(), span };
        body.bind(&index, &Type::Int);
        let (typed, _) = self.in_body(body, |s| s.model_arguments(&found.signature, model, args, span));
        let (args, ty) = typed?;
        let ty = matches!(&**role, "sensor" | "actuator").then_some(ty).flatten();
        Some(Component { role: role.clone(), name, model: model.name.clone(), args, count, ty, at: span })
    }
}
