//! Walks the parts of a parse node; keywords and comments step aside unless asked for.

use super::Rule;
use pest::iterators::{Pair, Pairs};
use std::iter::Peekable;

/// The parts of a node, in order.
pub(crate) struct Cursor<'i> {
    pairs: Peekable<Pairs<'i, Rule>>,
}

impl<'i> Cursor<'i> {
    pub fn new(pair: Pair<'i, Rule>) -> Self {
        Cursor { pairs: pair.into_inner().peekable() }
    }

    /// Whether keyword `word` comes next (after comments); takes it.
    pub fn word(&mut self, word: Rule) -> bool {
        while self.pairs.next_if(|p| p.as_rule() == Rule::COMMENT).is_some() {}
        self.pairs.next_if(|p| p.as_rule() == word).is_some()
    }

    /// Whether the word `reactive` comes next; takes it, and no keyword after it.
    pub fn reactive(&mut self) -> bool {
        self.pairs.next_if(|p| p.as_rule() == Rule::reactive).is_some()
    }

    /// The next part that is no keyword, if it is a `rule`.
    pub fn take(&mut self, rule: Rule) -> Option<Pair<'i, Rule>> {
        self.peek()?;
        self.pairs.next_if(|p| p.as_rule() == rule)
    }

    /// Rule of the next part that is no keyword.
    pub fn peek(&mut self) -> Option<Rule> {
        while self.pairs.next_if(|p| is_aside(p.as_rule())).is_some() {}
        self.pairs.peek().map(Pair::as_rule)
    }

    /// The next part that is no keyword.
    pub fn any(&mut self) -> Option<Pair<'i, Rule>> {
        self.peek()?;
        self.pairs.next()
    }

    /// All parts to come that are `rule`s, up to the first that is not.
    pub fn all(&mut self, rule: Rule) -> Vec<Pair<'i, Rule>> {
        std::iter::from_fn(|| self.take(rule)).collect()
    }
}

fn is_aside(rule: Rule) -> bool {
    matches!(
        rule,
        Rule::COMMENT
            | Rule::EOI
            | Rule::K_EDITION
            | Rule::K_IMPORT
            | Rule::K_MISSION
            | Rule::K_AGENT
            | Rule::K_PLATFORM
            | Rule::K_WORLD
            | Rule::K_RECORD
            | Rule::K_ENUM
            | Rule::K_INTERFACE
            | Rule::K_FN
            | Rule::K_LET
            | Rule::K_TOPIC
            | Rule::K_TEST
            | Rule::K_PARAM
            | Rule::K_UPON
            | Rule::K_EXTENDS
            | Rule::K_IMPLEMENTS
            | Rule::K_CLOCK
            | Rule::K_STEP
            | Rule::K_ROBOT
            | Rule::K_AT
            | Rule::K_TO
            | Rule::K_SCATTER
            | Rule::K_RUNS
            | Rule::K_ANY
            | Rule::K_OF
            | Rule::K_GOAL
            | Rule::K_SUBGOAL
            | Rule::K_BY
            | Rule::K_ACHIEVED
            | Rule::K_WHEN
            | Rule::K_DONE
            | Rule::K_WITHIN
            | Rule::K_EXPECT
            | Rule::K_ALWAYS
            | Rule::K_NEVER
            | Rule::K_EVENTUALLY
            | Rule::K_UNTIL
            | Rule::K_LEADS
            | Rule::K_METRIC
            | Rule::K_EXCLUSIVE
            | Rule::K_COLLABORATIVE
            | Rule::K_OFFERS
            | Rule::K_NEEDS
            | Rule::K_REQUEST
            | Rule::K_RESTART
            | Rule::K_STOPPED
            | Rule::K_START
            | Rule::K_STOP
            | Rule::K_ACHIEVE
            | Rule::K_FAIL
            | Rule::K_PURSUE
            | Rule::K_OFFER
            | Rule::K_WITHDRAW
            | Rule::K_SENSOR
            | Rule::K_ACTUATOR
            | Rule::K_STATE
            | Rule::K_EVENT
            | Rule::K_ACTION
            | Rule::K_SERVICE
            | Rule::K_MACHINE
            | Rule::K_PLAN
            | Rule::K_ARBITRATE
            | Rule::K_PRIORITY
            | Rule::K_LAYERS
            | Rule::K_LAYER
            | Rule::K_SWITCH
            | Rule::K_BLEND
            | Rule::K_SUPPRESSES
            | Rule::K_INHIBITED
            | Rule::K_FOR
            | Rule::K_EVERY
            | Rule::K_AFTER
            | Rule::K_ON
            | Rule::K_FROM
            | Rule::K_DEADLINE
            | Rule::K_WORST
            | Rule::K_DEVICE
            | Rule::K_CAPACITY
            | Rule::K_USE
            | Rule::K_PROTOCOL
            | Rule::K_CONVERSATION
            | Rule::K_OPEN
            | Rule::K_REPLY
            | Rule::K_IN
            | Rule::K_HOST
            | Rule::K_TAKES
            | Rule::K_JITTER
            | Rule::K_SHARES
            | Rule::K_SOFT
            | Rule::K_MISSES
            | Rule::K_REFINE
            | Rule::K_COST
            | Rule::K_CORE
            | Rule::K_BUDGET
            | Rule::K_MOST
            | Rule::K_SET
            | Rule::K_COMMAND
            | Rule::K_PUBLISH
            | Rule::K_TELL
            | Rule::K_NOTE
            | Rule::K_RAISE
            | Rule::K_IF
            | Rule::K_THEN
            | Rule::K_ELSE
            | Rule::K_MATCH
            | Rule::K_RULES
            | Rule::K_OTHERWISE
            | Rule::K_DO
            | Rule::K_FAILS
            | Rule::K_HALT
            | Rule::K_ENTER
            | Rule::K_EXIT
            | Rule::K_AND
            | Rule::K_OR
            | Rule::K_NOT
            | Rule::K_IS
            | Rule::K_SOME
            | Rule::K_NONE
            | Rule::K_TRUE
            | Rule::K_FALSE
            | Rule::K_EACH
            | Rule::K_COUNT
            | Rule::K_SUM
            | Rule::K_LEAST
            | Rule::K_MEAN
            | Rule::K_REACTIVE
            | Rule::K_SEQUENCE
            | Rule::K_FALLBACK
            | Rule::K_PARALLEL
            | Rule::K_RETRY
            | Rule::K_TIMEOUT
            | Rule::K_REPEAT
            | Rule::K_WHILE
            | Rule::K_INVERT
            | Rule::K_SUCCEED
            | Rule::K_CHECK
            | Rule::K_WAIT
            | Rule::K_RUN
            | Rule::K_SEEDS
            | Rule::K_OUTCOME
            | Rule::K_AS
    )
}
