//! Vectors and frames, generic over [`Real`].

use super::float::{LaneArray, Lanes};
use super::mask::Mask as _;
use super::real::Real;
use fearless_simd::Simd;
use glam::{Vec2, Vec3};
use std::ops::{Add, Mul, Neg, Sub};

/// A two-dimensional vector, or one per lane.
#[derive(Clone, Copy, Debug)]
pub struct Vector2<R> {
    /// The x coordinate.
    pub x: R,
    /// The y coordinate.
    pub y: R,
}

/// A three-dimensional vector, or one per lane.
#[derive(Clone, Copy, Debug)]
pub struct Vector3<R> {
    /// The x coordinate.
    pub x: R,
    /// The y coordinate.
    pub y: R,
    /// The z coordinate.
    pub z: R,
}

impl<R: Real> Vector2<R> {
    /// The vector with these coordinates.
    #[inline(always)]
    #[must_use]
    pub fn new(x: R, y: R) -> Self {
        Self { x, y }
    }

    /// The squared length.
    #[inline(always)]
    #[must_use]
    pub fn length_squared(self) -> R {
        self.x * self.x + self.y * self.y
    }

    /// Appends a third coordinate.
    #[inline(always)]
    #[must_use]
    pub fn extend(self, z: R) -> Vector3<R> {
        Vector3 { x: self.x, y: self.y, z }
    }

    /// `yes` where the mask is true, `no` elsewhere.
    #[inline(always)]
    #[must_use]
    pub fn select(mask: R::Mask, yes: Self, no: Self) -> Self {
        Self { x: R::select(mask, yes.x, no.x), y: R::select(mask, yes.y, no.y) }
    }
}

impl<R: Real> Vector3<R> {
    /// The vector with these coordinates.
    #[inline(always)]
    #[must_use]
    pub fn new(x: R, y: R, z: R) -> Self {
        Self { x, y, z }
    }

    /// The same vector in as many lanes as `number` has.
    #[inline(always)]
    #[must_use]
    pub fn like(number: R, vector: Vec3) -> Self {
        Self { x: number.like(vector.x), y: number.like(vector.y), z: number.like(vector.z) }
    }

    /// Applies a function to each coordinate.
    #[inline(always)]
    #[must_use]
    pub fn map(self, function: impl Fn(R) -> R) -> Self {
        Self { x: function(self.x), y: function(self.y), z: function(self.z) }
    }

    /// The dot product.
    #[inline(always)]
    #[must_use]
    pub fn dot(self, other: Self) -> R {
        self.x * other.x + self.y * other.y + self.z * other.z
    }

    /// The cross product.
    #[inline(always)]
    #[must_use]
    pub fn cross(self, other: Self) -> Self {
        Self {
            x: self.y * other.z - other.y * self.z,
            y: self.z * other.x - other.z * self.x,
            z: self.x * other.y - other.x * self.y,
        }
    }

    /// The squared length.
    #[inline(always)]
    #[must_use]
    pub fn length_squared(self) -> R {
        self.dot(self)
    }

    /// The length.
    #[inline(always)]
    #[must_use]
    pub fn length(self) -> R {
        self.length_squared().sqrt()
    }

    /// The absolute values of the coordinates.
    #[inline(always)]
    #[must_use]
    pub fn abs(self) -> Self {
        self.map(R::abs)
    }

    /// The greatest coordinate.
    #[inline(always)]
    #[must_use]
    pub fn max_element(self) -> R {
        self.x.max(self.y.max(self.z))
    }

    /// The maximum of each pair of coordinates.
    #[inline(always)]
    #[must_use]
    pub fn max(self, other: Self) -> Self {
        Self { x: self.x.max(other.x), y: self.y.max(other.y), z: self.z.max(other.z) }
    }

    /// The normalised vector, and whether it is valid. It is not if the length is zero or not
    /// finite, or if its reciprocal overflows.
    #[inline(always)]
    #[must_use]
    pub fn try_normalize(self) -> (Self, R::Mask) {
        let reciprocal = self.length().reciprocal();
        (self * reciprocal, reciprocal.is_finite() & reciprocal.above(0.0))
    }

    /// The normalised vector; NaN if the length is zero.
    #[inline(always)]
    #[must_use]
    pub fn normalize(self) -> Self {
        self * self.length().reciprocal()
    }

    /// The normalised vector, or zero if it is not valid.
    #[inline(always)]
    #[must_use]
    pub fn normalize_or_zero(self) -> Self {
        let zero = self.x.zero();
        self.normalize_or(Self::new(zero, zero, zero))
    }

