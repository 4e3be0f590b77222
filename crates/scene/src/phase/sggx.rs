//! `sggx`: a cloud of microflakes with the normals of an ellipsoid.

#[cfg(test)]
use super::tests::Cases;
use super::{MediumInteraction, PhaseModel, PhaseSample};
use crate::builder::Builder;
use crate::manual::{Manual, parameter};
use crate::volume::Volume;
use crate::volume::gridvolume::GridVolume;
use etendue_document::{Fault, Parameters, Value};
use etendue_math::Frame;
use etendue_sampling::warp;
use glam::{IVec3, Mat3, Vec2, Vec3};
use std::f32::consts::PI;
use std::sync::Arc;

/// The manual page.
pub const MANUAL: Manual = Manual {
    summary: "A cloud of tiny mirrors (microflakes), whose normals are spread as those of an \
              ellipsoid: for fibres, and for surfaces made into volumes. The medium's extinction is \
              multiplied by the area that the flakes show to a direction.",
    parameters: &[parameter(
        "S",
        "volume or string",
        "",
        "The ellipsoid's symmetric, positive definite matrix as Sxx, Syy, Szz, Sxy, Sxz, Syz: a \
         `gridvolume` with six values in a cell, or six numbers; required.",
    )],
    sample: r#"<phase type="sggx"><string name="S" value="0.2, 1, 0.2, 0, 0, 0"/></phase>"#,
};

/// The cases for the tests of all phase functions.
#[cfg(test)]
#[rustfmt::skip]
pub(crate) const CASES: Cases = Cases {
    usual: &[
        r#"<phase type="sggx"><string name="S" value="1 1 1 0 0 0"/></phase>"#,
        r#"<phase type="sggx"><string name="S" value="0.1 0.8 0.3 0.05 -0.1 0.2"/></phase>"#,
        r#"<phase type="sggx"><volume name="S" type="gridvolume"><string name="filename" value="flakes.vol"/></volume></phase>"#,
    ],
    extreme: &[
        r#"<phase type="sggx"><string name="S" value="1e-6 1e-6 1 0 0 0"/></phase>"#,
        r#"<phase type="sggx"><string name="S" value="1e-6 1 1 0 0 0"/></phase>"#,
    ],
};

/// Heitz, Dupuy, Crassin and Dachsbacher, "The SGGX microflake distribution", *ACM Transactions on
/// Graphics* 34(4), 2015. The microflakes are mirrors.
#[derive(Clone, Debug)]
pub struct Sggx {
    matrices: Matrices,
    greatest_area: f32,
}

/// The matrix of the ellipsoid.
#[derive(Clone, Debug)]
enum Matrices {
    Uniform(Mat3),
    Grid(Arc<GridVolume>),
}

/// Reads the parameters.
#[must_use]
pub fn build(builder: &mut Builder<'_>, parameters: &Parameters<'_>) -> Option<Sggx> {
    let built = match parameters.child("S") {
        Some(child) => builder.volume(child.node).map(Sggx::from_volume)?,
        None => match parameters.value("S") {
            Some((Value::String(text), _)) => Sggx::from_text(text),
            Some(_) => Err("expected a volume or six numbers".to_owned()),
            None => {
                parameters.error(Fault::MissingParameter, "S", "`sggx` needs the parameter `S`");
                return None;
            }
        },
    };
    built.map_err(|problem| parameters.error(Fault::BadValue, "S", problem)).ok()
}

/// The symmetric matrix with entries Sxx, Syy, Szz, Sxy, Sxz, Syz.
#[inline]
fn matrix([xx, yy, zz, xy, xz, yz]: [f32; 6]) -> Mat3 {
    Mat3::from_cols(Vec3::new(xx, xy, xz), Vec3::new(xy, yy, yz), Vec3::new(xz, yz, zz))
}

/// An upper bound on the squared projected area. The maximum is the largest eigenvalue, which is
/// bounded by the trace and by the largest row sum (Gershgorin).
fn greatest_area_squared(s: &Mat3) -> f32 {
    let trace = s.x_axis.x + s.y_axis.y + s.z_axis.z;
    let rows = [s.x_axis, s.y_axis, s.z_axis].map(|row| row.abs().element_sum());
    rows.into_iter().fold(0.0, f32::max).min(trace)
}

fn is_positive_definite(s: &Mat3) -> bool {
    let minor = s.x_axis.x * s.y_axis.y - s.x_axis.y * s.x_axis.y;
    s.x_axis.x > 0.0 && minor > 0.0 && s.determinant() > 0.0 && s.determinant().is_finite()
}

impl Sggx {
    fn from_text(text: &str) -> Result<Self, String> {
        let numbers: Vec<f32> = text
            .split([',', ' ', '\t', '\n'])
            .filter(|word| !word.is_empty())
            .map(|word| word.parse().map_err(|_| format!("`{word}` is no number")))
            .collect::<Result<_, _>>()?;
        let found = numbers.len();
        let six = <[f32; 6]>::try_from(numbers);
        let s = matrix(six.map_err(|_| format!("expected six numbers, not {found}"))?);
        if !is_positive_definite(&s) {
            return Err("the matrix is not positive definite".to_owned());
        }
        let greatest_area = greatest_area_squared(&s).sqrt();
        Ok(Self { matrices: Matrices::Uniform(s), greatest_area })
    }

