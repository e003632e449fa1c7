//! The bytes of Y4M files: converted to RGB exactly, and whatever they are, an answer.

use proptest::prelude::*;
use soifra::recording::Y4m;
use std::io::Cursor;

/// A file with these parameters and one frame of these planes.
fn file(parameters: &str, planes: &[u8]) -> Vec<u8> {
    [format!("YUV4MPEG2 {parameters}\nFRAME\n").as_bytes(), planes].concat()
}

fn pixels(parameters: &str, planes: &[u8]) -> Vec<u8> {
    let mut input = Cursor::new(file(parameters, planes));
    let video = Y4m::index(&mut input).expect("a video");
    video.image(&mut input, 0).expect("a frame")
}

#[test]
fn colours_are_those_of_bt_601() {
    // White, black, and the primaries as BT.601 has them in 8 bits.
    let cases = [
        ([235, 128, 128], [255, 255, 255]),
        ([16, 128, 128], [0, 0, 0]),
        ([81, 90, 240], [255, 0, 0]),
        ([145, 54, 34], [0, 255, 0]),
        ([41, 240, 110], [0, 0, 255]),
    ];
    for (yuv, rgb) in cases {
        let got = pixels("W1 H1 F20:1 C444", &yuv);
        let near = got.iter().zip(rgb).all(|(a, b)| a.abs_diff(b) <= 2);
        assert!(near, "{yuv:?} gives {got:?}, not {rgb:?}");
    }
    assert_eq!(pixels("W1 H1 F20:1 C444 XCOLORRANGE=FULL", &[200, 128, 128]), [200, 200, 200]);
    assert_eq!(pixels("W2 H1 F20:1 Cmono XCOLORRANGE=FULL", &[7, 250]), [7, 7, 7, 250, 250, 250]);
}

#[test]
fn a_sample_of_chroma_counts_for_its_pixels() {
    // 3 x 3 pixels have 2 x 2 samples of chroma in 4:2:0 and 2 x 3 in 4:2:2.
    let luma = [128u8; 9];
    let of = |parameters: &str, blue: &[u8]| {
        let planes = [&luma[..], blue, &vec![128; blue.len()]].concat();
        pixels(parameters, &planes).chunks_exact(3).map(|p| p[2] > 140).collect::<Vec<bool>>()
    };
    assert_eq!(
        of("W3 H3 F20:1", &[255, 128, 128, 255]),
        [true, true, false, true, true, false, false, false, true]
    );
    assert_eq!(
        of("W3 H3 F20:1 C422", &[255, 128, 128, 255, 255, 128]),
        [true, true, false, false, false, true, true, true, false]
    );
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]

    #[test]
    fn every_frame_of_what_is_taken_can_be_had(
        width in 1usize..20,
        height in 1usize..20,
        frames in 1usize..5,
        sampling in prop::sample::select(vec!["420jpeg", "422", "444", "mono"]),
        cut in 0usize..40,
        seed: u64,
    ) {
        let chroma = match sampling {
            "420jpeg" => width.div_ceil(2) * height.div_ceil(2),
            "422" => width.div_ceil(2) * height,
            "444" => width * height,
            _ => 0,
        };
        let size = width * height + 2 * chroma;
        let mut bytes = format!("YUV4MPEG2 W{width} H{height} F30000:1001 Ip A1:1 C{sampling}\n").into_bytes();
        for n in 0..frames {
            bytes.extend(b"FRAME Ip\n");
            bytes.extend((0..size).map(|i| (seed >> (i % 57)) as u8 ^ (i * 31 + n) as u8));
        }
        bytes.truncate(bytes.len() - cut.min(bytes.len()));
        let mut input = Cursor::new(bytes);
        match Y4m::index(&mut input) {
            Ok(video) => {
                // A file that ends with a frame is taken; of a cut one only if whole frames are missing.
                prop_assert!(cut % (size + 9) == 0);
                prop_assert_eq!(video.rate, Some((30000, 1001)));
                for n in 0..video.count() {
                    prop_assert_eq!(video.image(&mut input, n).map(|i| i.len()), Ok(3 * width * height));
                }
                prop_assert!(video.image(&mut input, video.count()).is_err());
            }
            Err(why) => {
                prop_assert!(cut > 0);
                prop_assert!(!why.seen().is_empty());
            }
        }
    }

    #[test]
    fn any_bytes_get_an_answer(bytes in prop::collection::vec(any::<u8>(), 0..300), headed: bool) {
        let bytes = if headed { file("W3 H2 F20:1", &bytes) } else { bytes };
        soifra::fuzz::fuzz_images(&bytes);
    }
}
