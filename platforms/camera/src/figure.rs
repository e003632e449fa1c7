//! A walking person.

use crate::geometry::{Pose, Rotation};
use crate::mesh::{Mesh, Surface};
use crate::scene::{PartIndex, PartPose, Scene};
use crate::texture::Texture;

/// Colours of what a figure wears and is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Clothes {
    /// Of head and hands.
    pub skin: [u8; 3],
    /// Of the hair.
    pub hair: [u8; 3],
    /// Of torso and arms.
    pub shirt: [u8; 3],
    /// Of the legs.
    pub trousers: [u8; 3],
    /// Of the shoes.
    pub shoes: [u8; 3],
}

impl Default for Clothes {
    fn default() -> Self {
        Self {
            skin: [205, 155, 125],
            hair: [60, 42, 30],
            shirt: [178, 44, 40],
            trousers: [44, 56, 98],
            shoes: [36, 32, 30],
        }
    }
}

/// A limb: a part of the scene that swings about a joint.
#[derive(Clone, Copy, Debug)]
struct Limb {
    part: PartIndex,
    /// Metres left and up of the point on the ground below the figure's middle.
    joint: [f64; 2],
    /// Radians of its swing to either side; negative begins with the swing back.
    swing: f64,
}

/// A person of a given height whose arms and legs swing as it walks: parts of a scene, placed for each frame.
#[derive(Clone, Debug)]
pub struct Figure {
    trunk: PartIndex,
    limbs: [Limb; 4],
    height: f64,
}

/// Sizes below are those of a figure of this height, in metres.
const BUILT: f64 = 1.75;

/// Radians that a leg swings to either side.
const STRIDE: f64 = 0.45;

/// Radians that an arm swings to either side.
const ARM_SWING: f64 = 0.38;

/// Metres of a leg from hip to sole.
const LEG: f64 = 0.86;

impl Figure {
    /// Adds a figure's textures and parts to a scene: `height` in metres.
    pub fn new(scene: &mut Scene, height: f64, clothes: &Clothes) -> Self {
        let scale = height / BUILT;
        let mut surface = |colour, repeat: f64| {
            let texture = scene.add_texture(Texture::cloth(colour));
            Surface { texture, repeat: repeat * scale }
        };
        let [skin, hair] = [clothes.skin, clothes.hair].map(|colour| surface(colour, 0.8));
        let [shirt, trousers, shoes] =
            [clothes.shirt, clothes.trousers, clothes.shoes].map(|c| surface(c, 0.5));
        let at = |position: [f64; 3]| position.map(|c| c * scale);
        let size = at;

        let mut trunk = Mesh::new();
        trunk.cuboid(at([0.0, 0.0, 0.92]), size([0.20, 0.33, 0.14]), 0.0, trousers);
        trunk.cuboid(at([0.0, 0.0, 1.22]), size([0.22, 0.38, 0.46]), 0.0, shirt);
        trunk.cylinder(at([0.0, 0.0, 1.44]), 0.06 * scale, 0.08 * scale, 8, skin);
        trunk.cylinder(at([0.0, 0.0, 1.50]), 0.095 * scale, 0.17 * scale, 12, skin);
        trunk.cylinder(at([0.0, 0.0, 1.66]), 0.10 * scale, 0.09 * scale, 12, hair);
        trunk.cuboid(at([-0.06, 0.0, 1.62]), size([0.09, 0.19, 0.14]), 0.0, hair);
        let trunk = scene.add_part(trunk);

        // Limbs hang from the origin of their own frame.
        let mut leg = Mesh::new();
        leg.cuboid(at([0.0, 0.0, -LEG / 2.0 + 0.02]), size([0.15, 0.14, LEG - 0.08]), 0.0, trousers);
        leg.cuboid(at([0.04, 0.0, -LEG + 0.03]), size([0.26, 0.12, 0.06]), 0.0, shoes);
        let leg = scene.add_part(leg);
        let mut arm = Mesh::new();
        arm.cuboid(at([0.0, 0.0, -0.27]), size([0.10, 0.09, 0.54]), 0.0, shirt);
        arm.cuboid(at([0.0, 0.0, -0.60]), size([0.09, 0.07, 0.14]), 0.0, skin);
        let arm = scene.add_part(arm);

        let limb = |part, joint: [f64; 2], swing| Limb { part, joint: joint.map(|c| c * scale), swing };
        let limbs = [
            limb(leg, [0.09, LEG], STRIDE),
            limb(leg, [-0.09, LEG], -STRIDE),
            limb(arm, [0.24, 1.42], -ARM_SWING),
            limb(arm, [-0.24, 1.42], ARM_SWING),
        ];
        Self { trunk, limbs, height }
    }

    /// Metres that it walks in one period of its phase, two steps.
    #[must_use]
    pub fn stride(&self) -> f64 {
        4.0 * LEG * libm::sin(STRIDE) * self.height / BUILT
    }

    /// Adds the figure to a frame: the point on the ground that it stands on (x, y, z), its heading in radians from
    /// east to the left, and how far it is in its stride: 0 and 1 with its legs together, the left one going forward.
    pub fn place(&self, ground: [f64; 3], heading: f64, phase: f64, parts: &mut Vec<PartPose>) {
        let swing = if phase.is_finite() { libm::sin(core::f64::consts::TAU * phase) } else { 0.0 };
        // With its legs apart it is lower: its feet stay on the ground.
        let lower = LEG * (1.0 - libm::cos(STRIDE * swing)) * self.height / BUILT;
        let [x, y, z] = ground;
        let body = Pose::upright([x, y, z - lower], heading);
        parts.push(PartPose { part: self.trunk, pose: body });
        for limb in &self.limbs {
            let [left, up] = limb.joint;
            // About the axis to the left a positive turn swings what hangs down backward.
            let rotation = Rotation::from_roll_pitch_yaw(0.0, -limb.swing * swing, 0.0);
            let pose = body.after(&Pose { position: [0.0, left, up], rotation });
            parts.push(PartPose { part: limb.part, pose });
        }
    }
}
