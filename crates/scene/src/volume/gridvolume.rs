//! `gridvolume`: values on a grid, from a file or from memory.

use super::{UNIT_CUBE, VolumeModel};
use crate::builder::{Assets, Builder};
use crate::inputs::grid_file::{self, GridError, GridFile};
use crate::inputs::texels::WrapMode;
use crate::manual::{Manual, parameter};
use etendue_document::{Fault, Parameters};
use etendue_math::{Bounds3, Transform};
use etendue_spectrum::Spectrum;
use glam::{DMat4, IVec3, Vec3};
use std::sync::Arc;

/// The manual page.
pub const MANUAL: Manual = Manual {
    summary: "Values on a grid, from a file in Mitsuba's format (`.vol`, version 3; 32-bit floats, \
              and version 0.6's 16-bit floats and bytes). The grid fills the unit cube, which \
              `to_world` places; its values stand at the middles of the cells. One value a cell is \
              a scalar, three are a linear colour, six belong to `sggx`.",
    parameters: &[
        parameter("filename", "string", "", "The file; required unless there is `data`."),
        parameter(
            "data",
            "buffer",
            "",
            "Instead of a file: layers along z, rows along y, columns along x, and channels where there \
             are several, of floats or of unsigned integers with 8 or 16 bits, which are fractions. For \
             scenes built in code.",
        ),
        parameter(
            "filter_type",
            "string",
            "trilinear",
            "`trilinear`, between the middles of cells, or `nearest`, which shows the cells.",
        ),
        parameter(
            "wrap_mode",
            "string",
            "clamp",
            "What lies outside the cube: `clamp` (the values of its faces), `repeat` or `mirror`.",
        ),
        parameter(
            "use_grid_bbox",
            "boolean",
            "false",
            "Let the grid fill the box that the file names, instead of the unit cube.",
        ),
        parameter("to_world", "transform", "", "Places the cube, or the file's box."),
        parameter(
            "max_value",
            "float",
            "",
            "Accepted and without effect: bounds come from the values.",
        ),
        parameter("raw", "boolean", "false", "Accepted and without effect: values are linear."),
        parameter("accel", "boolean", "true", "Accepted and without effect."),
    ],
    sample: r#"<volume type="gridvolume"><string name="filename" value="smoke.vol"/></volume>"#,
};

/// How values between cell centres are computed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum FilterMode {
    /// Trilinear interpolation.
    #[default]
    Trilinear,
    /// The value of the nearest cell.
    Nearest,
}

/// Values on a grid that fills the unit cube in local space.
#[derive(Clone, Debug)]
pub struct GridVolume {
    size: IVec3,
    channels: usize,
    /// The channels of a cell are interleaved; x varies fastest among the cells.
    values: Vec<f32>,
    range: [f32; 2],
    filter: FilterMode,
    wrap: WrapMode,
    to_world: Transform,
}

/// Eight adjacent cells and their weights.
struct Footprint {
    /// Offsets of the first values: x fastest, then y, then z.
    starts: [usize; 8],
    fraction: Vec3,
}

/// Reads the volume.
#[must_use]
pub fn build(builder: &mut Builder<'_>, parameters: &Parameters<'_>) -> Option<Arc<GridVolume>> {
    builder
        .assets
        .kept(parameters, &[], |assets, parameters| read(assets, parameters).map(Arc::new))
}

fn read(assets: &Assets<'_>, parameters: &Parameters<'_>) -> Option<GridVolume> {
    let options = Options::read(parameters);
    let file = if parameters.has("data") {
        grid_in_memory(parameters)?
    } else {
        grid_in_file(assets, parameters)?
    };
    let box_to_world = if options.use_grid_bbox {
        options.to_world * from_unit_cube(&file.bounds)
    } else {
        options.to_world
    };
    let Some(to_world) = Transform::from_matrix(&box_to_world) else {
        let message = "the volume's box is flat, or its place is not finite";
        parameters.error(Fault::BadValue, "to_world", message);
        return None;
    };
    Some(GridVolume::new(file, &options, to_world))
}

