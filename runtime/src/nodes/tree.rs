//! The flat form of a plan tree, and its validation.

use std::fmt;

/// A piece of code of a leaf; the host knows what it stands for.
pub type Code = u32;

/// Deepest nesting of nodes: a tick descends the tree on the stack.
pub const MAX_DEPTH: usize = 512;

/// Kinds of nodes, with the numbers of their code.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// See `sequence.rs`.
    Sequence {
        /// Resumes at the running child.
        memory: bool,
    },
    /// See `fallback.rs`.
    Fallback {
        /// Resumes at the running child.
        memory: bool,
    },
    /// See `parallel.rs`.
    Parallel {
        /// How many must succeed.
        successes: u32,
    },
    /// See `retry.rs`.
    Retry(u32),
    /// See `timeout.rs`.
    Timeout(Code),
    /// See `repeat.rs`.
    Repeat {
        /// How many rounds.
        times: Option<u32>,
        /// Tested before every round.
        condition: Option<Code>,
    },
    /// See `invert.rs`.
    Invert,
    /// See `succeed.rs`.
    Succeed,
    /// See `check.rs`.
    Check(Code),
    /// See `wait.rs`.
    Wait(Code),
    /// See `wait_until.rs`.
    WaitUntil(Code),
    /// See `act.rs`; index into the acts of the tree.
    Act(u32),
}

/// Code of an act; absent where there is nothing to do.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Act {
    /// Before everything else.
    pub prelude: Option<Code>,
    /// What it does.
    pub body: Option<Code>,
    /// Success.
    pub until: Option<Code>,
    /// Failure.
    pub fails: Option<Code>,
    /// When it is halted.
    pub halt: Option<Code>,
}

/// What one node does.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Part {
    /// Everything but an act.
    Kind(Kind),
    /// An act.
    Act(Act),
}

/// A tree, flat. Node 0 is the root; parents come before their children.
#[derive(Debug, Clone, Default)]
pub struct Tree {
    nodes: Vec<Node>,
    children: Vec<u32>,
    acts: Vec<Act>,
}

#[derive(Debug, Clone, Copy)]
struct Node {
    kind: Kind,
    from: u32,
    to: u32,
}

/// Why nodes are no tree.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct TreeError {
    /// The node.
    pub node: usize,
    /// One line.
    pub text: &'static str,
}

impl fmt::Display for TreeError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "plan node {}: {}", self.node, self.text)
    }
}

impl Tree {
    /// Flattens nodes, given with their children.
    ///
    /// # Errors
    /// When the nodes are no tree with parents before children, a node has a wrong number of children, or
    /// the tree is deeper than [`MAX_DEPTH`].
    pub fn new(nodes: &[(Part, &[u32])]) -> Result<Tree, TreeError> {
        let mut tree = Tree::default();
        let mut depth = vec![0usize; nodes.len()];
        match depth.first_mut() {
            Some(root) => *root = 1,
            None => return Err(TreeError { node: 0, text: "a plan needs a node" }),
        }
        for (i, (part, children)) in nodes.iter().enumerate() {
            let bad = |text| Err(TreeError { node: i, text });
            if depth[i] == 0 {
                return bad("it is nobody's child");
            }
            if depth[i] > MAX_DEPTH {
                return bad("the plan is nested too deep");
            }
            let from = tree.children.len() as u32;
            for &c in *children {
                if c as usize <= i || depth.get(c as usize) != Some(&0) {
                    return bad("its children must come after it and belong to it alone");
                }
                depth[c as usize] = depth[i] + 1;
                tree.children.push(c);
            }
            let kind = match *part {
                Part::Kind(Kind::Act(_)) => return bad("it is an act without code"),
                Part::Kind(kind) => kind,
                Part::Act(act) => {
                    tree.acts.push(act);
                    Kind::Act(tree.acts.len() as u32 - 1)
                }
            };
            let fits = match kind {
                Kind::Sequence { .. } | Kind::Fallback { .. } | Kind::Parallel { .. } => !children.is_empty(),
                Kind::Retry(_) | Kind::Timeout(_) | Kind::Repeat { .. } | Kind::Invert | Kind::Succeed => {
                    children.len() == 1
                }
                Kind::Check(_) | Kind::Wait(_) | Kind::WaitUntil(_) | Kind::Act(_) => children.is_empty(),
            };
            if !fits {
                return bad("it has a wrong number of children");
            }
            tree.nodes.push(Node { kind, from, to: tree.children.len() as u32 });
        }
        Ok(tree)
    }

    /// Number of nodes.
    pub fn len(&self) -> usize {
        self.nodes.len()
    }

    /// Whether there is none; a tree that was made by [`Tree::new`] has one.
    pub fn is_empty(&self) -> bool {
        self.nodes.is_empty()
    }

    pub(super) fn kind(&self, node: u32) -> Kind {
        self.nodes[node as usize].kind
    }

    pub(super) fn children(&self, node: u32) -> &[u32] {
        let n = self.nodes[node as usize];
        &self.children[n.from as usize..n.to as usize]
    }

    /// The child of a decorator.
    pub(super) fn child(&self, node: u32) -> u32 {
        self.children[self.nodes[node as usize].from as usize]
    }

    pub(super) fn act(&self, act: u32) -> Act {
        self.acts[act as usize]
    }
}