    /// The normalised vector, or `fallback` if it is not valid.
    #[inline(always)]
    #[must_use]
    pub fn normalize_or(self, fallback: Self) -> Self {
        let (unit, is_valid) = self.try_normalize();
        Self::select(is_valid, unit, fallback)
    }

    /// Whether all coordinates are finite.
    #[inline(always)]
    #[must_use]
    pub fn is_finite(self) -> R::Mask {
        self.x.is_finite() & self.y.is_finite() & self.z.is_finite()
    }

    /// Drops the third coordinate.
    #[inline(always)]
    #[must_use]
    pub fn truncate(self) -> Vector2<R> {
        Vector2 { x: self.x, y: self.y }
    }

    /// `yes` where the mask is true, `no` elsewhere.
    #[inline(always)]
    #[must_use]
    pub fn select(mask: R::Mask, yes: Self, no: Self) -> Self {
        Self {
            x: R::select(mask, yes.x, no.x),
            y: R::select(mask, yes.y, no.y),
            z: R::select(mask, yes.z, no.z),
        }
    }
}

impl<S: Simd> Vector3<Lanes<S>> {
    /// The same vector in all lanes.
    #[inline(always)]
    #[must_use]
    pub fn splat(simd: S, vector: Vec3) -> Self {
        let [x, y, z] = vector.to_array().map(|coordinate| Lanes::splat(simd, coordinate));
        Self { x, y, z }
    }

    /// Loads from one array per coordinate; see [`Lanes::load`].
    #[inline(always)]
    #[must_use]
    pub fn load(simd: S, arrays: &[LaneArray; 3], first: usize) -> Self {
        let load = |axis: usize| Lanes::load(simd, &arrays[axis], first);
        Self { x: load(0), y: load(1), z: load(2) }
    }

    /// Stores to one array per coordinate; see [`Lanes::store`].
    #[inline(always)]
    pub fn store(self, arrays: &mut [LaneArray; 3], first: usize) {
        let [x, y, z] = arrays;
        self.x.store(x, first);
        self.y.store(y, first);
        self.z.store(z, first);
    }

    /// The vector in one lane.
    #[inline(always)]
    #[must_use]
    pub fn lane(&self, lane: usize) -> Vec3 {
        Vec3::new(self.x.lane(lane), self.y.lane(lane), self.z.lane(lane))
    }
}

impl Vector3<f32> {
    /// Writes the vector to one lane of the columns.
    #[inline(always)]
    pub fn put(self, arrays: &mut [LaneArray; 3], lane: usize) {
        let [x, y, z] = arrays;
        (x.0[lane], y.0[lane], z.0[lane]) = (self.x, self.y, self.z);
    }

    /// Reads the vector in one lane of the columns.
    #[inline(always)]
    #[must_use]
    pub fn take(arrays: &[LaneArray; 3], lane: usize) -> Self {
        let [x, y, z] = arrays;
        Self { x: x.0[lane], y: y.0[lane], z: z.0[lane] }
    }
}

impl Vector2<f32> {
    /// Writes the vector to one lane of the columns.
    #[inline(always)]
    pub fn put(self, arrays: &mut [LaneArray; 2], lane: usize) {
        let [x, y] = arrays;
        (x.0[lane], y.0[lane]) = (self.x, self.y);
    }
}

impl<S: Simd> Vector2<Lanes<S>> {
    /// The same vector in all lanes.
    #[inline(always)]
    #[must_use]
    pub fn splat(simd: S, vector: Vec2) -> Self {
        Self { x: Lanes::splat(simd, vector.x), y: Lanes::splat(simd, vector.y) }
    }

    /// Loads from one array per coordinate; see [`Lanes::load`].
    #[inline(always)]
    #[must_use]
    pub fn load(simd: S, arrays: &[LaneArray; 2], first: usize) -> Self {
        let load = |axis: usize| Lanes::load(simd, &arrays[axis], first);
        Self { x: load(0), y: load(1) }
    }

    /// Stores to one array per coordinate; see [`Lanes::store`].
    #[inline(always)]
    pub fn store(self, arrays: &mut [LaneArray; 2], first: usize) {
        let [x, y] = arrays;
        self.x.store(x, first);
        self.y.store(y, first);
    }
}

impl<R: Real> Add for Vector2<R> {
    type Output = Self;

    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self { x: self.x + other.x, y: self.y + other.y }
    }
}

impl<R: Real> Sub for Vector2<R> {
    type Output = Self;

    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Self { x: self.x - other.x, y: self.y - other.y }
    }
}

