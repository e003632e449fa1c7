//! The same inputs give the same records, whatever the number of threads.

use crate::support::*;
use soifra_runtime::Settings;

const SWARM: &str = r#"
edition 1
record Beat { position: Point<map>, rank: Int }
topic beat: Beat = channel(range: 3 m, capacity: 4, loss: 0.1)
param gain: Number = 1
mission m {
  clock step 1 s
  robot a[300]: pawn at (1 m * modulo(1 * index, 20), 1.5 m * floor(index / 20)) scatter normal(sd: 10 cm) runs walker(rank: index)
  goal g { subgoal s by walker achieved when walked >= 5 m }
  done when achieved(g)
  within 12 steps
  expect each robot: eventually truth.path_length >= 4 m
  metric way = sum robot: truth.path_length
}
agent walker(rank: Int) {
  sensor pose: Pose<map>
  actuator legs: Stride
  event met
  state walked: Length = 0 m
  state meetings: Int = 0
  service early every step priority 3 {
    publish beat Beat(position: pose.position, rank: rank)
    when modulo(1 * rank, 7) == 0 => raise met
  }
  service count on event met { set meetings = meetings + 1 }
  service walk every step after 500 ms {
    let peers = heard(beat).filter(b => b.rank < rank)
    let length = 50 cm + 10 cm * length(peers) + draw(uniform(0 m, 1 m))
    set walked = walked + length
    command legs Stride(heading: if modulo(1 * rank, 2) == 0 then towards(0 deg) else towards(90 deg), length: length)
    when rank == 5 and walked > 3 m => set gain = 2
  }
}
"#;

#[test]
fn one_thread_and_two_write_the_same_bytes() {
    let mission = mission(SWARM);
    let trace = |threads| {
        let ran = run_with(&mission, &Settings { threads, ..settings() }, |_| {});
        ran.check_records();
        let records: Vec<String> = ran.records.iter().map(|r| serde_json::to_string(r).unwrap()).collect();
        (records, serde_json::to_string(&ran.report).unwrap())
    };
    let one = trace(1);
    assert!(one.0.len() > 10_000);
    assert_eq!(one, trace(1));
    assert_eq!(one, trace(2));
    assert_eq!(one, trace(3));
}
