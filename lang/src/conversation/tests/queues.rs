//! Messages that do not fit, and conversations that are too large to be explored.

use super::{protocol, queues};
use crate::conversation::{Finding, MOST, explore};

#[test]
fn both_push_and_neither_can_take() {
    let n = protocol(
        "idle: I ping pushing, P pong pulling
         pushing: I ping over
         pulling: P pong over",
    );
    let found = n.findings(1, false);
    assert_eq!(
        found[2..],
        ["stuck I in pushing (QueueFull) not pong P in pulling (QueueFull) not ping | I!ping P!pong"],
        "{found:?}"
    );
    // With room for a second message both end, and the late ones are dropped.
    let found = n.findings(2, false);
    assert!(found.iter().all(|f| f.starts_with("unexpected")), "{found:?}");
}

#[test]
fn what_waits_for_room_goes_on_when_it_is_made() {
    let n = protocol("idle: I item idle, I end over");
    assert!(n.findings(1, false).is_empty());
    let e = n.explored(1, false);
    assert_eq!((e.most_under_way, e.blocked), ([1, 0], [true, false]));
    assert_eq!(n.findings(0, false), ["stuck I in idle (QueueFull) P in idle (OthersTurn) item end |"]);
}

#[test]
fn more_configurations_than_may_be_visited_prove_nothing() {
    let n = protocol("idle: I a idle, I b idle, P c idle, P d idle, I stop over, P stop over");
    for most in [0, 1, 1000] {
        let e = explore(&n.protocol, &n.willing(), queues(16, false), most);
        assert_eq!(e.findings, [Finding::NotProven { seen: most }]);
        assert!(!e.complete && e.seen == most);
    }
    // Within small queues it can be told.
    let e = n.explored(2, false);
    assert!(e.complete && e.findings.is_empty(), "{:?}", e.findings);
}

/// One configuration for each length: with all of them the cost would be that of all lengths together.
#[test]
fn long_queues_cost_no_more_than_many_configurations() {
    let n = protocol("idle: I a idle, I stop over");
    let e = explore(&n.protocol, &n.willing(), queues(usize::MAX, false), MOST);
    assert!(!e.complete && e.seen > 1000 && e.seen < 10_000, "{}", e.seen);
    assert_eq!(e.findings, [Finding::NotProven { seen: e.seen }]);
    // A limit that cannot be reached costs nothing.
    let e = explore(&n.protocol, &n.willing(), queues(16, false), usize::MAX);
    assert!(e.complete && e.findings.is_empty(), "{:?}", e.findings);
}

#[test]
fn a_fault_is_told_though_not_all_was_visited() {
    let n = protocol("idle: I a idle, I b idle, P c idle, P d idle, I stop over, P stop end\n end: P e over");
    let e = explore(&n.protocol, &n.willing(), queues(16, false), 1000);
    assert!(!e.complete);
    assert!(!e.findings.is_empty() && !e.findings.iter().any(|f| matches!(f, Finding::NotProven { .. })));
}
