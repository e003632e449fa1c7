//! Textures that a world can name.

use super::{Texture, pattern};
use std::sync::OnceLock;

/// How a named texture is made.
#[derive(Clone, Copy)]
enum Make {
    Procedure(fn() -> Texture),
    Plain([u8; 3]),
}

use Make::{Plain, Procedure};

const ALL: [(&str, Make); 19] = [
    ("plaster", Procedure(pattern::plaster)),
    ("bricks", Procedure(pattern::bricks)),
    ("planks", Procedure(pattern::planks)),
    ("tiles", Procedure(pattern::tiles)),
    ("checker", Procedure(pattern::checker)),
    ("speckle", Procedure(pattern::speckle)),
    ("concrete", Procedure(pattern::concrete)),
    ("carpet", Procedure(pattern::carpet)),
    ("stripes", Procedure(pattern::stripes)),
    ("white", Plain([240, 240, 240])),
    ("grey", Plain([128, 128, 128])),
    ("black", Plain([24, 24, 24])),
    ("red", Plain([190, 40, 36])),
    ("orange", Plain([226, 122, 30])),
    ("yellow", Plain([228, 200, 50])),
    ("green", Plain([50, 140, 60])),
    ("blue", Plain([40, 80, 170])),
    ("skin", Plain([205, 155, 125])),
    ("brown", Plain([104, 72, 46])),
];

/// Names of the textures that need no file: procedures first, then plain colours.
pub const NAMES: [&str; ALL.len()] = {
    let mut names = [""; ALL.len()];
    let mut i = 0;
    while i < names.len() {
        names[i] = ALL[i].0;
        i += 1;
    }
    names
};

/// Those that have been made: a texture is the same every time, and runs follow on each other.
static MADE: [OnceLock<Texture>; ALL.len()] = [const { OnceLock::new() }; ALL.len()];

pub(super) fn by_name(name: &str) -> Option<Texture> {
    let at = ALL.iter().position(|(known, _)| *known == name)?;
    let make = || match ALL[at].1 {
        Procedure(make) => make(),
        Plain(colour) => Texture::plain(colour),
    };
    Some(MADE[at].get_or_init(make).clone())
}
