//! Render paths of the sculpture.

/// How the sculpture is rendered.
#[derive(Clone, Copy, PartialEq, Eq, Default, Debug)]
pub enum RenderPath {
    /// Section 4 of the paper, or a variant of it.
    Paper(PaperVariant),
    /// Ray marching of the smooth surface of the blurred volume.
    #[default]
    Fast,
}

/// The paper's path, or one of the experiments of its section 5.
#[derive(Clone, Copy, PartialEq, Eq, Default, Debug)]
pub enum PaperVariant {
    /// All of it.
    #[default]
    Whole,
    /// All three range maps sampled at every step.
    FullMarch,
    /// The voxel's face instead of the blobs' distance field.
    NoSdf,
    /// The normal as the colour.
    NoShading,
}
