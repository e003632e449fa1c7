//! Where things stand: edges by themselves and obstacles remembered, on exact geometry.

use soifra_vision::Lens;
use soifra_vision::attitude::{Attitude, Rates};
use soifra_vision::course::Lane;
use soifra_vision::edge::{Edge, Upright, seen};
use soifra_vision::expansion::Expansion;
use soifra_vision::follow::{EdgeSight, EdgeTrack, Moment};
use soifra_vision::known::{Known, Remembering, remember};
use soifra_vision::landmarks::{Landmark, believed, landmarks, remember_landmarks};
use soifra_vision::obstacle::{Obstacle, Pairing, obstacles};
use soifra_vision::reckoning::relative;

const WIDTH: usize = 640;

fn lens() -> Lens {
    Lens::ideal(WIDTH, 480, 60f64.to_radians()).unwrap()
}

/// Along x at 0.5 m/s, `t` seconds before the origin.
fn moment(t: f64) -> Moment {
    let place = [0.5 * t, 0.0];
    Moment { time: t, attitude: Attitude::default(), rates: Rates::default(), place, course: 0.0, pace: 0.5 }
}

/// What a camera on that way saw of an edge in the last two seconds.
fn track(id: u32, edge: [f64; 2]) -> EdgeTrack {
    let sights: Vec<EdgeSight> = (-40..=0)
        .map(|k| moment(0.05 * f64::from(k)))
        .map(|m| {
            let [ahead, left] = relative(edge, m.place, m.course);
            let upright = Upright {
                bearing: libm::atan2(left, ahead),
                tilt: 0.0,
                upper: 1.5 / ahead,
                lower: -0.3 / ahead,
            };
            EdgeSight { time: m.time, place: m.place, upright }
        })
        .collect();
    let last = sights[sights.len() - 1].upright;
    let line = seen(&last, &lens(), &Attitude::default()).unwrap();
    let edge = Edge { line, sigma: 0.1, strength: 40.0, polarity: 1.0, support: 1.0 };
    EdgeTrack { id, edge, missed: 0, sights }
}

fn placed(edges: &[[f64; 2]]) -> Vec<Landmark> {
    let tracks: Vec<EdgeTrack> = (0..).zip(edges).map(|(id, e)| track(id, *e)).collect();
    landmarks(&tracks, &moment(0.0), &lens(), 0.08, &Pairing::default())
}

#[test]
fn an_edge_beside_the_course_is_placed_and_one_ahead_is_not() {
    let found = placed(&[[2.0, 0.8], [3.0, -1.2], [3.0, 0.01]]);
    assert_eq!(found.iter().map(|p| p.id).collect::<Vec<_>>(), [0, 1]);
    for (landmark, truth) in found.iter().zip([[2.0, 0.8], [3.0, -1.2]]) {
        assert!((landmark.place[0] - truth[0]).abs() < 1e-6 && (landmark.place[1] - truth[1]).abs() < 1e-6);
        assert!(landmark.sigma > 0.0 && landmark.sigma < 0.3, "{}", landmark.sigma);
    }
}

fn landmark(id: u32, place: [f64; 2]) -> Landmark {
    Landmark { id, place, sigma: 0.05, missed: 0.0 }
}

fn after(before: &[Landmark], now_placed: Vec<Landmark>, now: &Moment, interval: f64) -> Vec<Landmark> {
    let how = Remembering::default();
    remember_landmarks(before, now_placed, now, (interval, true), (&lens(), WIDTH), &how)
}

#[test]
fn what_is_out_of_sight_stays_and_what_should_show_and_does_not_goes() {
    let how = Remembering::default();
    let beside = landmark(1, [0.2, 1.0]);
    let ahead = landmark(2, [3.0, 0.5]);
    let far = landmark(3, [-20.0, 0.0]);
    let mut known = vec![beside, ahead, far];
    let frames = (how.doubt / 0.05).ceil() as u32 + 1;
    for _ in 0..frames {
        known = after(&known, vec![], &moment(0.0), 0.05);
    }
    assert_eq!(known.iter().map(|p| p.id).collect::<Vec<_>>(), [1], "beside: the image does not show it");
    // One that another edge confirms stays, and so does one that is doubted by a robot that stands.
    let mut known = vec![ahead];
    for k in 0..frames {
        known = after(&known, vec![landmark(10 + k, [3.1, 0.5])], &moment(0.0), 0.05);
    }
    assert!(known.iter().any(|p| p.id == 2));
    let mut known = vec![ahead];
    for _ in 0..frames {
        known = remember_landmarks(&known, vec![], &moment(0.0), (0.05, false), (&lens(), WIDTH), &how);
    }
    assert_eq!(known.len(), 1);
}

#[test]
fn the_better_place_of_an_edge_is_kept_and_one_alone_is_not_believed() {
    let how = Remembering::default();
    let good = landmark(1, [2.0, 0.5]);
    let worse = Landmark { sigma: 0.2, ..landmark(1, [2.1, 0.5]) };
    let known = after(&[good], vec![worse], &moment(0.0), 0.05);
    assert_eq!(known.len(), 1);
    assert_eq!(known[0].place, good.place);
    // Elsewhere altogether: the edge was mistaken for another.
    let elsewhere = Landmark { sigma: 0.2, ..landmark(1, [4.0, 0.5]) };
    assert_eq!(after(&[good], vec![elsewhere], &moment(0.0), 0.05)[0].place, elsewhere.place);
    assert_eq!(believed(&[good], &how), Vec::<[f64; 2]>::new());
    assert_eq!(believed(&[good, landmark(2, [2.0, 2.0])], &how), Vec::<[f64; 2]>::new());
    assert_eq!(believed(&[good, landmark(2, [2.1, 0.6])], &how).len(), 2);
}

