//! The services on a made-up room, with scans whose geometry is exact.

use soifra_mapping::{
    Beam, Field, Grid, Layout, Path, Place, Why,
    matching::{Matching, Near, match_scan},
    observe::observe,
    particles::{Localising, Particles, localise},
    place::{apart, wrap},
    route::{Room, plan},
    shape::Shape,
};
use std::f64::consts::{FRAC_PI_2, PI};

const ROOM: Room = Room { clearance: 0.4, comfort: 0.4 };

/// A room of 8 m by 6 m with a wall that leaves 2 m, and a pillar.
fn shapes() -> Vec<Shape> {
    let corners = [[0.0, 0.0], [8.0, 0.0], [8.0, 6.0], [0.0, 6.0], [0.0, 0.0]];
    let mut all: Vec<Shape> = corners.windows(2).map(|w| Shape::wall(w[0], w[1], 0.1)).collect();
    all.push(Shape::wall([4.0, 0.0], [4.0, 4.0], 0.1));
    all.push(Shape::Disc { at: [6.0, 2.0], radius: 0.3 });
    all
}

fn layout() -> Layout {
    Layout::covering([-0.2, -0.2], [8.2, 6.2], 0.05).expect("a layout")
}

/// A scan of 181 beams over half a turn, by marching.
fn scan(from: Place, shapes: &[Shape]) -> Vec<Beam> {
    let beam = |i: i32| {
        let bearing = f64::from(i - 90) * PI / 180.0;
        let (s, c) = libm::sincos(from.yaw + bearing);
        let mut range = 0.0;
        for _ in 0..400 {
            let at = [from.at[0] + range * c, from.at[1] + range * s];
            let near = shapes.iter().map(|s| s.distance(at)).fold(f64::INFINITY, f64::min);
            if near < 1e-4 || range > 20.0 {
                break;
            }
            range += near;
        }
        Beam { bearing, range: (range <= 20.0).then_some(range) }
    };
    (0..181).map(beam).collect()
}

#[test]
fn a_way_keeps_its_clearance_and_leads_round() {
    let field = Field::of(&Grid::known(layout(), &shapes()));
    let way = plan(&field, [1.0, 1.0], [7.0, 1.0], &ROOM).expect("a way");
    assert_eq!((way[0], way[way.len() - 1]), ([1.0, 1.0], [7.0, 1.0]));
    for p in &way {
        let near = shapes().iter().map(|s| s.distance(*p)).fold(f64::INFINITY, f64::min);
        assert!(near > ROOM.clearance - 0.06, "{p:?} {near}");
    }
    assert!(way.windows(2).all(|w| apart(w[0], w[1]) < 0.12));
    // Not much longer than round the end of the wall at the clearance.
    let length = Path::new(way).expect("a path").length();
    let taut = apart([1.0, 1.0], [4.0, 4.4]) + apart([4.0, 4.4], [7.0, 1.0]);
    assert!(length < 1.15 * taut, "{length} {taut}");
}

#[test]
fn what_has_no_way_says_why() {
    let mut all = shapes();
    all.push(Shape::wall([4.0, 4.0], [4.0, 6.0], 0.1));
    let field = Field::of(&Grid::known(layout(), &all));
    assert_eq!(plan(&field, [1.0, 1.0], [7.0, 1.0], &ROOM), Err(Why::NoWay));
    assert_eq!(plan(&field, [1.0, 1.0], [6.0, 2.0], &ROOM), Err(Why::TargetNotFree));
    assert_eq!(plan(&field, [6.0, 2.0], [1.0, 1.0], &ROOM), Err(Why::StartNotFree));
    assert_eq!(plan(&field, [99.0, 0.0], [1.0, 1.0], &ROOM), Err(Why::StartNotFree));
    assert_eq!(plan(&field, [f64::NAN, 0.0], [1.0, 1.0], &ROOM), Err(Why::BadNumber));
    // Too near to a wall at the start: it goes away from it.
    assert!(plan(&field, [0.25, 1.0], [2.0, 1.0], &ROOM).is_ok());
}

#[test]
fn pursuit_comes_back_to_a_straight_way() {
    let way = Path::new(vec![[0.0, 0.0], [20.0, 0.0]]).expect("a path");
    let mut place = Place::new(0.0, 0.5, 0.0);
    assert!((way.track(place, 1.0).deviation - 0.5).abs() < 1e-12);
    for _ in 0..600 {
        let curvature = way.track(place, 1.0).curvature;
        place = place.then(Place::new(0.02, 0.0, 0.02 * curvature));
    }
    let t = way.track(place, 1.0);
    assert!(t.deviation.abs() < 0.01 && t.bearing.abs() < 0.02, "{t:?}");
    assert!((t.remaining - (20.0 - place.at[0])).abs() < 1e-9);
    // Its look-ahead point lies on the circle of the arc: 2 y / d².
    let t = way.track(Place::new(0.0, -1.0, 0.0), 1.0);
    assert!((t.curvature - 2.0 * 1.0 / 2.0).abs() < 1e-12);
}

