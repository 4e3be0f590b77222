//! Closures of several paths at once.
//!
//! The most common materials are written over any [`Real`]. [`LaneClosure`] is their mathematics,
//! and single hits use it as well. [`Columns`] moves their numbers into and out of the columns that
//! hold the closures of several hits.

use crate::scattering::{BsdfSample, Closure, Lobe, Transport};
use etendue_math::lanes::{Real, Vector2, Vector3};
use etendue_spectrum::{Spectrum, SpectrumLanes};
use glam::{Vec2, Vec3};

/// Sampled directions; see [`BsdfSample`]. Unused lanes hold arbitrary values.
#[derive(Clone, Copy)]
pub struct SampleLanes<R: Real> {
    /// The directions in which the paths continue, in the local frame.
    pub wo: Vector3<R>,
    /// f(wi, wo)·|cos θo| divided by `pdf`.
    pub weight: SpectrumLanes<R>,
    /// The density in solid angle; for delta lobes, the lobe's probability.
    pub pdf: R,
    /// The index of refraction on the side of `wo` divided by that on the side of `wi`.
    pub eta: R,
    /// Whether there is a sample. A lane without one has weight zero.
    pub exists: R::Mask,
    /// Whether the direction has a density in solid angle; see [`Lobe::is_smooth`].
    pub smooth: R::Mask,
    /// Whether the path passes straight through, as if there were no surface ([`Lobe::Null`]).
    pub null: R::Mask,
}

impl<R: Real> SampleLanes<R> {
    /// No sample in any lane.
    #[inline(always)]
    #[must_use]
    pub fn none(wi: Vector3<R>) -> Self {
        let (zero, never) = (wi.z.zero(), wi.z.lt(wi.z));
        Self {
            wo: wi,
            weight: SpectrumLanes::grey(zero),
            pdf: zero,
            eta: zero + 1.0,
            exists: never,
            smooth: never,
            null: never,
        }
    }

    /// Selects `yes` where the mask is true, `no` elsewhere.
    #[inline(always)]
    pub(crate) fn select(mask: R::Mask, yes: Self, no: Self) -> Self {
        Self {
            wo: Vector3::select(mask, yes.wo, no.wo),
            weight: SpectrumLanes::select(mask, yes.weight, no.weight),
            pdf: R::select(mask, yes.pdf, no.pdf),
            eta: R::select(mask, yes.eta, no.eta),
            exists: mask & yes.exists | !mask & no.exists,
            smooth: mask & yes.smooth | !mask & no.smooth,
            null: mask & yes.null | !mask & no.null,
        }
    }

    /// [`none`](Self::none), but marked as smooth.
    #[inline(always)]
    pub(crate) fn smooth(wi: Vector3<R>) -> Self {
        let none = Self::none(wi);
        Self { smooth: !none.smooth, ..none }
    }
}

/// The mathematics of a closure over any [`Real`]; [`Closure`] states the contract.
pub(crate) trait LaneClosure<R: Real> {
    /// See [`Closure::eval_pdf`].
    fn eval_pdf_lanes(
        &self,
        wi: Vector3<R>,
        wo: Vector3<R>,
        transport: Transport,
    ) -> (SpectrumLanes<R>, R);

    /// See [`Closure::sample`].
    fn sample_lanes(
        &self,
        wi: Vector3<R>,
        lobe: R,
        direction: Vector2<R>,
        transport: Transport,
    ) -> SampleLanes<R>;
}

/// Maps the numbers of a closure, one by one.
pub(crate) trait Transfer<R: Real, T: Real> {
    /// Replaces the tables of a rough coat.
    type Coat;

    /// Maps a number.
    fn number(&mut self, number: R) -> T;

    /// Maps the tables of a rough coat.
    fn coat(&self) -> Self::Coat;
}

/// Values that are stored in columns: a number, a spectrum, or a closure made of them.
pub(crate) trait Columns<R: Real>: Sized {
    /// The same type over another number type, and with another type for the tables of coats.
    type Over<T: Real, C>;

    /// How many numbers the value has.
    const COUNT: usize;

    /// The value with its numbers mapped.
    fn transfer<T: Real, N: Transfer<R, T>>(self, numbers: &mut N) -> Self::Over<T, N::Coat>;
}

