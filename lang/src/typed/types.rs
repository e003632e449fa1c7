//! Written types to types.

use super::Checker;
use crate::{ast::*, code, decls::unknown};
use soifra_graph::{Diagnostic, Dim, Frame, Type, dim::QUANTITIES};

impl Checker<'_> {
    /// Resolves a written type. `owner` names an inline enum after what it is declared for.
    pub fn resolve_type(&mut self, t: &TypeRef, owner: Option<&Ident>) -> Option<Type> {
        match &t.kind {
            TypeKind::Bad(why) => {
                let hint = if why.starts_with("`List<") {
                    "a list says how many items it holds at most: `List<Beam, 8>`"
                } else if why.starts_with("`Matrix<") {
                    "a matrix has 1 to 8 rows and columns: `Matrix<2, 3>`"
                } else if why.starts_with("`Point")
                    || why.starts_with("`Vector")
                    || why.starts_with("`Pose")
                    || why.starts_with("`Heading")
                {
                    "name its frame: `Point<map>`, `Vector<map, Velocity>`"
                } else {
                    "types are listed in docs/language.md"
                };
                self.report(
                    Diagnostic::error(code::UNKNOWN_TYPE, why.clone()).at(t.span, "written here").hint(hint),
                );
                None
            }
            TypeKind::Named(ty) => self.named(ty, t),
            TypeKind::InlineEnum(variants) => {
                let Some(owner) = owner else {
                    self.report(
                        Diagnostic::error(code::UNKNOWN_TYPE, "an enum without a name")
                            .at(t.span, "written here")
                            .hint("declare it by itself: `enum Name { a, b }`"),
                    );
                    return None;
                };
                self.distinct(variants.iter());
                let name = owner.name.clone();
                let variants = variants.iter().map(|v| v.name.clone()).collect();
                self.add_enum(&name, variants);
                Some(Type::Enum(name))
            }
            TypeKind::Service(interface) => {
                if !self.decls.interfaces.contains_key(&interface.name) {
                    let d = unknown(
                        code::UNKNOWN_NAME,
                        "interface",
                        &interface.name,
                        interface.span,
                        self.decls.interfaces.keys().map(|k| &**k),
                    );
                    self.report(d);
                    return None;
                }
                Some(Type::Enum(interface.name.clone()))
            }
        }
    }

    /// Reports names that come twice.
    pub fn distinct<'n>(&mut self, names: impl IntoIterator<Item = &'n Ident>) {
        let mut seen: Vec<&Ident> = Vec::new();
        for n in names {
            match seen.iter().find(|s| s.name == n.name) {
                Some(first) => {
                    let d = Diagnostic::error(code::DUPLICATE, format!("`{}` is declared twice", n.name))
                        .at(n.span, "the second")
                        .at(first.span, "the first")
                        .hint("give one of them another name");
                    self.report(d);
                }
                None => seen.push(n),
            }
        }
    }

    fn named(&mut self, ty: &Type, t: &TypeRef) -> Option<Type> {
        Some(match ty {
            Type::Record(name) => {
                if self.types.records.contains_key(name) {
                    ty.clone()
                } else if self.types.enums.contains_key(name) {
                    Type::Enum(name.clone())
                } else {
                    let known = [
                        "Bool",
                        "Int",
                        "Text",
                        "Twist",
                        "Point<map>",
                        "Vector<map>",
                        "Pose<map>",
                        "Heading<map>",
                        "List",
                        "Matrix",
                        "Range",
                        "Distribution",
                    ];
                    let names: Vec<String> = known
                        .iter()
                        .map(|k| (*k).to_string())
                        .chain(QUANTITIES.iter().map(|(n, _)| (*n).to_string()))
                        .chain(self.types.records.keys().map(|k| k.to_string()))
                        .chain(self.types.enums.keys().map(|k| k.to_string()))
                        .collect();
                    let d =
                        unknown(code::UNKNOWN_TYPE, "type", name, t.span, names.iter().map(String::as_str));
                    self.report(d);
                    return None;
                }
            }
            Type::List(inner, n) => {
                if *n == 0 || *n > 4096 {
                    self.report(
                        Diagnostic::error(code::RANGE, format!("a list of up to {n} items"))
                            .at(t.span, "1 to 4096 are possible")
                            .hint("declare the most items it can hold"),
                    );
                    return None;
                }
                Type::List(Box::new(self.named(inner, t)?), *n)
            }
            Type::Option(inner) => {
                let inner = self.named(inner, t)?;
                if matches!(inner, Type::Option(_)) {
                    self.report(
                        Diagnostic::error(code::UNKNOWN_TYPE, "an optional of an optional")
                            .at(t.span, "written here")
                            .hint("leave out one `?`"),
                    );
                    return None;
                }
                Type::Option(Box::new(inner))
            }
            Type::Heading(f) | Type::Point(f) | Type::Pose(f) | Type::Vector(f, _)
                if !Frame::is_known(&f.0) =>
            {
                let d = unknown(code::FRAMES, "frame", &f.0, t.span, ["map", "odom", "base_link"]);
                self.report(d);
                return None;
            }
            _ => ty.clone(),
        })
    }

    /// The element type that a literal of nothing but numbers would have.
    pub fn default_vector(&self, dim: Dim) -> Type {
        if dim == Dim::LENGTH { Type::Point(Frame::map()) } else { Type::Vector(Frame::map(), dim) }
    }
}
