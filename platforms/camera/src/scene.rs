//! What there is to see.

use crate::geometry::Pose;
use crate::mesh::Mesh;
use crate::sky::Sky;
use crate::texture::Texture;

/// A texture of a scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct TextureIndex(pub(crate) u32);

impl TextureIndex {
    /// How many textures the scene took before this one.
    #[must_use]
    pub fn number(self) -> usize {
        self.0 as usize
    }
}

/// A part of a scene: a mesh that has a pose in every frame, or several, or none.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct PartIndex(pub(crate) u32);

/// That a part is in a frame, and where.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PartPose {
    /// Which part.
    pub part: PartIndex,
    /// Of the part's frame, in the world.
    pub pose: Pose,
}

/// Textures, triangles that stay, and parts that move.
#[derive(Clone, Debug, Default)]
pub struct Scene {
    /// What is seen where there is no triangle.
    pub sky: Sky,
    /// Triangles that stay, in the world's frame.
    pub fixed: Mesh,
    textures: Vec<Texture>,
    parts: Vec<Mesh>,
}

impl Scene {
    /// An empty scene under the default sky.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Takes a texture for surfaces of this scene.
    pub fn add_texture(&mut self, texture: Texture) -> TextureIndex {
        self.textures.push(texture);
        TextureIndex(self.textures.len() as u32 - 1)
    }

    /// Takes a mesh, in its own frame, that frames place by a [`PartPose`].
    pub fn add_part(&mut self, mesh: Mesh) -> PartIndex {
        self.parts.push(mesh);
        PartIndex(self.parts.len() as u32 - 1)
    }

    /// The texture, or none if the index is another scene's.
    #[must_use]
    pub fn texture(&self, index: TextureIndex) -> Option<&Texture> {
        self.textures.get(index.0 as usize)
    }

    /// The part, or none if the index is another scene's.
    #[must_use]
    pub fn part(&self, index: PartIndex) -> Option<&Mesh> {
        self.parts.get(index.0 as usize)
    }

    pub(crate) fn textures(&self) -> &[Texture] {
        &self.textures
    }
}