#[test]
fn memory_is_bounded() {
    let how = Remembering::default();
    let many: Vec<Landmark> = (0..1000).map(|k| landmark(k, [1.0 + 1e-3 * f64::from(k), 0.5])).collect();
    let known = after(&[], many, &moment(0.0), 0.05);
    assert_eq!(known.len(), how.most_landmarks);
    assert_eq!(known[0].id, 0, "the nearest stay");
}

/// What the places of two tracks make when they are looked at from `m`.
fn obstacle(m: &Moment, edges: [[f64; 2]; 2], sigma: f64) -> Obstacle {
    let tracks = [track(1, edges[0]), track(2, edges[1])];
    let mut found = obstacles(&tracks, m, &lens(), &Pairing::default()).unwrap().remove(0);
    found.contact.sigma = sigma;
    found
}

#[test]
fn the_range_that_was_known_best_counts() {
    let how = Remembering::default();
    let now = moment(0.0);
    let edges = [[3.0, 0.4], [3.0, -0.5]];
    let good = obstacle(&now, edges, 0.01);
    let known = remember(&[], (std::slice::from_ref(&good), &[]), &now, (0.05, true), (&lens(), WIDTH), &how);
    let told = known[0].contact(&now, how.recent).unwrap();
    assert!((told - 6.0).abs() < 0.01, "3 m at 0.5 m/s: {told}");
    // A worse one a little later, off by a second, says nothing against it.
    let later = moment(0.2);
    let mut worse = good.clone();
    worse.contact.ttc = 5.0;
    worse.contact.sigma = 0.3;
    let next =
        remember(&known, (std::slice::from_ref(&worse), &[]), &later, (0.2, true), (&lens(), WIDTH), &how);
    assert!((next[0].contact(&later, how.recent).unwrap() - 5.8).abs() < 0.01);
    // A better one does.
    let better = Obstacle { contact: Expansion { sigma: 0.001, ..worse.contact }, ..worse.clone() };
    let next = remember(&known, (&[better], &[]), &later, (0.2, true), (&lens(), WIDTH), &how);
    assert!((next[0].contact(&later, how.recent).unwrap() - 5.0).abs() < 1e-9);
    // Not seen any more, it is told for a while; after a turn, not at all.
    assert!(known[0].contact(&moment(how.recent - 0.01), how.recent).is_some());
    assert_eq!(known[0].contact(&moment(how.recent + 0.01), how.recent), None);
    assert_eq!(known[0].contact(&Moment { course: 0.3, ..now }, how.recent), None);
}

#[test]
fn a_known_obstacle_in_full_view_that_is_not_seen_is_forgotten() {
    let how = Remembering::default();
    let now = moment(0.0);
    let seen = obstacle(&now, [[3.0, 0.4], [3.0, -0.5]], 0.01);
    let mut known = Vec::new();
    for _ in 0..how.fewest {
        known =
            remember(&known, (std::slice::from_ref(&seen), &[]), &now, (0.05, true), (&lens(), WIDTH), &how);
    }
    assert!(known[0].is_sure(&how));
    let met = known[0].met(&now, &Lane { left: 0.3, right: -0.3 }).unwrap();
    assert!((met - 3.0).abs() < 0.05, "{met}");
    let frames = (how.doubt / 0.05).ceil() as usize;
    let unseen =
        |before: &[Known], moves| remember(before, (&[], &[]), &now, (0.05, moves), (&lens(), WIDTH), &how);
    let mut standing = known.clone();
    for _ in 0..=frames {
        known = unseen(&known, true);
        standing = unseen(&standing, false);
    }
    assert!(known.is_empty());
    assert_eq!(standing.len(), 1, "who stands measures nothing");
}

#[test]
fn an_obstacle_reaches_as_far_as_it_was_seen_to_of_late() {
    let how = Remembering::default();
    let now = moment(0.0);
    let whole = obstacle(&now, [[3.0, 0.4], [3.0, -0.5]], 0.01);
    let known = remember(&[], (&[whole], &[]), &now, (0.05, true), (&lens(), WIDTH), &how);
    let part = [Obstacle { left_id: 7, ..obstacle(&now, [[3.0, -0.1], [3.0, -0.5]], 0.01) }];
    let left = |known: &[Known]| relative(known[0].left, now.place, now.course)[1];
    // Its left part is not seen for two frames: it is still there.
    let mut later = known.clone();
    for k in 1..=2 {
        let m = moment(0.05 * f64::from(k));
        later = remember(&later, (&part, &[]), &m, (0.05, true), (&lens(), WIDTH), &how);
        assert_eq!(later.len(), 1);
        assert!((left(&later) - 0.4).abs() < 0.05, "{}", left(&later));
    }
    // After longer it is not, ...
    let m = moment(0.05);
    let long_ago = [Known { reached: [-how.extent; 2], ..known[0] }];
    let late = remember(&long_ago, (&part, &[]), &m, (0.05, true), (&lens(), WIDTH), &how);
    assert!((left(&late) + 0.1).abs() < 0.05, "{}", left(&late));
    // ... nor where something far behind is seen in that direction.
    let behind = Landmark { id: 9, place: [8.0, 0.5], sigma: 0.1, missed: 0.0 };
    let open = remember(&known, (&part, &[behind]), &m, (0.05, true), (&lens(), WIDTH), &how);
    assert!((left(&open) + 0.1).abs() < 0.05, "{}", left(&open));
}