    fn from_volume(volume: Volume) -> Result<Self, String> {
        let Volume::Grid(grid) = volume else {
            return Err("a matrix has six values: one colour is not enough".to_owned());
        };
        if grid.channels() != 6 {
            return Err(format!("a matrix has six values in a cell, not {}", grid.channels()));
        }
        let mut greatest = 0.0_f32;
        let IVec3 { x: width, y: height, z: depth } = grid.size();
        for z in 0..depth {
            for y in 0..height {
                for x in 0..width {
                    let s = matrix(std::array::from_fn(|i| grid.cell(IVec3::new(x, y, z))[i]));
                    // Cells without microflakes are all zero.
                    if s != Mat3::ZERO && !is_positive_definite(&s) {
                        return Err(format!(
                            "the matrix of cell {x}, {y}, {z} is not positive definite"
                        ));
                    }
                    greatest = greatest.max(greatest_area_squared(&s));
                }
            }
        }
        Ok(Self { matrices: Matrices::Grid(grid), greatest_area: greatest.sqrt() })
    }

    #[inline]
    fn matrix_at(&self, point: Vec3) -> Mat3 {
        match &self.matrices {
            Matrices::Uniform(s) => *s,
            Matrices::Grid(grid) => matrix(grid.eval_six(point)),
        }
    }
}

impl PhaseModel for Sggx {
    /// The projected area in a direction: √(ωᵀ S ω), equation 10.
    #[inline]
    fn projected_area(&self, interaction: &MediumInteraction) -> f32 {
        area(&self.matrix_at(interaction.point), interaction.wi)
    }

    fn greatest_area(&self) -> f32 {
        self.greatest_area
    }

    fn is_uniform(&self) -> bool {
        matches!(self.matrices, Matrices::Uniform(_))
    }

    fn shows_one_area(&self) -> bool {
        false
    }

    fn collect_grids<'a>(&'a self, grids: &mut Vec<&'a Arc<GridVolume>>) {
        match &self.matrices {
            Matrices::Uniform(_) => {}
            Matrices::Grid(grid) => grids.push(grid),
        }
    }

    /// The density of `wo`: D(h) / 4 σ(wi), equation 14.
    fn eval(&self, interaction: &MediumInteraction, wo: Vec3) -> f32 {
        density(&self.matrix_at(interaction.point), interaction.wi, wo)
    }

    /// Samples a microflake visible from `wi` and reflects the path at it (section 4.3).
    fn sample(
        &self,
        interaction: &MediumInteraction,
        _part: f32,
        direction: Vec2,
    ) -> Option<PhaseSample> {
        let s = self.matrix_at(interaction.point);
        let frame = Frame::from_normal(interaction.wi);
        let axes = Mat3::from_cols(frame.s, frame.t, frame.n);
        let local = axes.transpose() * s * axes;
        // The columns of the Cholesky factor, with `wi` as the first axis. They map the hemisphere
        // around `wi` to the visible side of the ellipsoid.
        let to_wi = local.z_axis / local.z_axis.z.sqrt();
        let rest = local.y_axis - to_wi * to_wi.y;
        let to_side = rest / rest.y.sqrt();
        let last = (local.x_axis.x - to_wi.x * to_wi.x - to_side.x * to_side.x).max(0.0).sqrt();
        let seen = warp::cosine_hemisphere::sample(direction);
        let normal = to_wi * seen.z + to_side * seen.y + Vec3::X * (last * seen.x);
        let normal = frame.to_world(normal).try_normalize()?;
        let wo = (2.0 * interaction.wi.dot(normal) * normal - interaction.wi).try_normalize()?;
        let pdf = density(&s, interaction.wi, wo);
        (pdf > 0.0 && pdf.is_finite()).then_some(PhaseSample { wo, pdf })
    }
}

#[inline]
fn area(s: &Mat3, direction: Vec3) -> f32 {
    direction.dot(*s * direction).max(0.0).sqrt()
}

/// D(h) / 4 σ(wi), with the distribution of normals of equation 12:
/// D(m) = 1 / (π √|S| (mᵀ S⁻¹ m)²).
fn density(s: &Mat3, wi: Vec3, wo: Vec3) -> f32 {
    let Some(half) = (wi + wo).try_normalize() else { return 0.0 };
    let determinant = s.determinant();
    if determinant <= 0.0 {
        return 0.0;
    }
    // mᵀ S⁻¹ m = |√|S| m|² with the adjugate, which avoids division by a small determinant.
    let adjugate = Mat3::from_cols(
        s.y_axis.cross(s.z_axis),
        s.z_axis.cross(s.x_axis),
        s.x_axis.cross(s.y_axis),
    );
    let form = half.dot(adjugate * half);
    let normals = determinant * determinant.sqrt() / (PI * form * form);
    let density = normals / (4.0 * area(s, wi));
    if density.is_finite() { density } else { 0.0 }
}
