//! The kinds of objects in a scene.

/// The class of a node, independent of its plugin: the name of its element.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[non_exhaustive]
pub enum Class {
    /// The root.
    Scene,
    /// A light transport algorithm.
    Integrator,
    /// A camera.
    Sensor,
    /// What records the camera's image.
    Film,
    /// A source of random numbers.
    Sampler,
    /// A pixel filter.
    ReconstructionFilter,
    /// A surface.
    Shape,
    /// How a surface scatters light.
    Bsdf,
    /// A value that varies over a surface.
    Texture,
    /// A light.
    Emitter,
    /// What fills a volume.
    Medium,
    /// How a medium scatters light.
    Phase,
    /// A value that varies in space.
    Volume,
    /// Subsurface scattering (version 0.6 and before).
    Subsurface,
    /// The profile of a surface of revolution.
    Curve,
}

/// The number of classes.
pub(crate) const CLASS_COUNT: usize = Class::Curve as usize + 1;

impl Class {
    /// The name of the class's element in the files, such as `bsdf`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Scene => "scene",
            Self::Integrator => "integrator",
            Self::Sensor => "sensor",
            Self::Film => "film",
            Self::Sampler => "sampler",
            Self::ReconstructionFilter => "rfilter",
            Self::Shape => "shape",
            Self::Bsdf => "bsdf",
            Self::Texture => "texture",
            Self::Emitter => "emitter",
            Self::Medium => "medium",
            Self::Phase => "phase",
            Self::Volume => "volume",
            Self::Subsurface => "subsurface",
            Self::Curve => "curve",
        }
    }

    /// The plural name used in node paths: `shapes[3]`.
    pub(crate) fn plural(self) -> String {
        match self {
            Self::Medium => "media".to_owned(),
            other => format!("{}s", other.name()),
        }
    }
}
