//! When units are activated, and in which order.

use crate::support::*;

fn notes(ran: &Ran) -> Vec<String> {
    ran.notes().into_iter().map(|(t, s)| format!("{t} {s}")).collect()
}

#[test]
fn periods_and_offsets_and_priorities() {
    let ran = run(r#"
edition 1
mission m {
  robot a: cart at (0 m, 0 m) runs ticker
  goal g { subgoal s by ticker achieved when count > 100 }
  done when achieved(g)
  within 300 ms
}
agent ticker {
  state count: Int = 0
  service slow every 200 ms { set count = count + 1 note "slow" }
  service fast every 100 ms after 50 ms { set count = count + 1 note "fast" }
  service first every 200 ms priority 5 { set count = count + 1 note "first" }
}
"#);
    assert_eq!(
        notes(&ran),
        ["0 first", "0 slow", "50 fast", "150 fast", "200 first", "200 slow", "250 fast"]
    );
    assert_eq!(ran.report.outcome, soifra_runtime::Outcome::Timeout);
    assert_eq!(ran.report.sim_time_s, 0.3);
    ran.check_records();
}
