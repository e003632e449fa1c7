//! Watching people: the ground under the camera, and images in which nobody is.

use proptest::prelude::*;
use soifra_vision::{
    ImageView, Lens, Why,
    attitude::Attitude,
    ground::Ground,
    people::{People, Standpoint, people},
    person::Searching,
};

fn ground(roll: f64, pitch: f64) -> Ground {
    let lens = Lens::ideal(640, 480, 1.0).unwrap();
    Ground { lens, attitude: Attitude { roll, pitch, yaw: 0.0 }, height: 0.3 }
}

fn at(time: f64) -> Standpoint {
    Standpoint { time, place: [0.0; 2], yaw: 0.0, ground: ground(0.0, 0.0) }
}

fn look(
    (width, height): (usize, usize),
    data: &[u8],
    before: Option<&People>,
    at: &Standpoint,
) -> Result<People, Why> {
    people(
        &ImageView::new(width, height, data.len() / (width * height), data)?,
        before,
        at,
        &Searching::default(),
    )
}

#[test]
fn where_nothing_is_to_be_seen_the_reason_is_told() {
    let all = |level: u8| vec![level; 640 * 480 * 3];
    assert_eq!(look((640, 480), &all(0), None, &at(0.0)), Err(Why::Black));
    assert_eq!(look((640, 480), &all(255), None, &at(0.0)), Err(Why::White));
    assert_eq!(look((640, 480), &vec![90; 640 * 480], None, &at(0.0)), Err(Why::WrongChannels));
    assert_eq!(look((8, 8), &[90; 192], None, &at(0.0)), Err(Why::TooSmall));
}

#[test]
fn nobody_is_in_a_blank_image_nor_in_a_tiny_one() {
    for (size, data) in [((640, 480), vec![120; 640 * 480 * 3]), ((16, 16), vec![120; 16 * 16 * 3])] {
        let seen = look(size, &data, None, &at(0.0)).unwrap();
        assert!(seen.tracks.is_empty());
        let again = look(size, &data, Some(&seen), &at(0.1)).unwrap();
        assert!(again.tracks.is_empty());
        assert_eq!(look(size, &data, Some(&again), &at(0.1)), Err(Why::ZeroInterval));
        assert_eq!(look(size, &data, Some(&again), &at(0.0)), Err(Why::NegativeInterval));
    }
}

#[test]
fn a_camera_that_is_nowhere_is_refused() {
    let data = vec![120; 640 * 480 * 3];
    let mut sunk = at(0.0);
    sunk.ground.height = 0.0;
    let astray = Standpoint { place: [f64::NAN, 0.0], ..at(0.0) };
    for wrong in [sunk, astray] {
        assert_eq!(look((640, 480), &data, None, &wrong), Err(Why::BadNumber));
    }
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn a_place_is_where_its_pixel_is(
        ahead in 0.7f64..20.0, aside in -0.4f64..0.4, roll in -0.1f64..0.1, pitch in -0.1f64..0.1,
    ) {
        let g = ground(roll, pitch);
        let [x, y] = g.pixel([ahead, aside * ahead, 0.0]).unwrap();
        let [a, l] = g.place(x, y).unwrap();
        prop_assert!((a - ahead).abs() < 1e-6 * ahead && (l - aside * ahead).abs() < 1e-6 * ahead);
    }

    #[test]
    fn noise_breaks_nothing(seed in any::<u64>(), time in -1e3f64..1e3) {
        let mut state = seed | 1;
        let data: Vec<u8> = (0..64 * 48 * 3).map(|_| {
            state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            (state >> 56) as u8
        }).collect();
        let seen = look((64, 48), &data, None, &at(time)).unwrap();
        prop_assert!(seen.tracks.iter().all(|t| t.place.iter().all(|v| v.is_finite())));
    }
}