impl<R: Real> Columns<R> for R {
    type Over<T: Real, C> = T;

    const COUNT: usize = 1;

    #[inline(always)]
    fn transfer<T: Real, N: Transfer<R, T>>(self, numbers: &mut N) -> T {
        numbers.number(self)
    }
}

impl<R: Real> Columns<R> for SpectrumLanes<R> {
    type Over<T: Real, C> = SpectrumLanes<T>;

    const COUNT: usize = Spectrum::LANES;

    #[inline(always)]
    fn transfer<T: Real, N: Transfer<R, T>>(self, numbers: &mut N) -> SpectrumLanes<T> {
        self.convert(
            #[inline(always)]
            |component| numbers.number(component),
        )
    }
}

/// How many numbers the field that `_field` returns has.
pub(crate) const fn count<R: Real, S, F: Columns<R>>(_field: fn(&S) -> &F) -> usize {
    F::COUNT
}

/// Implements [`Columns`] for a closure with all its fields: `columns!(DiffuseClosure { reflectance
/// })`. The field after a semicolon holds the tables of a rough coat, which are not numbers.
macro_rules! columns {
    ($closure:ident { $($field:ident),* }) => {
        impl<R: Real> $crate::lanes::Columns<R> for $closure<R> {
            type Over<T: Real, C> = $closure<T>;
            columns!(@items $closure<T> { $($field),* });
        }
    };
    ($closure:ident { $($field:ident),*; $coat:ident }) => {
        impl<D, R: Real> $crate::lanes::Columns<R> for $closure<D, R> {
            type Over<T: Real, C> = $closure<C, T>;
            columns!(@items $closure<N::Coat, T> { $($field),*; $coat });
        }
    };
    (@items $closure:ident<$($argument:ty),*> { $($field:ident),* $(; $coat:ident)? }) => {
        const COUNT: usize = 0 $(+ $crate::lanes::count::<R, Self, _>(|closure| &closure.$field))*;

        #[inline(always)]
        fn transfer<T: Real, N: $crate::lanes::Transfer<R, T>>(
            self,
            numbers: &mut N,
        ) -> $closure<$($argument),*> {
            $closure {
                $($field: $crate::lanes::Columns::<R>::transfer(self.$field, numbers),)*
                $($coat: numbers.coat(),)?
            }
        }
    };
}
pub(crate) use columns;

/// The rest of a [`Closure`] of one hit, beyond its [`LaneClosure`].
pub(crate) trait HitClosure: LaneClosure<f32> {
    /// See [`Closure::null_transmission`].
    fn null_transmission(&self, _wi: Vec3) -> (Spectrum, f32) {
        (Spectrum::ZERO, 0.0)
    }

    /// See [`Closure::has_smooth_lobe`].
    fn has_smooth_lobe(&self) -> bool;

    /// See [`Closure::albedo`].
    fn albedo(&self, wi: Vec3) -> Spectrum;
}

impl<C: HitClosure> Closure for C {
    #[inline]
    fn eval_pdf(&self, wi: Vec3, wo: Vec3, transport: Transport) -> (Spectrum, f32) {
        let (value, pdf) = self.eval_pdf_lanes(wi.into(), wo.into(), transport);
        (value.into(), pdf)
    }

    #[inline]
    fn sample(
        &self,
        wi: Vec3,
        lobe: f32,
        direction: Vec2,
        transport: Transport,
    ) -> Option<BsdfSample> {
        let sample = self.sample_lanes(wi.into(), lobe, direction.into(), transport);
        let lobe = match (sample.smooth, sample.null) {
            (true, _) => Lobe::Smooth,
            (false, true) => Lobe::Null,
            (false, false) => Lobe::Delta,
        };
        sample.exists.then(|| BsdfSample {
            wo: sample.wo.into(),
            weight: sample.weight.into(),
            pdf: sample.pdf,
            eta: sample.eta,
            lobe,
        })
    }

    fn null_transmission(&self, wi: Vec3) -> (Spectrum, f32) {
        HitClosure::null_transmission(self, wi)
    }

    #[inline]
    fn has_smooth_lobe(&self) -> bool {
        HitClosure::has_smooth_lobe(self)
    }

    fn albedo(&self, wi: Vec3) -> Spectrum {
        HitClosure::albedo(self, wi)
    }
}