fn grid_in_file(assets: &Assets<'_>, parameters: &Parameters<'_>) -> Option<GridFile> {
    let (path, bytes) = assets.read_file(parameters, "filename")?;
    let report = |error: GridError| {
        let fault = if error.is_unsupported() { Fault::Unsupported } else { Fault::Syntax };
        parameters.error(fault, "filename", format!("{}: {error}", path.display()));
    };
    grid_file::read(&bytes).map_err(report).ok()
}

/// Reads the grid from a buffer: layers, rows and columns of cells, and channels if there are
/// several.
fn grid_in_memory(parameters: &Parameters<'_>) -> Option<GridFile> {
    let fail = |name: &str, message: String| {
        parameters.error(Fault::BadValue, name, message);
        None
    };
    if parameters.has("filename") {
        let message = "a grid comes from `filename` or from `data`, not from both";
        // Mark both as read, so that neither is reported as unknown.
        let _ = (parameters.value("filename"), parameters.value("data"));
        return fail("filename", message.to_owned());
    }
    let buffer = parameters.buffer("data")?;
    let (sides, channels) = match *buffer.shape() {
        [z, y, x] => ([x, y, z], 1),
        [z, y, x, channels] => ([x, y, z], channels),
        ref other => {
            let message =
                format!("`data` has the shape {other:?}, but needs layers, rows and columns");
            return fail("data", message);
        }
    };
    let Some(values) = buffer.to_fractions() else {
        let found = buffer.elements().type_name();
        let message = format!("`data` must hold floats, bytes or 16-bit integers, not {found}");
        return fail("data", message);
    };
    match GridFile::in_unit_cube(sides, channels, values) {
        Ok(grid) => Some(grid),
        Err(error) => fail("data", format!("`data`: {error}")),
    }
}

/// The transform from the unit cube to a box.
fn from_unit_cube(bounds: &Bounds3) -> DMat4 {
    DMat4::from_translation(bounds.min.as_dvec3())
        * DMat4::from_scale(bounds.max.as_dvec3() - bounds.min.as_dvec3())
}

/// All parameters except the file.
struct Options {
    filter: FilterMode,
    wrap: WrapMode,
    use_grid_bbox: bool,
    to_world: DMat4,
}

impl Options {
    fn read(parameters: &Parameters<'_>) -> Self {
        const FILTERS: [(&str, FilterMode); 2] =
            [("trilinear", FilterMode::Trilinear), ("nearest", FilterMode::Nearest)];
        const WRAPS: [(&str, WrapMode); 3] = [
            ("clamp", WrapMode::Clamp),
            ("repeat", WrapMode::Repeat),
            ("mirror", WrapMode::Mirror),
        ];
        parameters.optional_float("max_value");
        parameters.optional_boolean("raw");
        parameters.optional_boolean("accel");
        Self {
            filter: parameters.choice("filter_type", FilterMode::Trilinear, &FILTERS),
            wrap: parameters.choice("wrap_mode", WrapMode::Clamp, &WRAPS),
            use_grid_bbox: parameters.boolean("use_grid_bbox", false),
            to_world: parameters.transform("to_world"),
        }
    }
}

impl VolumeModel for GridVolume {
    #[inline]
    fn eval(&self, point: Vec3) -> Spectrum {
        self.eval(point)
    }

    #[inline]
    fn eval_scalar(&self, point: Vec3) -> f32 {
        self.eval_scalar(point)
    }

    fn bounds(&self) -> Bounds3 {
        self.bounds()
    }

    fn range(&self) -> [f32; 2] {
        self.range()
    }

    fn mean(&self) -> Spectrum {
        self.mean()
    }

    fn channels(&self) -> usize {
        self.channels()
    }
}