#[test]
fn a_way_is_free_to_where_something_stands() {
    let way = Path::new(vec![[1.0, 2.0], [7.0, 2.0]]).expect("a path");
    let field = Field::of(&Grid::known(layout(), &shapes()));
    let free = way.free(&field, [1.5, 2.1], 0.4);
    // The wall's face is at 3.95, the body stops 0.4 before it.
    assert!((free - (3.95 - 0.4 - 1.5)).abs() < 0.11, "{free}");
    let short = Path::new(vec![[1.0, 2.0], [2.0, 2.0]]).expect("a path");
    assert!((short.free(&field, [1.5, 2.0], 0.4) - 0.5).abs() < 1e-9);
}

/// Drives along a line and localises on the way, from a start that is off; odometry drifts. The errors at the end.
fn drive(extra: &[Shape]) -> (f64, f64) {
    let field = Field::of(&Grid::known(layout(), &shapes()));
    let mut really = shapes();
    really.extend_from_slice(extra);
    let mut place = Place::new(1.0, 1.0, FRAC_PI_2);
    let start = Place::new(1.15, 0.9, FRAC_PI_2 + 0.05);
    let mut odometry = Place::default();
    let mut belief: Option<Particles> = None;
    for i in 0..60 {
        let turn = if i < 30 { 0.0 } else { -0.03 };
        place = place.then(Place::new(0.06, 0.0, turn));
        // Wheels that slip by 3 %, a gyroscope that drifts.
        odometry = odometry.then(Place::new(0.06 * 1.03, 0.0, turn + 0.0005));
        let seen = scan(place, &really);
        let how = Localising::default();
        let random = f64::from(i) / 60.0;
        belief =
            Some(localise(belief.as_ref(), start, odometry, &seen, &field, random, &how).expect("a belief"));
    }
    let e = belief.expect("a belief").estimate;
    let derived = e.origin.then(odometry);
    assert!(apart(derived.at, e.place.at) < 1e-9);
    (apart(e.place.at, place.at), wrap(e.place.yaw - place.yaw).abs())
}

#[test]
fn localisation_finds_the_robot_and_bears_what_is_not_on_the_map() {
    let (off, turned) = drive(&[]);
    assert!(off < 0.06 && turned < 0.03, "{off} {turned}");
    let strangers = [Shape::Disc { at: [2.2, 3.5], radius: 0.4 }, Shape::block([3.0, 5.3], [0.8, 0.6], 0.4)];
    let (off, turned) = drive(&strangers);
    assert!(off < 0.1 && turned < 0.05, "{off} {turned}");
    assert_eq!(drive(&[]), drive(&[]), "the same draws, the same belief");
}

#[test]
fn scans_that_say_nothing_are_refused() {
    let field = Field::of(&Grid::known(layout(), &shapes()));
    let nothing = [Beam { bearing: 0.0, range: None }];
    let place = Place::new(1.0, 1.0, 0.0);
    let how = Localising::default();
    let none = localise(None, place, place, &nothing, &field, 0.5, &how).map(|p| p.estimate);
    assert_eq!(none, Err(Why::NothingInRange));
    let bad = localise(None, Place::new(f64::NAN, 0.0, 0.0), place, &nothing, &field, 0.5, &how);
    assert_eq!(bad.map(|p| p.estimate), Err(Why::BadNumber));
    assert_eq!(
        match_scan(&Near::new(&field), &nothing, place, &Matching::default()),
        Err(Why::NothingInRange)
    );
}

#[test]
fn a_scan_fits_where_it_was_taken() {
    let place = Place::new(2.0, 3.0, 0.3);
    let mut grid = Grid::unknown(layout());
    for _ in 0..3 {
        grid = observe(&grid, place, &scan(place, &shapes()), 20.0);
    }
    let field = Field::of(&grid);
    let there = Place::new(2.3, 3.1, 0.35);
    let guess = Place::new(2.22, 3.17, 0.39);
    let found =
        match_scan(&Near::new(&field), &scan(there, &shapes()), guess, &Matching::default()).expect("a pose");
    // Faces lie on edges of cells here: a grid of 5 cm can be off by half a cell along each axis.
    assert!(apart(found.at, there.at) < 0.036 && (found.yaw - there.yaw).abs() < 0.01, "{found:?}");
    let elsewhere = Field::of(&Grid::unknown(layout()));
    let refused = match_scan(&Near::new(&elsewhere), &scan(there, &shapes()), guess, &Matching::default());
    assert_eq!(refused, Err(Why::NoMatch));
}
