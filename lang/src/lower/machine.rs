//! State machines: the data of a state become slots of the agent.

use crate::{
    ast::{self, Ident},
    code,
    decls::unknown,
    typed::Checker,
};
use soifra_graph::{Diagnostic, Expr, MachineState, Name, State, Transition, Type, UnitKind, Value};

/// Slots of a state's data: field, slot, type.
type Data = Vec<(Name, u32, Type)>;

impl<'a> Checker<'a> {
    /// Lowers a machine.
    pub fn machine(
        &mut self,
        name: &Ident,
        list: &'a [ast::MachineState],
        states: &mut Vec<State>,
    ) -> Option<UnitKind> {
        self.distinct(list.iter().map(|s| &s.name));
        let mut slots: Vec<Data> = Vec::new();
        for s in list {
            self.distinct(s.data.iter().map(|(n, _)| n));
            let mut data = Data::new();
            for (n, t) in &s.data {
                let Some(ty) = self.resolve_type(t, None) else { continue };
                let Some(zero) = self.zero(&ty, n) else { continue };
                let full: Name = format!("{}.{}.{}", name.name, s.name.name, n.name).into();
                data.push((n.name.clone(), self.slot(states, full, ty.clone(), zero), ty));
            }
            slots.push(data);
        }
        if let Some((n, _)) = list.first().and_then(|s| s.data.first()) {
            self.report(
                Diagnostic::error(code::ARGUMENTS, "the first state of a machine carries no data")
                    .at(n.span, "what would it be at the start?")
                    .hint("put a state without data first"),
            );
        }
        self.body.in_machine = true;
        let mut out = Vec::new();
        for (i, s) in list.iter().enumerate() {
            self.body.data = slots[i].clone();
            let entry = self.block(&s.entry, 0);
            let body = self.block(&s.body, 0);
            let exit = self.block(&s.exit, 0);
            let mut transitions = Vec::new();
            for t in &s.transitions {
                if let Some(t) = self.transition(t, list, &slots) {
                    transitions.push(t);
                }
            }
            out.push(MachineState {
                name: s.name.name.clone(),
                data: slots[i].iter().map(|(_, k, _)| *k).collect(),
                entry,
                body,
                exit,
                transitions,
                at: s.name.span,
            });
        }
        self.body.data.clear();
        self.body.in_machine = false;
        Some(UnitKind::Machine(out))
    }

    fn transition(
        &mut self,
        t: &'a ast::Transition,
        list: &[ast::MachineState],
        slots: &[Data],
    ) -> Option<Transition> {
        let Some(target) = list.iter().position(|s| s.name.name == t.target.name) else {
            let d = unknown(
                code::UNKNOWN_NAME,
                "state of this machine",
                &t.target.name,
                t.target.span,
                list.iter().map(|s| &*s.name.name),
            );
            self.report(d);
            return None;
        };
        let mark = self.body.scope.len();
        let guard = self.guard(&t.guard);
        let params: Vec<(Name, Type)> =
            slots[target].iter().map(|(n, _, ty)| (n.clone(), ty.clone())).collect();
        let arguments = self.arguments(&t.target, &params, &t.args, t.target.span);
        let body = self.block(&t.body, 0);
        self.body.scope.truncate(mark);
        Some(Transition {
            guard: guard?,
            target: target as u32,
            arguments: arguments?,
            body,
            at: t.guard.span,
        })
    }

    /// The value of a slot before its state is first entered; nothing reads it then.
    fn zero(&mut self, ty: &Type, at: &Ident) -> Option<Expr> {
        match zero(ty, &self.types) {
            Some(v) => Some(Expr::constant(v, ty.clone(), at.span)),
            None => {
                self.report(
                    Diagnostic::error(code::MISMATCH, format!("a state cannot carry {ty}"))
                        .at(at.span, ty.to_string())
                        .hint("carry quantities, points, enums, optionals, lists or records of these"),
                );
                None
            }
        }
    }
}

fn zero(ty: &Type, types: &soifra_graph::TypeTable) -> Option<Value> {
    Some(match ty {
        Type::Bool => Value::Bool(false),
        Type::Int | Type::Agent | Type::Conversation(_) => Value::Int(0),
        Type::Quantity(_) | Type::Heading(_) => Value::Number(0.0),
        Type::Point(_) | Type::Vector(..) => Value::Vector([0.0; 3]),
        Type::Pose(_) => Value::Pose([0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0]),
        Type::Twist => Value::Twist([0.0; 6]),
        Type::Enum(e) => Value::Variant(types.enums.get(e)?.variants.first()?.clone()),
        Type::Record(r) => Value::Record(
            types.records.get(r)?.fields.iter().map(|(_, t)| zero(t, types)).collect::<Option<_>>()?,
        ),
        Type::List(..) => Value::List(Vec::new()),
        Type::Option(_) => Value::None("not given".into()),
        Type::Range(_) => Value::Range(0.0, 0.0),
        Type::Matrix(r, c) => Value::Matrix(vec![0.0; usize::from(*r) * usize::from(*c)]),
        Type::Text => Value::Text("not given".into()),
        Type::Distribution(_) | Type::Handle(_) => return None,
    })
}