impl GridVolume {
    fn new(file: GridFile, options: &Options, to_world: Transform) -> Self {
        let range =
            file.values.iter().fold([f32::INFINITY, f32::NEG_INFINITY], |[low, high], value| {
                [low.min(*value), high.max(*value)]
            });
        Self {
            size: IVec3::from_array(file.size.map(|side| side as i32)),
            channels: file.channels,
            values: file.values,
            range,
            filter: options.filter,
            wrap: options.wrap,
            to_world,
        }
    }

    /// The grid with zero in place of negative values.
    pub(crate) fn without_negative(&self) -> Self {
        let values = self.values.iter().map(|value| value.max(0.0)).collect();
        Self { values, range: self.range.map(|bound| bound.max(0.0)), ..self.clone() }
    }

    /// The colour at a world-space point: grey for one value per cell, the first three of six.
    #[inline]
    #[must_use]
    pub fn eval(&self, point: Vec3) -> Spectrum {
        if self.channels == 1 {
            return Spectrum::splat(self.interpolate(point, |start| self.values[start]));
        }
        self.interpolate(point, |start| {
            Spectrum::from_rgb([self.values[start], self.values[start + 1], self.values[start + 2]])
        })
    }

    /// The scalar at a world-space point: the only value, the luminance of a colour, or the mean of
    /// six.
    #[inline]
    #[must_use]
    pub fn eval_scalar(&self, point: Vec3) -> f32 {
        match self.channels {
            1 => self.interpolate(point, |start| self.values[start]),
            3 => self.eval(point).luminance(),
            _ => self.eval_six(point).iter().sum::<f32>() / 6.0,
        }
    }

    /// The six values at a world-space point, padded with zeros.
    #[must_use]
    pub fn eval_six(&self, point: Vec3) -> [f32; 6] {
        let channel = |index: usize| {
            let held = index < self.channels;
            if held { self.interpolate(point, |start| self.values[start + index]) } else { 0.0 }
        };
        std::array::from_fn(channel)
    }

    /// The interpolated value at a world-space point. `read` returns the value of the cell at an
    /// offset.
    #[inline]
    fn interpolate<T: Linear>(&self, point: Vec3, read: impl Fn(usize) -> T) -> T {
        let place = self.to_world.inverse_point(point) * self.size.as_vec3();
        if self.filter == FilterMode::Nearest {
            let cell = floor(place);
            return read(self.start(self.wrapped(cell)));
        }
        let Footprint { starts, fraction } = self.footprint(place - 0.5);
        let [a, b, c, d, e, f, g, h] = starts.map(read);
        let low = a.mix(b, fraction.x).mix(c.mix(d, fraction.x), fraction.y);
        let high = e.mix(f, fraction.x).mix(g.mix(h, fraction.x), fraction.y);
        low.mix(high, fraction.z)
    }

    /// The cells around `place`, which counts cells from the centre of the first one.
    #[inline]
    fn footprint(&self, place: Vec3) -> Footprint {
        let cell = floor(place);
        let (low, high) = (self.wrapped(cell), self.wrapped(cell + 1));
        let column = |x: i32| x as usize * self.channels;
        let row = |y: i32| y as usize * self.size.x as usize * self.channels;
        let layer =
            |z: i32| z as usize * (self.size.x as usize * self.size.y as usize) * self.channels;
        let (x, y, z) = (
            [column(low.x), column(high.x)],
            [row(low.y), row(high.y)],
            [layer(low.z), layer(high.z)],
        );
        Footprint {
            starts: std::array::from_fn(|corner| {
                x[corner & 1] + y[corner >> 1 & 1] + z[corner >> 2]
            }),
            fraction: place - cell.as_vec3(),
        }
    }

    /// The offset of a cell's values.
    #[inline]
    fn start(&self, cell: IVec3) -> usize {
        let [x, y, z] = cell.to_array().map(|coordinate| coordinate as usize);
        let (width, height) = (self.size.x as usize, self.size.y as usize);
        ((z * height + y) * width + x) * self.channels
    }