impl<R: Real> Mul for Vector2<R> {
    type Output = Self;

    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        Self { x: self.x * other.x, y: self.y * other.y }
    }
}

impl<R: Real> Mul<R> for Vector2<R> {
    type Output = Self;

    #[inline(always)]
    fn mul(self, factor: R) -> Self {
        Self { x: self.x * factor, y: self.y * factor }
    }
}

impl<R: Real> Add for Vector3<R> {
    type Output = Self;

    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self { x: self.x + other.x, y: self.y + other.y, z: self.z + other.z }
    }
}

impl<R: Real> Sub for Vector3<R> {
    type Output = Self;

    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Self { x: self.x - other.x, y: self.y - other.y, z: self.z - other.z }
    }
}

impl<R: Real> Mul<R> for Vector3<R> {
    type Output = Self;

    #[inline(always)]
    fn mul(self, factor: R) -> Self {
        Self { x: self.x * factor, y: self.y * factor, z: self.z * factor }
    }
}

impl<R: Real> Neg for Vector3<R> {
    type Output = Self;

    #[inline(always)]
    fn neg(self) -> Self {
        Self { x: -self.x, y: -self.y, z: -self.z }
    }
}

impl From<Vec2> for Vector2<f32> {
    #[inline(always)]
    fn from(vector: Vec2) -> Self {
        Self { x: vector.x, y: vector.y }
    }
}

impl From<Vector2<f32>> for Vec2 {
    #[inline(always)]
    fn from(vector: Vector2<f32>) -> Self {
        Self::new(vector.x, vector.y)
    }
}

impl From<Vec3> for Vector3<f32> {
    #[inline(always)]
    fn from(vector: Vec3) -> Self {
        Self { x: vector.x, y: vector.y, z: vector.z }
    }
}

impl From<Vector3<f32>> for Vec3 {
    #[inline(always)]
    fn from(vector: Vector3<f32>) -> Self {
        Self::new(vector.x, vector.y, vector.z)
    }
}

/// A right-handed orthonormal basis, or one per lane; see [`Frame`](crate::Frame).
#[derive(Clone, Copy, Debug)]
pub struct Frame3<R> {
    /// The local x axis.
    pub s: Vector3<R>,
    /// The local y axis.
    pub t: Vector3<R>,
    /// The local z axis, the normal.
    pub n: Vector3<R>,
}

impl<R: Real> Frame3<R> {
    /// A frame with the unit normal `n` and an arbitrary tangent.
    ///
    /// Duff et al., "Building an Orthonormal Basis, Revisited", JCGT 6(1), 2017.
    #[inline(always)]
    #[must_use]
    pub fn from_normal(n: Vector3<R>) -> Self {
        let sign = n.z.like(1.0).copysign(n.z);
        let a = n.z.like(-1.0) / (sign + n.z);
        let b = n.x * n.y * a;
        let s = Vector3::new(sign * n.x * n.x * a + 1.0, sign * b, -sign * n.x);
        let t = Vector3::new(b, sign + n.y * n.y * a, -n.y);
        Self { s, t, n }
    }

    /// The frame with the unit normal `n` whose `s` is as close to `tangent` as possible. The
    /// tangent is arbitrary if `tangent` is zero, not finite, or parallel to the normal.
    #[inline(always)]
    #[must_use]
    pub fn from_normal_and_tangent(n: Vector3<R>, tangent: Vector3<R>) -> Self {
        let along = tangent - n * n.dot(tangent);
        let length_squared = along.length_squared();
        // Below this threshold, the result of the subtraction is rounding noise.
        let is_direction =
            length_squared.is_finite() & length_squared.gt(tangent.length_squared() * 1e-12);
        let s = along * length_squared.sqrt().reciprocal();
        let aligned = Self { s, t: n.cross(s), n };
        if is_direction.all() {
            return aligned;
        }
        let any = Self::from_normal(n);
        Self {
            s: Vector3::select(is_direction, aligned.s, any.s),
            t: Vector3::select(is_direction, aligned.t, any.t),
            n,
        }
    }

    /// Transforms from world to local coordinates.
    #[inline(always)]
    #[must_use]
    pub fn to_local(&self, v: Vector3<R>) -> Vector3<R> {
        Vector3::new(self.s.dot(v), self.t.dot(v), self.n.dot(v))
    }

    /// Transforms from local to world coordinates.
    #[inline(always)]
    #[must_use]
    pub fn to_world(&self, v: Vector3<R>) -> Vector3<R> {
        self.s * v.x + self.t * v.y + self.n * v.z
    }
}
