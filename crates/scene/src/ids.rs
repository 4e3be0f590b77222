//! Typed indices into the flat vectors of a [`Scene`](crate::Scene).

macro_rules! typed_ids {
    ($($(#[$doc:meta])* $name:ident),* $(,)?) => {$(
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
        pub struct $name(pub u32);

        impl $name {
            /// The index into the scene's vector.
            #[inline]
            #[must_use]
            pub fn index(self) -> usize {
                self.0 as usize
            }
        }
    )*};
}

typed_ids! {
    /// A shape: a surface with one material.
    ShapeId,
    /// A material: how a surface scatters light, with its textures.
    MaterialId,
    /// A texture: a quantity that varies over a surface.
    TextureId,
    /// An emitter: a source of light.
    EmitterId,
    /// A shape group: shapes that instances place in the scene.
    GroupId,
    /// A placed instance of a shape group.
    InstanceId,
    /// A medium: the matter that fills the space between surfaces.
    MediumId,
}
