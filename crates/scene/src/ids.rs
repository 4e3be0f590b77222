//! Typed indices into the flat vectors of a [`Scene`](crate::Scene).

macro_rules! typed_ids {
    ($($(#[$doc:meta])* $name:ident),* $(,)?) => {$(
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
        pub struct $name(pub u32);

        impl $name {
            /// The position in the scene's vector.
            #[inline]
            #[must_use]
            pub fn index(self) -> usize {
                self.0 as usize
            }
        }
    )*};
}

typed_ids! {
    /// A shape: something that rays hit, with one material.
    ShapeId,
    /// A material: how a surface scatters light, with its textures.
    MaterialId,
    /// A texture: a quantity that varies over a surface.
    TextureId,
    /// An emitter: where light comes from.
    EmitterId,
    /// A shape group: shapes that instances place in the scene.
    GroupId,
    /// A shape group that has been placed in the scene.
    InstanceId,
    /// A medium: what fills the space between surfaces.
    MediumId,
}