    /// Wraps a cell index into the grid.
    #[inline]
    fn wrapped(&self, cell: IVec3) -> IVec3 {
        match self.wrap {
            WrapMode::Clamp => cell.clamp(IVec3::ZERO, self.size - 1),
            WrapMode::Repeat => cell.rem_euclid(self.size),
            WrapMode::Mirror => {
                let place = cell.rem_euclid(2 * self.size);
                place.min(2 * self.size - 1 - place)
            }
        }
    }

    /// Whether the grid's values are confined to its cube, and the face values continue outside.
    #[must_use]
    pub fn ends_at_its_faces(&self) -> bool {
        self.wrap == WrapMode::Clamp
    }

    /// The transform from local space, where the grid fills the unit cube, to world space.
    #[must_use]
    pub fn to_world(&self) -> &Transform {
        &self.to_world
    }

    /// The world-space bounding box of the grid.
    #[must_use]
    pub fn bounds(&self) -> Bounds3 {
        self.to_world.bounds(&UNIT_CUBE)
    }

    /// Cell counts along x, y and z.
    #[must_use]
    pub fn size(&self) -> IVec3 {
        self.size
    }

    /// Values per cell: 1, 3 or 6.
    #[must_use]
    pub fn channels(&self) -> usize {
        self.channels
    }

    /// The minimum and maximum value.
    #[must_use]
    pub fn range(&self) -> [f32; 2] {
        self.range
    }

    /// The mean of the values, as a colour.
    #[must_use]
    pub fn mean(&self) -> Spectrum {
        let mut sums = [0.0_f64; 3];
        for cell in self.values.chunks_exact(self.channels) {
            for (channel, sum) in sums.iter_mut().enumerate() {
                *sum += f64::from(cell[channel.min(self.channels - 1)]);
            }
        }
        let count = (self.values.len() / self.channels) as f64;
        Spectrum::from_rgb(sums.map(|sum| (sum / count) as f32))
    }

    /// The values of a cell, whose coordinates must be less than [`Self::size`].
    ///
    /// # Panics
    /// If the coordinates are out of range and the cell would lie beyond the last one.
    #[must_use]
    pub fn cell(&self, cell: IVec3) -> &[f32] {
        let start = self.start(cell);
        &self.values[start..start + self.channels]
    }

    /// The memory used by the values, in bytes.
    #[must_use]
    pub fn memory_bytes(&self) -> usize {
        std::mem::size_of_val(self.values.as_slice())
    }
}

/// The floor of each number. Avoids `floor`, which is a function call in a default build. Beyond
/// 2³¹ any cell is as good as another.
#[inline]
fn floor(place: Vec3) -> IVec3 {
    let down = |coordinate: f32| {
        let cut = coordinate as i32;
        if coordinate < cut as f32 { cut.saturating_sub(1) } else { cut.min(i32::MAX - 1) }
    };
    IVec3::new(down(place.x), down(place.y), down(place.z))
}

/// A value that can be interpolated.
trait Linear {
    /// `self` at weight 0, `other` at weight 1.
    fn mix(self, other: Self, share: f32) -> Self;
}

impl Linear for f32 {
    #[inline]
    fn mix(self, other: Self, share: f32) -> Self {
        self + share * (other - self)
    }
}

