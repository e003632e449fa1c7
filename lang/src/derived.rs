//! What extends something else: platforms, worlds and missions.

use crate::{
    ast::{Entry, Ident, Item, Mission, MissionMember as M, Profile},
    code,
    decls::unknown,
    modules::Program,
};
use soifra_graph::{Diagnostic, Name};
use std::collections::BTreeMap;

/// The longest chain.
const LONGEST: usize = 64;

/// A declaration that may extend another one of its kind.
pub trait Extends {
    /// What it is called.
    fn name(&self) -> &Ident;
    /// What it extends.
    fn base(&self) -> Option<&Ident>;
}

impl Extends for Profile {
    fn name(&self) -> &Ident {
        &self.name
    }
    fn base(&self) -> Option<&Ident> {
        self.extends.as_ref()
    }
}

impl Extends for Mission {
    fn name(&self) -> &Ident {
        &self.name
    }
    fn base(&self) -> Option<&Ident> {
        self.extends.as_ref()
    }
}

/// A declaration, what it extends, what that extends …, as far as there is such a thing, and what is wrong with the
/// rest. `missing` says that there is none of a name.
pub fn chain<'a, T: Extends>(
    first: &'a T,
    find: impl Fn(&Name) -> Option<&'a T>,
    missing: impl FnOnce(&Ident) -> Diagnostic,
) -> (Vec<&'a T>, Option<Diagnostic>) {
    let (mut chain, mut at) = (vec![first], first);
    while let Some(base) = at.base() {
        let Some(next) = find(&base.name) else { return (chain, Some(missing(base))) };
        if chain.len() > LONGEST {
            let d = Diagnostic::error(
                code::NESTING,
                format!("`{}` extends more than {LONGEST} others", first.name().name),
            );
            return (chain, Some(d.at(first.name().span, "too long a chain").hint("extend fewer levels")));
        }
        if chain.iter().any(|p| p.name().name == next.name().name) {
            let d = Diagnostic::error(code::RECURSION, format!("`{}` extends itself", next.name().name));
            return (chain, Some(d.at(base.span, "in a ring").hint("one of them must stand by itself")));
        }
        chain.push(next);
        at = next;
    }
    (chain, None)
}

/// Whether two entries are of the same role and name, so that one takes the place of the other.
pub fn same_entry(a: &Entry, b: &Entry) -> bool {
    let name = |e: &Entry| e.name.as_ref().map(|n| n.name.clone());
    a.role.name == b.role.name && name(a) == name(b)
}

/// Gives every mission that extends another the members of that one; its own take the place of those of the same kind
/// and name. Returns what is wrong with bases.
pub fn missions(program: &mut Program) -> Vec<Diagnostic> {
    let mut declared: BTreeMap<Name, Mission> = BTreeMap::new();
    for item in program.modules.iter().flat_map(|m| &m.tree.items) {
        if let Item::Mission(m) = item {
            declared.entry(m.name.name.clone()).or_insert_with(|| m.clone());
        }
    }
    let mut out = Vec::new();
    for item in program.modules.iter_mut().flat_map(|m| &mut m.tree.items) {
        let Item::Mission(m) = item else { continue };
        if m.extends.is_none() {
            continue;
        }
        let own = m.clone();
        let known = || declared.keys().map(|k| &**k);
        let (chain, wrong) = chain(
            &own,
            |name| declared.get(name),
            |base| unknown(code::UNKNOWN_NAME, "mission", &base.name, base.span, known()),
        );
        out.extend(wrong);
        m.members = Vec::new();
        for level in chain.iter().rev() {
            // Each makes room for one: a second one of that name is a mistake that is told like any other.
            let mut inherited: Vec<bool> = vec![true; m.members.len()];
            for member in &level.members {
                let slot = (0..inherited.len()).find(|i| inherited[*i] && replaces(member, &m.members[*i]));
                match slot {
                    Some(i) => (m.members[i], inherited[i]) = (member.clone(), false),
                    None => m.members.push(member.clone()),
                }
            }
        }
    }
    out
}

/// Whether a mission's own member takes the place of an inherited one. Expectations and faults are added.
fn replaces(own: &M, inherited: &M) -> bool {
    match (own, inherited) {
        (M::Param(a), M::Param(b)) => a.name.name == b.name.name,
        (M::Robot(a), M::Robot(b)) => a.name.name == b.name.name,
        (M::Host(a), M::Host(b)) => a.name.name == b.name.name,
        (M::Goal(a), M::Goal(b)) => a.name.name == b.name.name,
        (M::Metric(a), M::Metric(b)) => a.name.name == b.name.name,
        (M::Constant(a), M::Constant(b)) => a.name.name == b.name.name,
        (M::Entry(a), M::Entry(b)) => &*a.role.name != "fault" && same_entry(a, b),
        (M::Clock(_), M::Clock(_))
        | (M::Done(..), M::Done(..))
        | (M::Within(..), M::Within(..))
        | (M::World(_), M::World(_)) => true,
        _ => false,
    }
}
