//! The rules of light transport, each stated once.
//!
//! Rules that are shaded in SIMD lanes are generic over [`Real`](etendue_math::lanes::Real): with
//! `f32` a rule handles one path, with [`Lanes`](etendue_math::lanes::Lanes) one path in each lane.
//! Both give the same bits.
//!
//! | rule | where |
//! |---|---|
//! | multiple importance sampling | [`power_heuristic`], [`next_event_weight`] |
//! | light that a path hits | [`Emission`], [`emitted`], [`distant`] |
//! | next-event estimation | [`NextEvent`] |
//! | how a path continues, strict normals | [`Continuation`], [`StrictNormals`] |
//! | Russian roulette | [`Roulette`] |
//! | limited indirect light | [`ClampIndirect`] |
//! | hidden emitters | [`HideEmitters`], [`first_hit`] |
//! | null transmission through thin sheets | [`ThinSheet`] |
//! | alpha | [`Alpha`] |

mod alpha;
mod clamp_indirect;
mod continuation;
mod emission;
mod hide_emitters;
mod mis;
mod next_event;
mod numbers;
mod roulette;
mod shading;
mod thin_sheet;
mod visibility;

pub(crate) use alpha::Alpha;
pub(crate) use clamp_indirect::ClampIndirect;
pub(crate) use continuation::{Continuation, PathWeight};
pub(crate) use emission::{Emission, PathVertex, distant, emitted};
pub(crate) use hide_emitters::HideEmitters;
pub(crate) use mis::{next_event_weight, power_heuristic};
pub(crate) use next_event::{NextEvent, ProposedLight};
pub(crate) use numbers::{ScatterNumbers, VertexNumbers};
pub(crate) use roulette::Roulette;
pub(crate) use shading::{LaneScattering, ShadingPoint, StrictNormals};
pub(crate) use thin_sheet::ThinSheet;
pub(crate) use visibility::{first_hit, first_surface, skip_hits};
