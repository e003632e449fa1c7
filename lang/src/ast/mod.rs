//! The syntax tree: what was written, with spans, before anything is resolved.

mod agent;
mod expr;
mod mission;

pub use agent::*;
pub use expr::*;
pub use mission::*;

use soifra_graph::{Name, Span, Type};

/// A name and its place.
#[derive(Debug, Clone, PartialEq)]
pub struct Ident {
    /// The name.
    pub name: Name,
    /// Where it stands.
    pub span: Span,
}

/// A source file.
#[derive(Debug, Clone, Default)]
pub struct File {
    /// Language edition, if stated.
    pub edition: Option<(i64, Span)>,
    /// Imports in order.
    pub imports: Vec<Import>,
    /// Items in order.
    pub items: Vec<Item>,
    /// What could not be read as an item.
    pub unread: Vec<Span>,
}

/// `import "rules.soi"` or `import std.motion`.
#[derive(Debug, Clone)]
pub struct Import {
    /// File path, or dotted library path.
    pub path: String,
    /// Whether it is a file path.
    pub is_file: bool,
    /// Where it stands.
    pub span: Span,
}

/// A top-level item.
#[derive(Debug, Clone)]
pub enum Item {
    /// `mission`
    Mission(Mission),
    /// `agent`
    Agent(Agent),
    /// `platform`
    Platform(Profile),
    /// `world`
    World(Profile),
    /// `record`
    Record(Record),
    /// `enum`
    Enum(Enum),
    /// `interface`
    Interface(Interface),
    /// `fn`
    Function(Function),
    /// `let`
    Constant(Constant),
    /// `topic`
    Topic(Topic),
    /// `protocol`
    Protocol(Protocol),
    /// `conversation`
    Conversation(Conversation),
    /// `param`
    Param(Param),
    /// `plan … for …`
    Plan(LibraryPlan),
    /// `test`
    Test(Test),
}

/// A type as written.
#[derive(Debug, Clone)]
pub struct TypeRef {
    /// What.
    pub kind: TypeKind,
    /// Where.
    pub span: Span,
}

/// Kinds of written types.
#[derive(Debug, Clone)]
pub enum TypeKind {
    /// A type by its text; record names in it may turn out to be enums or unknown.
    Named(Type),
    /// Text that is no type, with the reason.
    Bad(String),
    /// `enum { a, b }`
    InlineEnum(Vec<Ident>),
    /// `service I`: one of the functions that implement interface `I`.
    Service(Ident),
}

/// `record`
#[derive(Debug, Clone)]
pub struct Record {
    /// Name.
    pub name: Ident,
    /// Fields.
    pub fields: Vec<(Ident, TypeRef)>,
}

/// `enum`
#[derive(Debug, Clone)]
pub struct Enum {
    /// Name.
    pub name: Ident,
    /// Variants.
    pub variants: Vec<Ident>,
}

/// `protocol`
#[derive(Debug, Clone)]
pub struct Protocol {
    /// Name.
    pub name: Ident,
    /// Names that stand for contents.
    pub contents: Vec<Ident>,
    /// Parameters.
    pub params: Vec<(Ident, TypeRef)>,
    /// States, the first is the initial one.
    pub states: Vec<ProtocolState>,
}

/// A state of a protocol.
#[derive(Debug, Clone)]
pub struct ProtocolState {
    /// Name.
    pub name: Ident,
    /// Messages.
    pub moves: Vec<ProtocolMove>,
    /// Time-outs: after, where.
    pub timeouts: Vec<(Expr, Ident)>,
}

/// `initiator cfp Task -> called`
#[derive(Debug, Clone)]
pub struct ProtocolMove {
    /// Who.
    pub by: Ident,
    /// What.
    pub performative: Ident,
    /// With what.
    pub content: Option<Ident>,
    /// Where it leads.
    pub target: Ident,
}

/// `conversation deliver: contract_net<Parcel, Bid, Receipt>(…) = channel(…)`
#[derive(Debug, Clone)]
pub struct Conversation {
    /// Name.
    pub name: Ident,
    /// Protocol.
    pub protocol: Ident,
    /// Contents.
    pub contents: Vec<Ident>,
    /// Arguments of the protocol.
    pub args: Vec<Arg>,
    /// Channel model and arguments.
    pub channel: Option<(Ident, Vec<Arg>)>,
}

/// `interface`
#[derive(Debug, Clone)]
pub struct Interface {
    /// Name.
    pub name: Ident,
    /// Parameters.
    pub params: Vec<(Ident, TypeRef)>,
    /// Result.
    pub result: TypeRef,
}

/// `fn`
#[derive(Debug, Clone)]
pub struct Function {
    /// Name.
    pub name: Ident,
    /// Parameters.
    pub params: Vec<(Ident, TypeRef)>,
    /// Result, inferred when absent.
    pub result: Option<TypeRef>,
    /// Interface it implements.
    pub implements: Option<Ident>,
    /// `let`s of the body.
    pub lets: Vec<Constant>,
    /// Value.
    pub body: Expr,
}

/// `let name = value`
#[derive(Debug, Clone)]
pub struct Constant {
    /// Name.
    pub name: Ident,
    /// Value.
    pub value: Expr,
}

/// `param`
#[derive(Debug, Clone)]
pub struct Param {
    /// Name.
    pub name: Ident,
    /// Type, inferred from the default when absent.
    pub ty: Option<TypeRef>,
    /// Default.
    pub value: Expr,
}

/// `topic`
#[derive(Debug, Clone)]
pub struct Topic {
    /// Name.
    pub name: Ident,
    /// Message type.
    pub ty: TypeRef,
    /// Channel model and arguments.
    pub channel: Option<(Ident, Vec<Arg>)>,
}

/// A platform or world: named, perhaps extending another, made of entries.
#[derive(Debug, Clone)]
pub struct Profile {
    /// Name.
    pub name: Ident,
    /// What it extends.
    pub extends: Option<Ident>,
    /// Entries.
    pub entries: Vec<Entry>,
}

/// `role name[count] = model(args)`
#[derive(Debug, Clone)]
pub struct Entry {
    /// Role.
    pub role: Ident,
    /// Name.
    pub name: Option<Ident>,
    /// Array size.
    pub count: Option<Expr>,
    /// Model.
    pub model: Ident,
    /// Arguments.
    pub args: Vec<Arg>,
    /// All of it.
    pub span: Span,
}