impl Linear for Spectrum {
    #[inline]
    fn mix(self, other: Self, share: f32) -> Self {
        self.lerp(other, share)
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use etendue_testkit::TestRng;

    /// A grid of random values, half of which are zero.
    pub(crate) fn random_grid(size: [i32; 3], to_world: Transform) -> GridVolume {
        let mut random = TestRng::new(9);
        let count = size.iter().product::<i32>();
        let values: Vec<f32> =
            (0..count).map(|_| (2.0 * random.next_f32() - 1.0).max(0.0)).collect();
        let file = grid_file::read(&grid_file::tests::file(size, 1, &values)).expect("a file");
        let options = Options {
            filter: FilterMode::Trilinear,
            wrap: WrapMode::Clamp,
            use_grid_bbox: false,
            to_world: DMat4::IDENTITY,
        };
        GridVolume::new(file, &options, to_world)
    }

    /// The grid whose value at cell x, y, z is x + 10 y + 100 z.
    fn grid(size: [i32; 3], filter: FilterMode, wrap: WrapMode) -> GridVolume {
        let mut values = Vec::new();
        for z in 0..size[2] {
            for y in 0..size[1] {
                values.extend((0..size[0]).map(|x| (x + 10 * y + 100 * z) as f32));
            }
        }
        let bytes = grid_file::tests::file(size, 1, &values);
        let file = grid_file::read(&bytes).expect("a file");
        let options = Options { filter, wrap, use_grid_bbox: false, to_world: DMat4::IDENTITY };
        GridVolume::new(file, &options, Transform::IDENTITY)
    }

    #[test]
    fn a_linear_function_is_interpolated_exactly_between_the_middles() {
        let volume = grid([4, 3, 2], FilterMode::Trilinear, WrapMode::Clamp);
        for point in [Vec3::new(0.2, 0.5, 0.6), Vec3::new(0.8, 0.3, 0.25), Vec3::splat(0.5)] {
            let expected =
                (point * Vec3::new(4.0, 3.0, 2.0) - 0.5).dot(Vec3::new(1.0, 10.0, 100.0));
            assert!((volume.eval_scalar(point) - expected).abs() < 1e-4, "{point}");
            assert!((volume.eval(point)[1] - expected).abs() < 1e-4, "{point}");
        }
    }

    #[test]
    fn the_mean_is_that_of_all_cells() {
        let volume = grid([4, 3, 2], FilterMode::Trilinear, WrapMode::Clamp);
        assert_eq!(volume.mean(), Spectrum::splat(1.5 + 10.0 + 50.0));
        assert_eq!(volume.range(), [0.0, 123.0]);
    }

    #[test]
    fn beyond_the_faces_the_wrap_mode_decides() {
        let at = |wrap, x: f32| {
            grid([4, 1, 1], FilterMode::Nearest, wrap).eval_scalar(Vec3::new(x, 0.5, 0.5))
        };
        let places = [-0.3, -0.1, 0.1, 0.9, 1.1, 1.3, 2.1];
        let expected = [
            (WrapMode::Clamp, [0.0, 0.0, 0.0, 3.0, 3.0, 3.0, 3.0]),
            (WrapMode::Repeat, [2.0, 3.0, 0.0, 3.0, 0.0, 1.0, 0.0]),
            (WrapMode::Mirror, [1.0, 0.0, 0.0, 3.0, 3.0, 2.0, 0.0]),
        ];
        for (wrap, values) in expected {
            assert_eq!(places.map(|x| at(wrap, x)), values, "{wrap:?}");
        }
    }

    #[test]
    fn far_and_meaningless_points_have_some_value() {
        for wrap in [WrapMode::Clamp, WrapMode::Repeat, WrapMode::Mirror] {
            let volume = grid([4, 3, 2], FilterMode::Trilinear, wrap);
            for coordinate in [1e30, -1e30, f32::INFINITY, f32::NAN, 2.1e9, -2.2e9] {
                let _ = volume.eval_scalar(Vec3::splat(coordinate));
            }
        }
    }

    #[test]
    fn a_box_is_where_its_corners_go() {
        let bounds = Bounds3::new(Vec3::new(1.0, 2.0, 3.0), Vec3::new(2.0, 4.0, 6.0));
        let matrix = from_unit_cube(&bounds);
        assert_eq!(matrix.transform_point3(Vec3::ONE.as_dvec3()), bounds.max.as_dvec3());
    }
}
