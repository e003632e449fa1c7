//! What a frame has to show, to the hundredth of a pixel, and that its bytes are always the same.

mod bands;
mod digest;
mod edges;
mod lens;
mod noise;
mod robust;
mod support;
mod textures;
mod view;
