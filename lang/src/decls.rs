//! Everything declared at the top level of all files, by name.

use crate::{ast::*, code, modules::Program};
use soifra_graph::{Diagnostic, Name, Span, did_you_mean};
use std::collections::BTreeMap;

/// A name table that reports a second declaration.
pub type Table<'a, T> = BTreeMap<Name, &'a T>;

/// All declarations.
#[derive(Debug, Default)]
pub struct Decls<'a> {
    /// `record`
    pub records: Table<'a, Record>,
    /// `enum`
    pub enums: Table<'a, Enum>,
    /// `interface`
    pub interfaces: Table<'a, Interface>,
    /// `fn`
    pub functions: Table<'a, Function>,
    /// `let`
    pub constants: Table<'a, Constant>,
    /// `topic`, in order
    pub topics: Vec<&'a Topic>,
    /// `protocol`
    pub protocols: Table<'a, Protocol>,
    /// `conversation`, in order
    pub conversations: Vec<&'a Conversation>,
    /// `param`, in order
    pub params: Vec<&'a Param>,
    /// `agent`, in order
    pub agents: Vec<&'a Agent>,
    /// `platform`
    pub platforms: Table<'a, Profile>,
    /// `world`
    pub worlds: Table<'a, Profile>,
    /// `mission`, in order, with the module they stand in
    pub missions: Vec<(usize, &'a Mission)>,
    /// `plan`, in order, with the module they stand in
    pub plans: Vec<(usize, &'a LibraryPlan)>,
    /// `test`, in order
    pub tests: Vec<&'a Test>,
    /// Names of functions in order of declaration (implementations are numbered so).
    pub function_order: Vec<Name>,
}

impl<'a> Decls<'a> {
    /// Missions of the file that is checked, in order.
    pub fn root_missions(&self) -> impl Iterator<Item = &'a Mission> {
        self.missions.iter().filter(|(file, _)| *file == 0).map(|(_, m)| *m)
    }

    /// Collects the declarations of a program; second ones are reported.
    pub fn collect(program: &'a Program, errors: &mut Vec<Diagnostic>) -> Self {
        let mut d = Decls::default();
        // Types, values and agents share one name space: a name means one thing everywhere.
        let mut seen: BTreeMap<Name, (Span, bool)> = BTreeMap::new();
        for (file, module) in program.modules.iter().enumerate() {
            for item in &module.tree.items {
                let name = item.name();
                if let Some((first, own)) = seen.get(&name.name) {
                    // A mission's own profile or world replaces the library's of that name.
                    if *own && !module.own {
                        continue;
                    }
                    let d = Diagnostic::error(code::DUPLICATE, format!("`{}` is declared twice", name.name));
                    errors.push(if first.file == name.span.file {
                        d.at(name.span, "the second")
                            .at(*first, "the first")
                            .hint("give one of them another name")
                    } else {
                        // The root file comes first, and is where the user is looking.
                        d.at(*first, "declared here")
                            .at(name.span, "and in this file, which is imported")
                            .hint("a name means one thing in all files: give one of them another name")
                    });
                    continue;
                }
                seen.insert(name.name.clone(), (name.span, module.own));
                let key = name.name.clone();
                match item {
                    Item::Mission(m) => d.missions.push((file, m)),
                    Item::Agent(a) => d.agents.push(a),
                    Item::Platform(p) => drop(d.platforms.insert(key, p)),
                    Item::World(w) => drop(d.worlds.insert(key, w)),
                    Item::Record(r) => drop(d.records.insert(key, r)),
                    Item::Enum(e) => drop(d.enums.insert(key, e)),
                    Item::Interface(i) => drop(d.interfaces.insert(key, i)),
                    Item::Function(f) => {
                        d.function_order.push(key.clone());
                        d.functions.insert(key, f);
                    }
                    Item::Constant(c) => drop(d.constants.insert(key, c)),
                    Item::Topic(t) => d.topics.push(t),
                    Item::Protocol(p) => drop(d.protocols.insert(key, p)),
                    Item::Conversation(c) => d.conversations.push(c),
                    Item::Param(p) => d.params.push(p),
                    Item::Plan(p) => d.plans.push((file, p)),
                    Item::Test(t) => d.tests.push(t),
                }
            }
        }
        d
    }
}

impl Item {
    /// The name it declares.
    pub fn name(&self) -> &Ident {
        match self {
            Item::Mission(x) => &x.name,
            Item::Agent(x) => &x.name,
            Item::Platform(x) | Item::World(x) => &x.name,
            Item::Record(x) => &x.name,
            Item::Enum(x) => &x.name,
            Item::Interface(x) => &x.name,
            Item::Function(x) => &x.name,
            Item::Constant(x) => &x.name,
            Item::Topic(x) => &x.name,
            Item::Protocol(x) => &x.name,
            Item::Conversation(x) => &x.name,
            Item::Param(x) => &x.name,
            Item::Plan(x) => &x.name,
            Item::Test(x) => &x.name,
        }
    }
}

/// An error about an unknown name, with the nearest known one.
pub fn unknown<'n>(
    code: &'static str,
    what: &str,
    name: &str,
    span: Span,
    known: impl IntoIterator<Item = &'n str>,
) -> Diagnostic {
    let known: Vec<&str> = known.into_iter().collect();
    // `x` is no part of y, but there is no agent `x`.
    let title = if what.contains(" of ") {
        format!("`{name}` is no {what}")
    } else {
        format!("there is no {what} `{name}`")
    };
    let d = Diagnostic::error(code, title).at(span, "not declared");
    match did_you_mean(name, known.iter().copied()) {
        Some(near) => d.hint(format!("did you mean `{near}`?")),
        None if known.is_empty() => {
            d.hint(format!("no {what} is declared here; declare it or import the file that does"))
        }
        None if known.len() == 1 => d.hint(format!("the only one is {}", known[0])),
        None if known.len() <= 12 => d.hint(format!("known are {}", known.join(", "))),
        None => d.hint("declare it, or import the file that does"),
    }
}
