//! Objects that nobody has in a state: what is sent arrives whole, however long it is under way.

use crate::support::{code, file, folder, json, soifra, stderr, stdout};

/// Two agents: one makes maps and sends them off, the other counts what arrives and is a map.
const SENT: &str = "
edition 1

record Chart {
  number: Int
  grid: OccupancyGrid
}

topic charts: Chart = channel(delay: 350 ms, lifetime: 2 s)

agent maker {
  state made: Int = 0

  // What it makes is sent 30 ms after it was made.
  service make every 100 ms worst 30 ms deadline 90 ms core 0 {
    match empty_map(low: (0 m, 0 m), high: (2 m, 2 m), resolution: 20 cm) {
      some(g) => {
        set made = made + 1
        tell keeper inform Chart(number: made, grid: g)
        publish charts Chart(number: made, grid: g)
      }
      none => note \"no map\"
    }
  }
}

agent keeper {
  state told: Int = 0
  state heard: Int = 0

  // It gets its letters when the core is free.
  service take on inform Chart(c) at most every 100 ms worst 40 ms deadline 100 ms core 0 {
    when map_overlap(c.grid, c.grid) == 1 => set told = told + 1
  }

  service listen on charts(c) {
    when map_overlap(c.grid, c.grid) == 1 => set heard = heard + 1
  }
}

mission sent {
  robot scout: khepera4 at pose((0 m, 0 m), 0 deg) runs maker, keeper
  goal wait { subgoal wait by keeper achieved when told >= 1000 }
  done when now >= 3 s
  within 10 s
  metric made = scout.maker.made
  metric told = scout.keeper.told
  metric heard = scout.keeper.heard
}
";

#[test]
fn what_nobody_has_in_a_state_arrives_all_the_same() {
    let dir = folder("objects_sent");
    let path = file(&dir, "sent.soi", SENT);
    let o = soifra(&["run", &path, "--trace", "none", "--format", "json"]);
    assert_eq!(code(&o), 0, "{}{}", stdout(&o), stderr(&o));
    let report = json(&o);
    let metric = |name: &str| report["metrics"][name].as_f64().unwrap_or(f64::NAN);
    assert!(metric("made") >= 29.0, "{report}");
    assert!(metric("told") >= metric("made") - 2.0, "{report}");
    assert!(metric("heard") >= metric("made") - 6.0, "{report}");
}
