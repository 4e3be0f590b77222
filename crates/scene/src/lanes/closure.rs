//! Closures of several paths at once.
//!
//! The materials that nearly all surfaces have are written over any [`Real`]: [`LaneClosure`] is their
//! mathematics, which a single hit uses as well. [`Columns`] takes their numbers into and out of the
//! columns that hold the closures of several hits.

use crate::scattering::{BsdfSample, Closure, Lobe, Transport};
use etendue_math::lanes::{Real, Vector2, Vector3};
use etendue_spectrum::{Spectrum, SpectrumLanes};
use glam::{Vec2, Vec3};

/// Directions that closures chose; see [`BsdfSample`]. Lanes that do not exist hold anything.
#[derive(Clone, Copy)]
pub struct SampleLanes<R: Real> {
    /// Where the paths go on, in the local frame.
    pub wo: Vector3<R>,
    /// f(wi, wo)·|cos θo| divided by `pdf`.
    pub weight: SpectrumLanes<R>,
    /// The density in solid angle; where the sample is not smooth, the lobe's probability.
    pub pdf: R,
    /// The index of refraction on the side of `wo` over that on the side of `wi`.
    pub eta: R,
    /// Whether there is a sample at all: where not, it counts as one of weight zero.
    pub exists: R::Mask,
    /// Whether the direction has a density in solid angle; see [`Lobe::is_smooth`].
    pub smooth: R::Mask,
    /// Whether the path goes straight on, as if no surface were there ([`Lobe::Null`]).
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

    /// `yes` where the mask is true, `no` elsewhere.
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

    /// As [`none`](Self::none), but smooth should it exist.
    #[inline(always)]
    pub(crate) fn smooth(wi: Vector3<R>) -> Self {
        let none = Self::none(wi);
        Self { smooth: !none.smooth, ..none }
    }
}

/// The mathematics of a closure over any [`Real`]; the contract is that of [`Closure`].
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

/// Passes on the numbers of a closure, one after the other.
pub(crate) trait Transfer<R: Real, T: Real> {
    /// What takes the place of the tables that a rough coat looks up.
    type Coat;

    /// What a number becomes.
    fn number(&mut self, number: R) -> T;

    /// What the tables of a rough coat become.
    fn coat(&self) -> Self::Coat;
}

/// Numbers that are kept in columns: a number, a spectrum, or a closure made of them.
pub(crate) trait Columns<R: Real>: Sized {
    /// The same over numbers of another type, and with other tables of coats.
    type Over<T: Real, C>;

    /// How many numbers it consists of.
    const COUNT: usize;

    /// The same with its numbers passed on.
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

/// How many numbers the field that `_field` returns consists of.
pub(crate) const fn count<R: Real, S, F: Columns<R>>(_field: fn(&S) -> &F) -> usize {
    F::COUNT
}

/// Makes a closure [`Columns`] of all its fields: `columns!(DiffuseClosure { reflectance })`. After a
/// semicolon comes the field of a rough coat's tables, which are no numbers.
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

/// What a closure of one hit has beside its [`LaneClosure`]; it is then a [`Closure`].
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
